"""Furnished houses, generated in code."""

from hypernav.worlds.houses.build import BUILTIN_HOUSE, build_house
from hypernav.worlds.houses.cache import cached_house

__all__ = ["BUILTIN_HOUSE", "build_house", "cached_house"]
