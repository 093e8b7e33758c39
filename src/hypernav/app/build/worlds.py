"""Opens worlds by name: our own simulator, habitat-sim, or one of your own."""

from collections.abc import Callable

from hypernav.app.build.components.construction import make
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.components.door import through_door
from hypernav.core.components.registry import Entry, Registry
from hypernav.core.world import Simulator

WORLDS: Registry[Callable[..., Simulator]] = Registry(
    "world",
    "hypernav.worlds",
    [
        Entry("native", "hypernav.app.build.our_worlds:native_world"),
        Entry("habitat", "hypernav.app.build.our_worlds:habitat_world"),
    ],
)
"""Simulators: functions of any of ``scene`` (its name), ``config`` and ``threads``, all by name."""


def open_world(
    scene: str, config: HyPerNavConfig, world: str = "native", *, threads: int | None = None
) -> Simulator:
    """Open a scene in a world.

    Args:
        scene: Name of the scene, or its file.
        config: The robot, and how it is simulated.
        world: Name of the world, or ``package.module:Name`` of a function of your own.
        threads: Threads that draw; None uses all cores.

    Raises:
        SceneError: The scene can't be opened, or the robot fits nowhere.
        ConfigError: There is no such world.
        MissingExtraError: habitat-sim is not installed, or what the renderer needs.
    """
    offers = {"scene": scene, "config": config, "threads": threads}
    return through_door(make(WORLDS.find(world), offers), Simulator)
