"""Whatever yields observations and takes actions: scenes, renderer, walkable surface, houses."""

from hypernav.worlds.loading import load_scene
from hypernav.worlds.renderer import EmbreeRenderer, RenderConfig
from hypernav.worlds.scene import Instance, Material, Scene, Wrap

__all__ = [
    "EmbreeRenderer",
    "Instance",
    "Material",
    "RenderConfig",
    "Scene",
    "Wrap",
    "load_scene",
]
