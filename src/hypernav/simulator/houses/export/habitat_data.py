"""Writes complete episodes of a split, alone or in a data folder that Habitat can use unchanged.

The folder is laid out as habitat-lab's ``data``::

    scene_datasets/hypernav/hypernav.scene_dataset_config.json
    scene_datasets/hypernav/house_1000/house_1000.glb, .navmesh, .semantic.glb, .semantic.txt
    datasets/objectnav/hypernav/houses-val/houses-val.json.gz
    datasets/objectnav/hypernav/houses-val/content/house_1000.json.gz

Both Habitat and this package use the view points in the files. They are those of the scene, one on
each cell (5 cm) from which the goal counts as reached. ``info.geodesic_distance`` is the shortest
path to them on the navigation mesh beside the scene, as measured by Habitat.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hypernav.core.errors import EpisodeError
from hypernav.lab.datasets.benchmark_files import SCENES_FOLDER
from hypernav.lab.datasets.benchmarks import GENERATED
from hypernav.lab.datasets.building_splits import SPLITS
from hypernav.lab.datasets.habitat_files import CONTENT, episodes_of, write_episodes
from hypernav.lab.datasets.habitat_format import EpisodeDataset, ObjectGoal, ObjectNavEpisode
from hypernav.simulator.houses.building import Building
from hypernav.simulator.houses.episodes.house_episodes import with_view_points
from hypernav.simulator.houses.export.building_files import (
    DATASET_CONFIG,
    FIRST_ANNOTATION,
    export_building,
    write_dataset_config,
)
from hypernav.simulator.houses.house_cache import cached_building
from hypernav.simulator.worlds.navmesh.navmesh_surface import NavmeshSurface

_ENDINGS = (".json.gz", ".json")

_NAME = GENERATED.scenes[0]
"""Name of the buildings among Habitat's sets of scenes."""
_EPISODES = ".json.gz"
_DIGITS = 4


def is_file_name(out: Path) -> bool:
    """Whether a name means one file, not a folder."""
    return out.name.endswith(_ENDINGS)


