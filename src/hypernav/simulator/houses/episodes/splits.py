"""Splits of the generated buildings: their buildings, number of episodes, order and difficulty.

Episodes come in rounds of four per building, so that the first hundred of a split already visit 25
buildings and every building is opened once for four episodes; lives in rounds of one. The episodes
of a building are cached on disk.
"""

import contextlib
import hashlib
import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from hypernav.core.errors import EpisodeError
from hypernav.io.cache_folder import cache_folder
from hypernav.lab.datasets.building_splits import BuildingSplit, GoalStyle, split_named
from hypernav.lab.datasets.habitat_files import read_episodes, write_episodes
from hypernav.lab.datasets.habitat_format import EpisodeDataset, ObjectNavEpisode
from hypernav.simulator.houses.building import Building
from hypernav.simulator.houses.episodes.house_episodes import EPISODES_VERSION, house_episodes
from hypernav.simulator.houses.episodes.queries import RULES
from hypernav.simulator.houses.house_cache import cached_building, generator_version


def cached_episodes(
    building: Building, style: GoalStyle, folder: Path | None = None
) -> EpisodeDataset:
    """Episodes of a building, from the cache if possible; otherwise generated and cached.

    A broken file is replaced. Without a writable folder nothing is cached.

    Args:
        building: The building.
        style: What they ask for.
        folder: Cache folder; the platform's own if None.

    Raises:
        EpisodeError: The building contains no possible goal.
    """
    home = (folder or cache_folder()) / f"{building.noun}_episodes" / episodes_version()
    path = home / f"{style}-{building.number}.json.gz"
    with contextlib.suppress(EpisodeError, OSError):
        if path.is_file():
            return read_episodes(path)
    dataset = house_episodes(cached_building(building, folder), building, style)
    # The disk may be read-only or full; the episodes are still valid.
    with contextlib.suppress(OSError):
        write_episodes(dataset, path)
    return dataset


@lru_cache(maxsize=1)
def episodes_version() -> str:
    """Version of buildings and episodes together with a digest of the sources in this folder.

    The digest is for developers of the generator: without it, if they forgot to increase the
    version, outdated episodes would be used.
    """
    digest = hashlib.sha256(generator_version().encode())
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.name.encode())
        digest.update(source.read_bytes())
    return f"v{EPISODES_VERSION}-{digest.hexdigest()[:12]}"


@dataclass(frozen=True)
class Distribution:
    """Distribution of a measure over episodes.

    Attributes:
        measure: Name of the measure, with the unit.
        quantiles: Minimum, 10%, median, 90% and maximum.
        mean: Arithmetic mean.
    """

    measure: str
    quantiles: tuple[float, float, float, float, float]
    mean: float


@dataclass(frozen=True)
class Difficulty:
    """Statistics that describe the difficulty of a set of episodes.

    Attributes:
        episodes: Number of episodes.
        buildings: Number of buildings.
        distributions: Distributions of distance, detour (geodesic over Euclidean) and rooms on the
            shortest path.
        goals: Number of episodes per goal, most frequent first.
        vocabulary: Episodes by kind of name (seen, synonym, unseen); empty without phrases.
        descriptions: Number of episodes whose goal says more than a name.
    """

    episodes: int
    buildings: int
    distributions: tuple[Distribution, ...]
    goals: dict[str, int]
    vocabulary: dict[str, int]
    descriptions: int


def difficulty(dataset: EpisodeDataset) -> Difficulty:
    """Measure a split that was made by `hypernav.simulator.houses.episodes`."""
    infos = [episode.info or {} for episode in dataset.episodes]
    geodesic = np.array([info["geodesic_distance"] for info in infos], dtype=np.float64)
    euclidean = np.array([info["euclidean_distance"] for info in infos], dtype=np.float64)
    rooms = np.array([info["rooms_on_path"] for info in infos], dtype=np.float64)
    named = Counter(info["vocabulary"] for info in infos if "vocabulary" in info)
    return Difficulty(
        episodes=len(infos),
        buildings=len({episode.scene_id for episode in dataset.episodes}),
        distributions=(
            _distribution("geodesic distance (m)", geodesic),
            _distribution("geodesic / Euclidean", geodesic / np.maximum(euclidean, 1e-6)),
            _distribution("rooms on the path", rooms),
        ),
        goals=dict(Counter(episode.object_category for episode in dataset.episodes).most_common()),
        vocabulary={name: named[name] for name in ("seen", "synonym", "unseen") if name in named},
        descriptions=sum(bool(info.get("is_description")) for info in infos),
    )


