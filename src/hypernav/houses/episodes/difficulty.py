"""Difficulty of a set of episodes."""

from collections import Counter
from dataclasses import dataclass

import numpy as np

from hypernav.datasets.habitat_format import EpisodeDataset


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
    """Measure a split that was made by `hypernav.houses.episodes`."""
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
