"""Writes complete episodes of a split for other programs, in Habitat's layout of files."""

from collections.abc import Callable
from pathlib import Path

from hypernav.core.errors import EpisodeError
from hypernav.datasets.habitat_files import write_episodes
from hypernav.datasets.habitat_format import EpisodeDataset
from hypernav.houses.building import Building
from hypernav.houses.episodes.house_episodes import with_view_points
from hypernav.houses.house_cache import cached_building

_ENDINGS = (".json.gz", ".json")


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
