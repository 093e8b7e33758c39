"""Places for furniture: walls, spots, and the space that things take."""

from dataclasses import dataclass

from hypernav.houses.modelling.mesh import rotation_matrix
from hypernav.houses.modelling.model import Model
from hypernav.houses.placement.free_floor import Point
from hypernav.houses.plan.shapes import Rect

GAP_M = 0.02
"""Least gap between pieces of furniture."""

SKIRTING_M = 0.018
"""Gap between furniture and a wall, for the skirting."""

SIDES = ("south", "east", "north", "west")
YAW = {"south": 0.0, "east": 90.0, "north": 180.0, "west": -90.0}
"""Turn of what stands with its back to a wall."""


@dataclass(frozen=True)
class Obstacle:
    """The space that something takes."""

    rect: Rect
    low: float
    high: float


@dataclass(frozen=True)
class ModelPose:
    """A place that a model could take: its middle and its turn."""

    x: float
    y: float
    yaw_deg: float
    z: float = 0.0


def footprint(model: Model, pose: ModelPose) -> Rect:
    """The rectangle on the floor that a model covers at a spot."""
    quarter = round(pose.yaw_deg / 90.0)
    if abs(pose.yaw_deg - 90.0 * quarter) < 1e-9:
        w, d = (model.width, model.depth) if quarter % 2 == 0 else (model.depth, model.width)
    else:
        # A circle around it holds for every other angle.
        w = d = 0.93 * (model.width**2 + model.depth**2) ** 0.5
    return Rect(pose.x - w / 2, pose.y - d / 2, pose.x + w / 2, pose.y + d / 2)


def turned_point(x: float, y: float, yaw_deg: float) -> Point:
    """A point of a model's frame after the model's turn; exact for quarter turns."""
    r = rotation_matrix(yaw_deg)
    return float(x * r[0, 0] + y * r[0, 1]), float(x * r[1, 0] + y * r[1, 1])
