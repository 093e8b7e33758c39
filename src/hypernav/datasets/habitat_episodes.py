"""Habitat's episodes as `hypernav.core.episode.Episode`."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float64

from hypernav.core.episode import Episode, ObjectName
from hypernav.core.errors import EpisodeError
from hypernav.core.goal import Goal
from hypernav.datasets.habitat_files import CONTENT, episode_files, read_episodes
from hypernav.datasets.habitat_format import EpisodeDataset, ObjectNavEpisode
from hypernav.datasets.habitat_frames import pose_from_habitat


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
