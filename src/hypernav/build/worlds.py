"""Opens worlds: our own simulator, or habitat-sim."""

from dataclasses import dataclass, replace
from pathlib import Path

from hypernav.build.component_specs import WorldName
from hypernav.build.presets import HyPerNavConfig
from hypernav.core.errors import SceneError
from hypernav.worlds.drawing.choice import SceneRenderer, renderer_of
from hypernav.worlds.drawing.renderer import RenderConfig
from hypernav.worlds.habitat.path_finder import HabitatSurface
from hypernav.worlds.habitat.simulator import HabitatRenderer, navmesh_of
from hypernav.worlds.scenes.scene import Scene
from hypernav.worlds.simulation import SimulatedWorld


@dataclass(frozen=True, eq=False)
class OpenedWorld:
    """A world, and the renderer that draws it.

    Attributes:
        world: The world.
        renderer: Its renderer, whose colours may be switched off.
    """

    world: SimulatedWorld
    renderer: SceneRenderer | HabitatRenderer


def open_world(
    scene: Scene, scene_id: str, config: HyPerNavConfig, name: WorldName = "native"
) -> OpenedWorld:
    """Open a scene in a world; drawing uses one thread.

    Args:
        scene: The scene.
        scene_id: Name of the scene; for habitat-sim the path of its file.
        config: The robot, and how it is simulated.
        name: The world.

    Raises:
        SceneError: The robot fits nowhere, or habitat-sim can't open the scene.
        MissingExtraError: habitat-sim is not installed, or what the renderer needs.
    """
    mesh = Path(scene_id)
    if config.world.navmesh == "file" and mesh.is_file():  # also of a house that was exported
        scene = replace(scene, navmesh=navmesh_of(scene, mesh))
    if name == "native":
        renderer = renderer_of(scene, config.world.renderer, RenderConfig(threads=1))
        world = SimulatedWorld(scene, config.world, config.embodiment, renderer=renderer)
        return OpenedWorld(world, renderer)
    if not mesh.is_file():
        raise SceneError(f"{scene_id}: habitat-sim opens files only, such as those of hm3d:DIR")
    if config.world.file_up is not None or config.world.file_scale is not None:
        raise SceneError(
            f"{scene_id}: habitat-sim reads files by their format alone; leave world.file_up and "
            "world.file_scale out, or use --world native"
        )
    drawn = HabitatRenderer(scene, mesh, config.embodiment, config.world.navmesh)
    surface = HabitatSurface(drawn.path_finder)
    world = SimulatedWorld(scene, config.world, config.embodiment, renderer=drawn, walkable=surface)
    return OpenedWorld(world, drawn)
