"""Episode files in Habitat's format: reading, validation, writing, and their episodes as ours."""

import codecs
import gzip
import io
import json
import tempfile
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np
from jaxtyping import Float64
from pydantic import BaseModel, ValidationError

from hypernav.core.episode import Episode, ObjectName
from hypernav.core.errors import EpisodeError
from hypernav.core.goal import Goal
from hypernav.core.naming.words import megabytes
from hypernav.io.parsing import check_json_size
from hypernav.io.reading import Allowance, read_file
from hypernav.lab.datasets.habitat_format import (
    LARGEST,
    EpisodeDataset,
    ObjectNavEpisode,
    pose_from_habitat,
)

_MOST_BYTES = 500_000_000
"""The largest text; the file with all of MP3D's validation episodes has a third of it."""
_MOST_ERRORS = 10_000
"""Largest number of errors for which the first is described: pydantic formats all at once."""
_GZIP_MAGIC = b"\x1f\x8b"
_SUFFIXES = (".json.gz", ".json")
CONTENT = "content"
"""Folder of a split with one file for each scene."""
_TRIED_TYPES = ("int", "float", "constrained-int", "constrained-float", "str")
"""Pydantic's names for the alternatives of a field that may have several types."""

Content = TypeVar("Content", bound=BaseModel)


def read_episodes(path: Path | str) -> EpisodeDataset:
    """Open an episode file in Habitat's ObjectNav format.

    Args:
        path: A ``.json.gz`` or ``.json`` file of one scene or of several.

    Raises:
        EpisodeError: The file is missing or broken, or an episode lacks something; the message
            names the episode and the field.
    """
    path = Path(path)
    dataset = read_as(EpisodeDataset, path)
    for episode in dataset.episodes:
        try:
            dataset.goals_of(episode)
        except EpisodeError as error:
            raise EpisodeError(f"{path}: {error}") from error
    return dataset


def read_as(kind: type[Content], path: Path) -> Content:
    """The content of a ``.json.gz`` or ``.json`` file.

    Raises:
        EpisodeError: The file is missing or broken, or something in it does not fit the model; the
            message names the episode and the field.
    """
    text = _unpacked(path).removeprefix(codecs.BOM_UTF8)
    try:
        check_json_size(text, Allowance())
        return kind.model_validate_json(text)
    except OSError as error:
        raise EpisodeError(f"{path}: {error.strerror}") from error
    except ValidationError as error:
        raise EpisodeError(f"{path}: {_description(error, text)}") from error


def write_episodes(dataset: EpisodeDataset, path: Path | str) -> None:
    """Write an episode file completely or not at all; the same data gives the same bytes.

    Args:
        dataset: Episodes and goals to write.
        path: Path of the file; ends in ``.json.gz`` (compressed) or ``.json``.

    Raises:
        EpisodeError: The path has another suffix.
    """
    path = Path(path)
    if not path.name.endswith(_SUFFIXES):
        raise EpisodeError(f"{path}: an episode file ends in .json.gz or .json")
    text = json.dumps(dataset.model_dump(mode="json", exclude_unset=True), allow_nan=False)
    data = text.encode()
    if path.name.endswith(".gz"):
        data = gzip.compress(data, mtime=0)
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=".new-") as folder:
        fresh = Path(folder) / path.name
        fresh.write_bytes(data)
        fresh.replace(path)


def episode_files(path: Path | str) -> tuple[Path, ...]:
    """The files of a split that hold episodes.

    Habitat keeps a split as ``val/val.json.gz`` (often without episodes) with one file for each
    scene in ``val/content/``.

    Args:
        path: Folder ``val``, or one file.

    Returns:
        The files in ``content``, sorted, if there are any; else the one file. Hidden files, such as
        those in which macOS keeps attributes (``._name.json.gz``), are left out.

    Raises:
        EpisodeError: There is no such file or no episode file in the folder.
    """
    path = Path(path)
    folder = path if path.is_dir() else path.parent
    content = _files_in(folder / CONTENT)
    if content and (path.is_dir() or path.name.split(".")[0] == folder.name):
        return tuple(content)
    if path.is_file():
        return (path,)
    here = _files_in(path)
    if not here:
        raise EpisodeError(f"{path}: no episode file (.json.gz) here; check the path")
    return tuple(here)


