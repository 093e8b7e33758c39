"""The files of a benchmark below a data folder: episodes of a split, and scenes."""

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from hypernav.core.episode import Episode
from hypernav.core.errors import EpisodeError
from hypernav.core.naming.words import is_whole_number
from hypernav.lab.datasets.benchmarks import Benchmark
from hypernav.lab.datasets.goat import goat_parts
from hypernav.lab.datasets.habitat_files import episode_files, split_parts

SCENES_FOLDER = "scene_datasets"
"""Folder of all scenes below Habitat's folder of data."""
_HABITAT_PREFIX = ("data", SCENES_FOLDER)
"""Prefix that habitat-lab removes from a scene id (its ``DEFAULT_SCENE_PATH_PREFIX``)."""
_SCENE_SUFFIXES = (".basis.glb", ".glb")
"""Suffixes of a scene in the order of preference; Habitat draws the compressed file."""


@dataclass(frozen=True)
class SplitFolder:
    """One split that was found.

    Attributes:
        name: Name of the split, "val".
        version: Folder that holds it, "v2".
        path: Path of the split's folder.
    """

    name: str
    version: str
    path: Path


def found_splits(benchmark: Benchmark, folder: Path) -> list[SplitFolder]:
    """All splits of a benchmark below a data folder, versions and names in order.

    Args:
        benchmark: The benchmark.
        folder: Data folder, as in ``hm3d:DIR``; habitat-lab's ``data``.
    """
    found: dict[Path, SplitFolder] = {}
    for version in episode_folders(benchmark, folder):
        for split in sorted(version.iterdir()):
            if _holds_episodes(split):
                found.setdefault(split, SplitFolder(split.name, version.name, split))
    return list(found.values())


def episode_folders(benchmark: Benchmark, folder: Path) -> list[Path]:
    """The existing folders of a benchmark's splits, whether there are episodes in them or not."""
    return [
        version
        for pattern in benchmark.episodes
        for version in sorted(folder.glob(pattern))
        if version.is_dir()
    ]


def split_of(benchmark: Benchmark, folder: Path, wanted: str = "") -> SplitFolder:
    """The split that a name means.

    Args:
        benchmark: The benchmark.
        folder: Data folder.
        wanted: ``val``, or with its version ``v2/val``; empty for the benchmark's first.

    Raises:
        EpisodeError: There is no such split, or several versions have one of this name.
    """
    name = wanted or benchmark.splits[0]
    splits = found_splits(benchmark, folder)
    chosen = [split for split in splits if name in (split.name, f"{split.version}/{split.name}")]
    if len(chosen) == 1:
        return chosen[0]
    names = ", ".join(f"#{split.version}/{split.name}" for split in (chosen or splits))
    if chosen:
        raise EpisodeError(
            f"{benchmark.name}:{folder}: the split '{name}' is there in several versions; write "
            f"one of {names}"
        )
    there = f"there are {names}" if splits else f"expected {folder / benchmark.episodes[0]}/{name}"
    raise EpisodeError(
        f"{benchmark.name}:{folder}: found no episodes of the split '{name}'; {there}. To see "
        f"what is missing: hypernav doctor --data {folder}"
    )


def parts_of(
    benchmark: Benchmark,
    path: Path,
    scene_of: Callable[[str], str] = lambda scene_id: scene_id,
    words: Mapping[str, str] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Iterator[list[Episode]]:
    """The episodes of a benchmark's split, one file after the other.

    Args:
        benchmark: The benchmark, whose files have a format of their own if it has goal types.
        path: Folder of the split.
        scene_of: Finds the scene that a ``scene_id`` of the files means.
        words: Names of the goals by category, where the two differ.
        progress: Function that is called with the numbers of files read so far and of all.

    Raises:
        EpisodeError: A file is missing or broken, or there are no episodes.
    """
    if benchmark.goal_types:
        return goat_parts(path, scene_of, progress)
    return split_parts(path, scene_of, words, progress)


def scene_folders(benchmark: Benchmark, folder: Path) -> list[Path]:
    """The existing folders of a benchmark's scenes, the preferred one first."""
    return [
        base / name
        for base in _bases(folder)
        for name in benchmark.scenes
        if (base / name).is_dir()
    ]


def scene_below(benchmark: Benchmark, folder: Path, scene_id: str) -> Path | None:
    """The file of a benchmark's scene; None if there is none.

    The episodes of a scene are used with any release of it: ``hm3d/val/…`` and
    ``hm3d_v0.2/val/…`` are the same houses, the latter with semantic annotations.

    Args:
        benchmark: The benchmark.
        folder: Data folder, or the folder of all scenes.
        scene_id: Path of the scene as the episodes give it, with ``/``.

    Raises:
        EpisodeError: The id leads out of the folder.
    """
    return scene_in(_bases(folder), scene_id, benchmark.scenes)


def scene_in(folders: Sequence[Path], scene_id: str, releases: Sequence[str] = ()) -> Path | None:
    """The file of a scene in the first folder that has it; None if none has it.

    As in habitat-lab, a scene id may begin with ``data/scene_datasets/``. If its file is missing,
    the file with other textures is used: ``X.glb`` for ``X.basis.glb``, and the reverse.

    Args:
        folders: Folders that scene ids are paths below.
        scene_id: Path of the scene as the episodes give it, with ``/``.
        releases: Folders that may replace the id's first one.

    Raises:
        EpisodeError: The id leads out of these folders.
    """
    parts = PurePosixPath(scene_id).parts
    if scene_id.startswith("/") or ".." in parts:
        raise EpisodeError(
            f"the scene id {scene_id} leads out of the folders of scenes ({folders[0]}, …); scene "
            "ids are paths below them, as in Habitat's data sets: shorten it, and name the folder "
            "that it is below with --scenes-dir"
        )
    named = PurePosixPath(*(parts[2:] if parts[:2] == _HABITAT_PREFIX else parts))
    if not named.name:
        return None
    paths = [named, *(PurePosixPath(release, *named.parts[1:]) for release in releases)]
    for place in (folder / path for path in paths for folder in folders):
        stem = place.name.removesuffix(".glb").removesuffix(".basis")
        for name in (place.name, *(stem + suffix for suffix in _SCENE_SUFFIXES)):
            # Unlike Path.is_file, this accepts a name of any length.
            if os.path.isfile(file := place.with_name(name)):
                return file
    return None


def scene_number(scene_id: str) -> str:
    """HM3D's number of a scene, ``802`` for a file in ``00802-…``; empty if it has none."""
    number, dash, _ = PurePosixPath(scene_id).parent.name.partition("-")
    return str(int(number)) if dash and is_whole_number(number) else ""


def _bases(folder: Path) -> tuple[Path, ...]:
    """Folders below a data folder that may hold sets of scenes."""
    return (folder / SCENES_FOLDER, folder / "versioned_data", folder)


def _holds_episodes(folder: Path) -> bool:
    if not folder.is_dir() or folder.name == "content":
        return False
    try:
        return len(episode_files(folder)) > 0
    except EpisodeError:
        return False