def write_split(
    dataset: EpisodeDataset,
    out: Path,
    *,
    cache: Path | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> None:
    """Write the episodes of a split with every view point of their goals.

    Args:
        dataset: What `load_split` gave.
        out: One file (``.json.gz`` or ``.json``), or a folder in Habitat's layout: the split's file
            without episodes, and in ``content`` a file for every scene.
        cache: Cache folder of the buildings; the platform's own if None.
        progress: Function that is called with the numbers of finished buildings and of all.

    Raises:
        EpisodeError: It cannot be written.
    """
    scenes = list(dict.fromkeys(episode.scene_id for episode in dataset.episodes))
    whole = dataset.model_copy(update={"goals_by_category": {}})
    for done, scene_id in enumerate(scenes):
        if progress is not None:
            progress(done, len(scenes))
        scene = cached_building(Building.named(scene_id), cache)
        part = with_view_points(of_scene(dataset, scene_id), scene)
        if is_file_name(out):
            whole.goals_by_category.update(part.goals_by_category)
        else:
            write(part, out / "content" / f"{scene_id.replace(':', '-')}.json.gz")
    if is_file_name(out):
        write(whole, out)
    else:
        write(whole.model_copy(update={"episodes": []}), out / f"{out.name}.json.gz")


def of_scene(dataset: EpisodeDataset, scene_id: str) -> EpisodeDataset:
    """The episodes of one scene, with their goals."""
    episodes = [episode for episode in dataset.episodes if episode.scene_id == scene_id]
    keys = dict.fromkeys(episode.goals_key() for episode in episodes)
    goals = {key: dataset.goals_by_category[key] for key in keys}
    return dataset.model_copy(update={"episodes": episodes, "goals_by_category": goals})


def write(dataset: EpisodeDataset, path: Path) -> None:
    """Write a file of a split.

    Raises:
        EpisodeError: It cannot be written.
    """
    try:
        write_episodes(dataset, path)
    except OSError as error:
        raise EpisodeError(f"{path}: cannot be written ({error.strerror or error})") from error


@dataclass(frozen=True)
class HabitatData:
    """Where the parts of an exported split are.

    Attributes:
        root: Folder of all data, Habitat's ``data``.
        split: Name of the split.
    """

    root: Path
    split: str

    @property
    def scenes(self) -> Path:
        """Folder of all sets of scenes: habitat-lab's ``habitat.dataset.scenes_dir``."""
        return self.root / SCENES_FOLDER

    @property
    def dataset_config(self) -> Path:
        """The scene-dataset configuration."""
        return self.scenes / _NAME / DATASET_CONFIG

    @property
    def episodes(self) -> Path:
        """The split's file: habitat-lab's ``habitat.dataset.data_path``."""
        return self.root / GENERATED.episodes[0] / self.split / f"{self.split}{_EPISODES}"

    @property
    def content(self) -> Path:
        """Folder with the episodes of each building in a file."""
        return self.episodes.parent / CONTENT

    @property
    def buildings(self) -> set[str]:
        """Names of the buildings with episodes, such as ``house_1000``."""
        return {
            file.name.removesuffix(_EPISODES) for file in self.content.glob(f"[!.]*{_EPISODES}")
        }


def export_split(
    dataset: EpisodeDataset,
    split: str,
    root: Path,
    *,
    cache: Path | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> HabitatData:
    """Write buildings and episodes of a split. Several splits and parts may share a folder.

    The episodes of a building are written in one step after everything that they need, so an
    interrupted export leaves only complete buildings, and the same export completes the rest.

    Args:
        dataset: What `hypernav.simulator.houses.episodes.splits.load_split` gave.
        split: Name of the split.
        root: Folder to write to; created if missing. Episodes name the configuration of their
            scenes by this path, as habitat-lab requires: absolute, or relative to the folder in
            which Habitat will run.
        cache: Cache folder of the buildings; the platform's own if None.
        progress: Function that is called with the numbers of finished buildings and of all.

    Raises:
        SceneError: A building cannot be written.
        EpisodeError: The episodes cannot be written, or the folder has other buildings of a split
            with phrases.
    """
    data = HabitatData(root, split)
    scene_ids = list(dict.fromkeys(episode.scene_id for episode in dataset.episodes))
    stems = [Building.named(scene_id).file_stem for scene_id in scene_ids]
    if SPLITS[split].style != "categories" and (others := data.buildings.difference(stems)):
        raise EpisodeError(
            f"{root} holds {len(others)} other buildings of {split}; the numbers of its phrases "
            "are valid for one export, so export all buildings at once, or use another folder"
        )
    write(dataset.model_copy(update={"episodes": [], "goals_by_category": {}}), data.episodes)
    for done, (scene_id, stem) in enumerate(zip(scene_ids, stems, strict=True)):
        if progress is not None:
            progress(done, len(scene_ids))
        building, content = Building.named(scene_id), data.content / f"{stem}{_EPISODES}"
        _remove(content)  # until its scene is complete
        files = export_building(building, data.scenes / _NAME / stem)
        part = with_view_points(of_scene(dataset, scene_id), cached_building(building, cache))
        part = _of_file(part, files.glb.relative_to(data.scenes).as_posix(), data.dataset_config)
        part = _measured(part, NavmeshSurface.load(files.navmesh))
        write_dataset_config(data.scenes / _NAME)
        write(part, content)
    return data


def _remove(content: Path) -> None:
    try:
        content.unlink(missing_ok=True)
    except OSError as error:
        raise EpisodeError(f"{content}: cannot be replaced ({error.strerror or error})") from error


def _of_file(dataset: EpisodeDataset, scene_id: str, config: Path) -> EpisodeDataset:
    """The episodes of one building, referring to its exported file and semantics."""
    update = {"scene_id": scene_id, "scene_dataset_config": config.as_posix()}
    goals: dict[str, list[ObjectGoal]] = {}
    episodes: list[ObjectNavEpisode] = []
    for episode in dataset.episodes:
        renamed = episode.model_copy(update=update | {"info": _annotated(episode.info or {})})
        if renamed.goals_key() not in goals:
            goals[renamed.goals_key()] = [
                goal.model_copy(update={"object_id": int(goal.object_id) + FIRST_ANNOTATION})
                for goal in dataset.goals_by_category[episode.goals_key()]
            ]
        episodes.append(renamed)
    return dataset.model_copy(update={"episodes": episodes, "goals_by_category": goals})


def _annotated(info: dict[str, Any]) -> dict[str, Any]:
    """An episode's entry with the numbers of objects in the semantics."""
    others = info["near_miss_object_ids"]
    return info | {
        "closest_goal_object_id": info["closest_goal_object_id"] + FIRST_ANNOTATION,
        "near_miss_object_ids": [number + FIRST_ANNOTATION for number in others],
    }


def _measured(dataset: EpisodeDataset, surface: NavmeshSurface) -> EpisodeDataset:
    """The episodes with start distances of their view points on a navigation mesh."""
    fields = {}
    episodes: list[ObjectNavEpisode] = []
    for entry, episode in zip(dataset.episodes, episodes_of(dataset), strict=True):
        assert episode.view_points is not None
        if entry.goals_key() not in fields:
            fields[entry.goals_key()] = surface.goal_field(episode.view_points)
        length = fields[entry.goals_key()].distance(*episode.start.xy, episode.start_z)
        if length == float("inf"):
            raise EpisodeError(f"{entry.scene_id}: no path on its mesh leads to {episode.goal}")
        info = (entry.info or {}) | {"geodesic_distance": round(length, _DIGITS)}
        episodes.append(entry.model_copy(update={"info": info}))
    return dataset.model_copy(update={"episodes": episodes})
