"""The worlds that this package brings: scenes in our own simulator, and in habitat-sim."""

from dataclasses import replace
from pathlib import Path

from hypernav.app.build.data.scenes import load_scene
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.errors import SceneError
from hypernav.simulator.worlds.drawing.renderer import RenderConfig, renderer_of
from hypernav.simulator.worlds.habitat import HabitatRenderer, HabitatSurface, navmesh_of
from hypernav.simulator.worlds.scenes.scene import Scene
from hypernav.simulator.worlds.simulation import SimulatedWorld


def native_world(scene: str, config: HyPerNavConfig, threads: int | None = None) -> SimulatedWorld:
    """A scene in our own simulator."""
    loaded = _with_navmesh(load_scene(scene, config.world), Path(scene), config)
    return in_our_own(loaded, config, threads=threads)


def in_our_own(
    scene: Scene, config: HyPerNavConfig, *, threads: int | None = None
) -> SimulatedWorld:
    """A loaded scene in our own simulator."""
    renderer = renderer_of(scene, config.world.renderer, RenderConfig(threads=threads))
    return SimulatedWorld(scene, config.world, config.embodiment, renderer=renderer)


def habitat_world(scene: str, config: HyPerNavConfig) -> SimulatedWorld:
    """A scene's file in habitat-sim, which draws and moves."""
    mesh = Path(scene)
    if not mesh.is_file():
        raise SceneError(f"{scene}: habitat-sim opens files only, such as those of hm3d:DIR")
    if config.world.file_up is not None or config.world.file_scale is not None:
        raise SceneError(
            f"{scene}: habitat-sim reads files by their format alone; leave world.file_up and "
            "world.file_scale out, or use --world native"
        )
    return in_habitat(_with_navmesh(load_scene(scene, config.world), mesh, config), mesh, config)


def in_habitat(scene: Scene, mesh: Path, config: HyPerNavConfig) -> SimulatedWorld:
    """A loaded scene and its file in habitat-sim."""
    drawn = HabitatRenderer(scene, mesh, config.embodiment, config.world.navmesh)
    surface = HabitatSurface(drawn.path_finder)
    return SimulatedWorld(scene, config.world, config.embodiment, renderer=drawn, walkable=surface)


def _with_navmesh(scene: Scene, mesh: Path, config: HyPerNavConfig) -> Scene:
    """The scene with the navigation mesh beside its file; also of a house that was exported."""
    if config.world.navmesh == "file" and mesh.is_file():
        return replace(scene, navmesh=navmesh_of(scene, mesh))
    return scene
