"""Splits and episodes of the generated houses, in Habitat's ObjectNav format."""

from hypernav.worlds.house_episodes.asks import CATEGORIES, HABITAT_CATEGORIES
from hypernav.worlds.house_episodes.difficulty import Difficulty, Spread, difficulty
from hypernav.worlds.house_episodes.generate import EPISODES_PER_HOUSE, house_episodes
from hypernav.worlds.house_episodes.splits import SPLITS, HouseSplit, load_split, split_named

__all__ = [
    "CATEGORIES",
    "EPISODES_PER_HOUSE",
    "HABITAT_CATEGORIES",
    "SPLITS",
    "Difficulty",
    "HouseSplit",
    "Spread",
    "difficulty",
    "house_episodes",
    "load_split",
    "split_named",
]
