"""Small simulated worlds that episodes run in within seconds."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

from box_scenes import room_boxes, scene_of
from hypernav.app.build.components.component_specs import PresetName
from hypernav.app.build.presets import HyPerNavConfig, preset
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer, RenderConfig
from hypernav.simulator.worlds.scenes.scene import Scene
from hypernav.simulator.worlds.simulation import SimulatedWorld

_CAMERA = {"width": 160, "height": 120}


def small_config(name: PresetName = "default", **sections) -> HyPerNavConfig:
    """A preset with a small camera, so that an episode takes a second."""
    config = preset(name).model_dump()
    config["embodiment"]["camera"] |= _CAMERA
    for section, values in sections.items():
        config[section] |= values
    return HyPerNavConfig.model_validate(config)


@dataclass(frozen=True)
class InScenes:
    """A world of a `Job` in scenes that a function makes; it can be pickled if that can."""

    open_scene: Callable[[str], Scene]

    def __call__(self, scene: str, config: HyPerNavConfig) -> SimulatedWorld:
        """The scene of a name as a world."""
        opened = self.open_scene(scene)
        renderer = CpuRenderer(opened, RenderConfig(threads=1))
        return SimulatedWorld(opened, config.world, config.embodiment, renderer=renderer)


def colourless_world(scene: Scene, config: HyPerNavConfig) -> SimulatedWorld:
    """A scene as a world of black images, for searches with ground truth, which looks at none.

    So a step takes a third less time.
    """
    renderer = CpuRenderer(scene, RenderConfig(colours=False))
    return SimulatedWorld(scene, config.world, config.embodiment, renderer=renderer)


@cache
def two_rooms(*, coloured: bool = True) -> SimulatedWorld:
    """A living room with a sofa, and behind a wall with a door a bedroom with a bed.

    The living room spans x 0 to 5, the bedroom x 5 to 9; the door is at y 2.6 to 3.6.
    """
    if not coloured:
        return colourless_world(two_rooms().scene, small_config())
    boxes = [
        *room_boxes(9.0, 4.0),
        (None, (4.95, 0.0, 0.0), (5.05, 2.6, 2.5)),
        (None, (4.95, 3.6, 0.0), (5.05, 4.0, 2.5)),
        ("sofa", (0.1, 1.2, 0.0), (0.9, 2.8, 0.7)),
        ("bed", (7.0, 0.1, 0.0), (8.9, 1.7, 0.5)),
    ]
    config = small_config()
    return SimulatedWorld(scene_of(*boxes, name="two rooms"), config.world, config.embodiment)
