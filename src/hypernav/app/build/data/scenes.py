"""Loads scenes by name."""

import difflib
import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from hypernav.core.components.registry import Entry, Registry
from hypernav.core.errors import SceneError
from hypernav.core.naming.words import is_whole_number
from hypernav.simulator.worlds.config import SimulationConfig

if TYPE_CHECKING:
    from hypernav.simulator.worlds.scenes.scene import Scene

_BUILDINGS = "hypernav.simulator.houses.named_scenes"

SCENES: Registry[Callable[..., "Scene"]] = Registry(
    "scene",
    "hypernav.scenes",
    [
        Entry("builtin", f"{_BUILDINGS}:builtin_house"),
        Entry("houses", f"{_BUILDINGS}:numbered_house", form="houses:N"),
        Entry("offices", f"{_BUILDINGS}:numbered_office", form="offices:N"),
        Entry("shops", f"{_BUILDINGS}:numbered_shop", form="shops:N"),
        Entry("crowded", f"{_BUILDINGS}:numbered_crowded_office", form="crowded:N"),
        Entry("storeys", f"{_BUILDINGS}:numbered_storeyed_building", form="storeys:N"),
    ],
)
"""Scenes that are not files: functions of the text after the name."""


def is_no_file(spec: str) -> bool:
    """Whether a scene is one of those that are no files, such as ``houses:7``."""
    return SCENES.knows(spec.partition(":")[0])


def load_scene(spec: str | Path, simulation: SimulationConfig | None = None) -> "Scene":
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
        # imported here: who names scenes, as the program that gives them to workers, reads none
        from hypernav.simulator.worlds.scans.scan_loading import open_scene

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
