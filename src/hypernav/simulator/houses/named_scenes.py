"""The generated buildings as scenes: what ``builtin`` and ``houses:7`` mean."""

from functools import partial

from hypernav.core.errors import SceneError
from hypernav.core.naming.words import is_whole_number
from hypernav.simulator.houses.building import BUILTIN_HOUSE, NOUNS, Building, house
from hypernav.simulator.houses.house_cache import cached_building
from hypernav.simulator.worlds.scenes.scene import Scene


def builtin_house() -> Scene:
    """The house that comes with this package."""
    return cached_building(house(BUILTIN_HOUSE))


def numbered_building(kind: str, number: str) -> Scene:
    """A generated building.

    Raises:
        SceneError: The text is no number of a building.
    """
    return cached_building(building_of(f"{kind}:{number}"))


numbered_house = partial(numbered_building, "houses")
"""House of a number."""

numbered_office = partial(numbered_building, "offices")
"""Office of a number."""

numbered_shop = partial(numbered_building, "shops")
"""Shop of a number."""

numbered_crowded_office = partial(numbered_building, "crowded")
"""Crowded office of a number."""

numbered_storeyed_building = partial(numbered_building, "storeys")
"""Home or office of two or three storeys of a number."""


def building_of(scene: str) -> Building:
    """The generated building that a scene's name means.

    Args:
        scene: For example ``offices:7``; a number alone, such as ``7``, is that of a house.

    Raises:
        SceneError: The text names no generated building.
    """
    kind, colon, number = scene.rpartition(":")
    kind = kind if colon else "houses"
    if kind not in NOUNS:
        raise SceneError(
            f"there are no generated '{kind:.40}'; expected {', '.join(f'{k}:N' for k in NOUNS)}"
        )
    if not is_whole_number(number):
        noun = NOUNS[kind].replace("-", " ")
        raise SceneError(
            f"there is no {noun} '{number:.40}'; expected a whole number of at most nine digits, "
            f"for example {kind}:1234"
        )
    return Building(kind, int(number))
