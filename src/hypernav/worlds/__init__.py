"""Whatever yields observations and takes actions: scenes, renderer, walkable surface, houses."""

from hypernav.worlds.embodiment import ActionConfig, CameraConfig, RobotConfig
from hypernav.worlds.env import ObjectNavConfig, ObjectNavEnv, register_env
from hypernav.worlds.geodesic import DistanceField
from hypernav.worlds.goal_regions import GoalRegion, GoalRegions
from hypernav.worlds.loading import load_scene
from hypernav.worlds.noise import NoiseConfig
from hypernav.worlds.rays import RayCaster
from hypernav.worlds.referee import Referee
from hypernav.worlds.renderer import CpuRenderer, RenderConfig
from hypernav.worlds.scene import Instance, Material, Scene, Wrap
from hypernav.worlds.simulation import SimulatedWorld, SimulationConfig
from hypernav.worlds.starts import random_start
from hypernav.worlds.viewpoints import view_points
from hypernav.worlds.walkable import WalkableGrid

__all__ = [
    "ActionConfig",
    "CameraConfig",
    "CpuRenderer",
    "DistanceField",
    "GoalRegion",
    "GoalRegions",
    "Instance",
    "Material",
    "NoiseConfig",
    "ObjectNavConfig",
    "ObjectNavEnv",
    "RayCaster",
    "Referee",
    "RenderConfig",
    "RobotConfig",
    "Scene",
    "SimulatedWorld",
    "SimulationConfig",
    "WalkableGrid",
    "Wrap",
    "load_scene",
    "random_start",
    "register_env",
    "view_points",
]

register_env()
