"""The data sets that episodes come from, by name.

A data set is written ``NAME[:ARGUMENT][#PART]``. A further one is an entry in `DATA_SOURCES`, or an
entry point ``hypernav.datasets`` of another package.
"""

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from hypernav.app.build.data.scenes import is_no_file
from hypernav.core.components.registry import Entry, Registry
from hypernav.core.embodiment import Embodiment
from hypernav.core.episode import Episode
from hypernav.core.errors import EpisodeError
from hypernav.io.reading import back_slashes
from hypernav.lab.datasets.benchmark_files import (
    SCENES_FOLDER,
    parts_of,
    scene_below,
    scene_in,
    split_of,
)
from hypernav.lab.datasets.benchmarks import BENCHMARKS, Benchmark
from hypernav.lab.datasets.building_splits import SPLITS, numbers_of
from hypernav.lab.datasets.habitat_files import episodes_of, read_split
from hypernav.lab.datasets.shipped import shipped_split
from hypernav.simulator.worlds.config import SimulationConfig

Progress = Callable[[int, int], None]
"""A function that is called with the numbers of finished parts and of all parts."""


@dataclass(frozen=True)
class DatasetRequest:
    """The arguments of a data source.

    Attributes:
        argument: Text after the name and a colon; empty if there is none.
        part: Text after ``#``; empty if there is none.
        simulation: How the robot is simulated, for data sets that draw starts.
        embodiment: Body, camera and motion of the robot, for data sets that draw starts.
        scenes_dir: Folder of scene files; None takes that of the episode file.
        as_in_files: Whether goals are named as in the episode files, even if the data set has names
            of its own.
        progress: Function that is called with the progress of loading.
    """

    argument: str = ""
    part: str = ""
    simulation: SimulationConfig = field(default_factory=SimulationConfig)
    embodiment: Embodiment = field(default_factory=Embodiment)
    scenes_dir: Path | None = None
    as_in_files: bool = False
    progress: Progress | None = None

    def tell(self, done: int, total: int) -> None:
        """Report the progress of loading, if somebody asked for it."""
        if self.progress is not None:
            self.progress(done, total)


DataSource = Callable[[DatasetRequest], list[Episode]]
"""A function that gives all episodes of a data set, in its order."""


def split_episodes(split: str, request: DatasetRequest) -> list[Episode]:
    """The episodes of a split of generated buildings; only what isn't shipped is generated."""
    if not request.part and (shipped := shipped_split(split)) is not None:
        return episodes_of(shipped)
    # Imported here: the generator is large, and most runs don't need it.
    from hypernav.simulator.houses.episodes.splits import load_split

    numbers = None if not request.part else numbers_of(split, request.part)
    return episodes_of(load_split(split, numbers=numbers, progress=request.progress))


def habitat_episodes(request: DatasetRequest) -> list[Episode]:
    """The episodes of a file in Habitat's ObjectNav format, or of a split's folder.

    A scene id is a path below the folder of scenes, or a name that ``hypernav find --scene`` knows.
    By default this folder is that of the file, or ``scene_datasets`` somewhere above it, where
    Habitat's data are.
    """
    path = Path(request.argument)
    if request.part:
        raise EpisodeError(
            f"habitat:{path}#{request.part}: nothing follows the file's name; choose episodes with "
            "--episodes, --scenes and --goals"
        )
    own = path if path.is_dir() else path.parent
    if request.scenes_dir is None:
        above = (folder / SCENES_FOLDER for folder in own.resolve().parents)
        folders = [own, *(folder for folder in above if os.path.isdir(folder))]
    else:
        folders = [request.scenes_dir, request.scenes_dir / SCENES_FOLDER]
    return read_split(path, partial(_named_scene, folders), progress=request.tell)


def benchmark_episodes(name: str, request: DatasetRequest) -> list[Episode]:
    """The episodes of a split of a published benchmark, below the folder of all its data."""
    benchmark, folder = BENCHMARKS[name], Path(request.argument)
    split = split_of(benchmark, folder, request.part)
    scene_of = partial(_scene_of, benchmark, request.scenes_dir or folder)
    words = {} if request.as_in_files else benchmark.words
    parts = parts_of(benchmark, split.path, scene_of, words, request.tell)
    return [episode for part in parts for episode in part]


def _scene_of(benchmark: Benchmark, folder: Path, scene_id: str) -> str:
    """The path of a benchmark's scene, even if it is missing: few users need all scenes."""
    return str(scene_below(benchmark, folder, scene_id) or folder / SCENES_FOLDER / scene_id)


def _named_scene(folders: Sequence[Path], scene_id: str) -> str:
    """The scene that a scene id of an episode file names, in the first folder that has it."""
    if is_no_file(scene_id):
        return scene_id
    if (file := scene_in(folders, scene_id, _releases_of(scene_id))) is not None:
        return str(file)
    raise EpisodeError(
        f"there is no scene {scene_id} below {' or '.join(map(str, folders))}; scene ids of the "
        f"file are paths below its folder, below {SCENES_FOLDER} in a folder above it, or below "
        f"--scenes-dir FOLDER{back_slashes(scene_id)}"
    )


def _releases_of(scene_id: str) -> tuple[str, ...]:
    """The scene releases that a scene id may belong to; none if no benchmark knows them."""
    parts = scene_id.split("/")
    known = (one.scenes for one in BENCHMARKS.values() if not set(parts).isdisjoint(one.scenes))
    return next(known, ())


DATA_SOURCES: Registry[DataSource] = Registry(
    "data set",
    "hypernav.datasets",
    [
        *(
            Entry(
                name,
                partial(split_episodes, name),
                form=f"{name}[#FIRST:END]" if split.is_open else name,
            )
            for name, split in SPLITS.items()
        ),
        Entry(
            "scene",
            "hypernav.app.build.data.drawn_starts:scene_episodes",
            form="scene:SCENE[#STARTS]",
        ),
        Entry("habitat", habitat_episodes, form="habitat:FILE"),
        *(
            Entry(name, partial(benchmark_episodes, name), form=f"{name}:DIR[#SPLIT]")
            for name in BENCHMARKS
        ),
    ],
)
"""The registry of data sets."""