def _files_in(folder: Path) -> list[Path]:
    named = (path for path in folder.glob("*.json*") if path.name.endswith(_SUFFIXES))
    return sorted(path for path in named if not path.name.startswith("."))


def _unpacked(path: Path) -> bytes:
    try:
        data = read_file(path, most=_MOST_BYTES)
    except FileNotFoundError as error:
        raise EpisodeError(f"{path}: no such episode file; check the path") from error
    except OSError as error:
        raise EpisodeError(f"{path}: cannot be read ({error.strerror or error})") from error
    if not data.startswith(_GZIP_MAGIC):
        return data
    try:
        with gzip.GzipFile(fileobj=io.BytesIO(data)) as file:
            text = file.read(_MOST_BYTES + 1)
    except (gzip.BadGzipFile, EOFError, zlib.error) as error:
        raise EpisodeError(f"{path}: broken gzip data ({error}); download it again") from error
    if len(text) > _MOST_BYTES:
        raise EpisodeError(
            f"{path}: unpacks to more than {megabytes(_MOST_BYTES)}, the most that is read; "
            "give each scene a file of its own"
        )
    return text


def _description(error: ValidationError, text: bytes) -> str:
    """The first error, with the name of its episode or goal."""
    if error.error_count() > _MOST_ERRORS:
        return f"{error.error_count():,} values do not fit Habitat's format; is it another format?"
    first = error.errors(include_url=False)[0]
    location = first["loc"]
    if first["type"] == "json_invalid":
        return f"not valid JSON ({first['msg']}); download it again"
    what = first["msg"][0].lower() + first["msg"][1:]
    if location and location[-1] in _TRIED_TYPES:
        kind = (
            "a whole number or text"
            if "str" in _alternatives(error, location)
            else f"a number within ±{LARGEST:,}"
        )
        what = f"expected {kind}, got {first['input']!r}"
    if len(location) < 2:
        return f"{_field(location) or 'the file'}: {what}"
    if location[0] == "episodes":
        name = f"episode {_episode_id(json.loads(text), location[1])}"
        return (
            f"{name}, field '{_field(location[2:])}': {what}" if location[2:] else f"{name}: {what}"
        )
    if len(location) >= 3:
        return f"goal {location[2]} of '{location[1]}', field '{_field(location[3:])}': {what}"
    return f"{location[0]} '{location[1]}': {what}"


def _alternatives(error: ValidationError, location: tuple[int | str, ...]) -> set[int | str]:
    """Types that were tried at a location."""
    return {other["loc"][-1] for other in error.errors() if other["loc"][:-1] == location[:-1]}


def _episode_id(content: Any, number: int | str) -> str:
    episode = content["episodes"][int(number)]
    own = episode.get("episode_id") if isinstance(episode, dict) else None
    return str(own) if own is not None else f"number {number} (it has no episode_id)"


def _field(location: tuple[int | str, ...]) -> str:
    """A field's name, without pydantic's names of the types that it tried."""
    name = ""
    for part in location:
        if isinstance(part, int):
            name += f"[{part}]"
        elif part not in _TRIED_TYPES:
            name += f".{part}" if name else part
    return name


