"""Furnished houses, generated in code."""

from hypernav.worlds.houses.build import BUILTIN_HOUSE, build_house

__all__ = ["BUILTIN_HOUSE", "build_house"]
