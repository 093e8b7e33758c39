"""Loads scenes by name."""

import difflib
import os
from collections.abc import Callable
from functools import partial
from pathlib import Path

from hypernav.core.components.registry import Entry, Registry
from hypernav.core.errors import SceneError
from hypernav.core.words import is_whole_number
from hypernav.simulator.houses.building import BUILTIN_HOUSE, NOUNS, Building, house
from hypernav.simulator.houses.house_cache import cached_building
from hypernav.simulator.worlds.config import SimulationConfig
from hypernav.simulator.worlds.scans.scan_loading import open_scene
from hypernav.simulator.worlds.scenes.scene import Scene

SCENES: Registry[Callable[..., Scene]] = Registry(
    "scene",
    "hypernav.scenes",
    [
        Entry("builtin", "hypernav.app.build.data.scenes:builtin_house"),
        Entry("houses", "hypernav.app.build.data.scenes:numbered_house", form="houses:N"),
        Entry("offices", "hypernav.app.build.data.scenes:numbered_office", form="offices:N"),
        Entry("shops", "hypernav.app.build.data.scenes:numbered_shop", form="shops:N"),
        Entry(
            "crowded", "hypernav.app.build.data.scenes:numbered_crowded_office", form="crowded:N"
        ),
        Entry(
            "storeys", "hypernav.app.build.data.scenes:numbered_storeyed_building", form="storeys:N"
        ),
    ],
)
"""Scenes that are not files: functions of the text after the name."""


def is_no_file(spec: str) -> bool:
    """Whether a scene is one of those that are no files, such as ``houses:7``."""
    return SCENES.knows(spec.partition(":")[0])


def load_scene(spec: str | Path, simulation: SimulationConfig | None = None) -> Scene:
    """Load a scene by name.

    Args:
        spec: Name of the scene: ``builtin``, ``houses:N``, ``offices:N``, ``shops:N``,
            ``crowded:N`` or ``storeys:N`` for the generated building of number N, a name that an
            installed package provides, or the path of a GLB, another model or a Gazebo world.
        simulation: How the robot is simulated: it says how files are read.

    Raises:
        SceneError: The file cannot be used, or there is no such building.
    """
    spec, config = str(spec), simulation or SimulationConfig()
    up, scale = config.file_up, config.file_scale
    if not is_no_file(spec):
        if not os.path.exists(spec):  # unlike Path.exists, it accepts any name
            _refuse_other_names(spec)
        return open_scene(Path(spec), up=up, scale=scale)
    if up is not None or scale is not None:
        raise SceneError(f"{spec}: is no file; leave world.file_up and world.file_scale out")
    choice = SCENES.find(spec)
    return choice.load()(*choice.arguments)


def _refuse_other_names(spec: str) -> None:
    """Refuse the name of a split, and one that is almost that of a scene."""
    # imported here, so that a search in one building loads no code of episodes
    from hypernav.lab.datasets.building_splits import SPLITS

    if split := SPLITS.get(spec.partition("#")[0]):
        number = spec.partition("#")[2].partition(":")[0]
        building = f"{split.kind}:{number if is_whole_number(number) else split.numbers.start}"
        raise SceneError(
            f"'{spec:.40}' is a split of many searches, no scene; for one of its buildings say "
            f"'{building}', for its searches run hypernav eval '{spec:.40}'"
        )
    name, colon, number = spec.partition(":")
    close = difflib.get_close_matches(name, SCENES.names, n=1)
    if close and not Path(spec).suffix:
        raise SceneError(
            f"there is no scene '{spec:.40}'; did you mean '{close[0]}{colon}{number:.20}'?"
        )


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
