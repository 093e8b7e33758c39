"""Whatever yields observations and takes actions: scenes, renderer, walkable surface, houses."""

from hypernav.worlds.embodiment import ActionConfig, CameraConfig, RobotConfig
from hypernav.worlds.geodesic import DistanceField
from hypernav.worlds.goal_regions import GoalRegion, GoalRegions
from hypernav.worlds.loading import load_scene
from hypernav.worlds.rays import RayCaster
from hypernav.worlds.renderer import EmbreeRenderer, RenderConfig
from hypernav.worlds.scene import Instance, Material, Scene, Wrap
from hypernav.worlds.viewpoints import view_points
from hypernav.worlds.walkable import WalkableGrid

__all__ = [
    "ActionConfig",
    "CameraConfig",
    "DistanceField",
    "EmbreeRenderer",
    "GoalRegion",
    "GoalRegions",
    "Instance",
    "Material",
    "RayCaster",
    "RenderConfig",
    "RobotConfig",
    "Scene",
    "WalkableGrid",
    "Wrap",
    "load_scene",
    "view_points",
]
