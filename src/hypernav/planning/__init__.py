"""A* on the inflated map, steering, and the navigator that puts them together."""

from hypernav.planning.bumps import BumpSensor
from hypernav.planning.config import PlanningConfig
from hypernav.planning.follower import PathFollower
from hypernav.planning.navigator import Navigator
from hypernav.planning.planner import Path, Planner

__all__ = ["BumpSensor", "Navigator", "Path", "PathFollower", "Planner", "PlanningConfig"]