def episodes_of(
    dataset: EpisodeDataset,
    scene_of: Callable[[str], str] = lambda scene_id: scene_id,
    words: Mapping[str, str] | None = None,
) -> list[Episode]:
    """The episodes of a file, in its order.

    Their view points are those of the file's goals; if the goals have none, they are computed from
    the scene.

    Args:
        dataset: What the file holds.
        scene_of: Finds the scene that a ``scene_id`` of the file means.
        words: Names of the goals by category, where the two differ.

    Raises:
        EpisodeError: Goals are missing, a start looks up or down, or two episodes have one name.
    """
    shared: dict[tuple[str, ...], _Goals] = {}
    found: dict[tuple[str, str], Episode] = {}
    for entry in dataset.episodes:
        key = (entry.goals_key(), *(entry.children_object_categories or ()))
        if entry.goals or key not in shared:
            shared[key] = _Goals.of(dataset, entry)
        asked = None if words is None else words.get(entry.object_category)
        start, start_z = pose_from_habitat(entry.start_position, entry.start_rotation)
        episode = Episode(
            scene_id=scene_of(entry.scene_id),
            episode_id=str(entry.episode_id),
            goal=entry.goal if asked is None else Goal(asked),
            start=start,
            start_z=start_z,
            group=str((entry.info or {}).get("vocabulary", "")),
            view_points=shared[key].view_points,
            objects=shared[key].objects,
            object_category=entry.object_category,
            category_ids=dataset.category_to_task_category_id,
            life=str((entry.info or {}).get("life") or ""),
        )
        if episode.key in found:
            raise EpisodeError(_repeated(episode))
        found[episode.key] = episode
    return list(found.values())


def read_split(
    path: Path,
    scene_of: Callable[[str], str] = lambda scene_id: scene_id,
    words: Mapping[str, str] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> list[Episode]:
    """The episodes of all files of a split, in their order.

    Args:
        path: Folder of the split, or one file, as for `episode_files`.
        scene_of: Finds the scene that a ``scene_id`` of the files means.
        words: Names of the goals by category, where the two differ.
        progress: Function that is called with the numbers of files read so far and of all.

    Raises:
        EpisodeError: A file is missing or broken, two episodes have one name, or there are none.
    """
    parts = split_parts(path, scene_of, words, progress)
    return [episode for part in parts for episode in part]


def split_parts(
    path: Path,
    scene_of: Callable[[str], str] = lambda scene_id: scene_id,
    words: Mapping[str, str] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Iterator[list[Episode]]:
    """The episodes of a split, one file after the other, as `read_split` reads them."""
    known: set[tuple[str, str]] = set()
    files = episode_files(path)
    for done, file in enumerate(files):
        if progress is not None:
            progress(done, len(files))
        try:
            episodes = episodes_of(read_episodes(file), scene_of, words)
            for episode in episodes:
                if episode.key in known:
                    raise EpisodeError(_repeated(episode) + "; the other one is in another file")
        except EpisodeError as error:
            named = str(error).startswith(str(file))
            raise error if named else EpisodeError(f"{file}: {error}") from error
        known.update(episode.key for episode in episodes)
        yield episodes
    if not known:
        raise EpisodeError(_nothing_in(path, files))


def _repeated(episode: Episode) -> str:
    return (
        f"two episodes are called {episode.episode_id} in {episode.scene_id}; results are kept by "
        "scene and name, so each needs a name of its own"
    )


def _nothing_in(path: Path, files: Sequence[Path]) -> str:
    """The error for a split whose files hold no episode."""
    first = files[0]
    if first.parent.name == CONTENT:
        return (
            f"{path}: none of the {len(files)} files in {first.parent} holds an episode; unpack "
            "the archive again"
        )
    content = first.parent / CONTENT
    state = "which holds no file" if content.is_dir() else "which is missing"
    return (
        f"{path}: no episode in {first.name}; Habitat keeps those of each scene in a file in "
        f"{content}, {state}; unpack the archive again"
    )


class _Goals(NamedTuple):
    """Data of the goals of an episode, shared by many episodes."""

    view_points: Float64[np.ndarray, "n 3"] | None
    objects: tuple[ObjectName, ...]

    @staticmethod
    def of(dataset: EpisodeDataset, entry: ObjectNavEpisode) -> "_Goals":
        points = dataset.view_points_of(entry)
        objects = tuple(goal.in_scene for goal in dataset.goals_of(entry))
        return _Goals(points if len(points) > 0 else None, objects)
