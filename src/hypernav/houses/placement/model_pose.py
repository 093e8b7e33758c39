"""Poses of models in a room, and the space that they occupy."""

from dataclasses import dataclass

from hypernav.houses.modelling.mesh import rotation_matrix
from hypernav.houses.modelling.model import Model
from hypernav.houses.placement.free_floor import Point
from hypernav.houses.plan.shapes import Rect

GAP_M = 0.02
"""Smallest gap between pieces of furniture, metres."""

SKIRTING_M = 0.018
"""Gap between furniture and a wall, for the skirting board, metres."""

SIDES = ("south", "east", "north", "west")
YAW = {"south": 0.0, "east": 90.0, "north": 180.0, "west": -90.0}
"""Yaw of a model with its back to a wall, degrees."""


@dataclass(frozen=True)
class Obstacle:
    """Space that an object occupies: a rectangle on the floor and a range of heights, metres."""

    rect: Rect
    low: float
    high: float


@dataclass(frozen=True)
class ModelPose:
    """Pose that a model could take: centre of its footprint, yaw and height."""

    x: float
    y: float
    yaw_deg: float
    z: float = 0.0


def footprint(model: Model, pose: ModelPose) -> Rect:
    """Rectangle on the floor that a model covers at a pose."""
    quarter = round(pose.yaw_deg / 90.0)
    if abs(pose.yaw_deg - 90.0 * quarter) < 1e-9:
        w, d = (model.width, model.depth) if quarter % 2 == 0 else (model.depth, model.width)
    else:
        # at other angles a square that covers it
        w = d = 0.93 * (model.width**2 + model.depth**2) ** 0.5
    return Rect(pose.x - w / 2, pose.y - d / 2, pose.x + w / 2, pose.y + d / 2)


def turned_point(x: float, y: float, yaw_deg: float) -> Point:
    """Point of a model's frame rotated by the model's yaw; exact for quarter turns."""
    r = rotation_matrix(yaw_deg)
    return float(x * r[0, 0] + y * r[0, 1]), float(x * r[1, 0] + y * r[1, 1])
