"""Construction of scenes by name."""

from pathlib import Path

from hypernav.build.registries import SCENES
from hypernav.core.errors import SceneError
from hypernav.core.whole_numbers import is_whole_number
from hypernav.houses.house_cache import cached_house
from hypernav.houses.numbers import BUILTIN_HOUSE
from hypernav.worlds.scenes.loading import load_scene
from hypernav.worlds.scenes.scene import Scene


def build_scene(spec: str) -> Scene:
    """A scene by name.

    Args:
        spec: Name of the scene: ``builtin``, ``houses:N`` for the generated house of number N, a
            name that an installed package brings, or the path of a GLB.

    Raises:
        SceneError: The file cannot be used, or there is no such house.
    """
    if not SCENES.knows(spec.partition(":")[0]):
        return load_scene(Path(spec))
    choice = SCENES.find(spec)
    return choice.load()(*choice.arguments)


def builtin_house() -> Scene:
    """The house that comes with this package."""
    return cached_house(BUILTIN_HOUSE)


def numbered_house(number: str) -> Scene:
    """A generated house.

    Raises:
        SceneError: The text is no number of a house.
    """
    return cached_house(house_number(number))


def house_number(text: str) -> int:
    """The number of a house, as people write it.

    Raises:
        SceneError: The text is no such number.
    """
    if not is_whole_number(text):
        raise SceneError(
            f"there is no house '{text:.40}'; expected a whole number of at most nine digits, for "
            "example houses:1234"
        )
    return int(text)