def _distribution(measure: str, values: np.ndarray) -> Distribution:
    low, tenth, middle, ninetieth, high = np.quantile(values, (0.0, 0.1, 0.5, 0.9, 1.0)).tolist()
    return Distribution(measure, (low, tenth, middle, ninetieth, high), float(values.mean()))


def load_split(
    name: str,
    *,
    numbers: range | None = None,
    count: int | None = None,
    cache: Path | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> EpisodeDataset:
    """Episodes of a split, generated and cached on first use.

    Args:
        name: Name of the split, a key of `SPLITS`.
        numbers: Numbers of the buildings to use; for an open split any that belong to no other.
        count: Number of episodes, or of lives, to keep, from the first on.
        cache: Cache folder; the platform's own if None.
        progress: Callback with the number of finished buildings and of all.

    Returns:
        Episodes with ids that are unique in the split. Their ``scene_id`` is a scene name that
        ``hypernav find --scene`` understands, such as ``houses:1000``.

    Raises:
        EpisodeError: There is no such split, or it has no such buildings, or not so many episodes.
    """
    split = split_named(name)
    if numbers is None:
        numbers = split.numbers
    split.check(numbers)
    most = split.episodes if numbers == split.numbers else split.per_building * len(numbers)
    if count is not None and not 1 <= count <= most:
        noun = "lives" if split.has_lives else "episodes"
        raise EpisodeError(
            f"{count} {noun}: {name} has 1 to {most} in the {split.kind} "
            f"{numbers.start}:{numbers.stop}"
        )
    wanted = most if count is None else count
    needed = numbers[: math.ceil(wanted / split.per_round)]
    parts = []
    for done, number in enumerate(needed):
        if progress is not None:
            progress(done, len(needed))
        parts.append(cached_episodes(Building(split.kind, number), split.style, cache))
    if progress is not None:
        progress(len(needed), len(needed))
    return _joined(parts, wanted, split)


def _joined(parts: list[EpisodeDataset], count: int, split: BuildingSplit) -> EpisodeDataset:
    """One data set in rounds, with only the goals of its episodes.

    Every known name has a number, even if no episode asks for it: habitat-lab keeps the numbers of
    the last file that it reads, so the numbers must be the same in all parts of a split.
    """
    known = RULES[split.kind].categories
    chosen = _in_rounds([_units(part.episodes) for part in parts], split.per_round)[:count]
    episodes = [episode for unit in chosen for episode in unit]
    goals = {key: found for part in parts for key, found in part.goals_by_category.items()}
    used = dict.fromkeys(episode.goals_key() for episode in episodes)
    others = {episode.object_category for episode in episodes}.difference(known)
    numbers = {name: number for number, name in enumerate((*known, *sorted(others)))}
    return EpisodeDataset.model_validate(
        {
            "goals_by_category": {key: goals[key] for key in used},
            "episodes": [_with_unique_id(episode) for episode in episodes],
            "category_to_task_category_id": numbers,
            # Habitat's reader needs both tables, with the same names.
            "category_to_scene_annotation_category_id": dict(numbers),
        }
    )


def _units(episodes: list[ObjectNavEpisode]) -> list[list[ObjectNavEpisode]]:
    """The lives of a building, or each episode by itself."""
    units: dict[str, list[ObjectNavEpisode]] = {}
    for episode in episodes:
        life = (episode.info or {}).get("life", str(episode.episode_id))
        units.setdefault(life, []).append(episode)
    return list(units.values())


def _in_rounds(
    buildings: list[list[list[ObjectNavEpisode]]], per_round: int
) -> list[list[ObjectNavEpisode]]:
    longest = max(len(units) for units in buildings)
    return [
        unit
        for first in range(0, longest, per_round)
        for units in buildings
        for unit in units[first : first + per_round]
    ]


def _with_unique_id(episode: ObjectNavEpisode) -> ObjectNavEpisode:
    """Episode with an id, and a life, that is unique in the split, not only in its building."""
    number = episode.scene_id.partition(":")[2]
    update: dict[str, Any] = {"episode_id": f"{number}-{episode.episode_id}"}
    if "life" in (info := episode.info or {}):
        update["info"] = info | {"life": f"{number}-{info['life']}"}
    return episode.model_copy(update=update)
