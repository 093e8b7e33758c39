"""Rows of shelves with aisles between them, along the walls and in the middle of a hall."""

from collections.abc import Sequence
from math import ceil

from hypernav.houses.assembly import PlacedModel
from hypernav.houses.modelling.model import Model
from hypernav.houses.placement.model_pose import SIDES, ModelPose
from hypernav.houses.placement.room_layout import RoomLayout
from hypernav.houses.plan.shapes import FloorPlan, Rect

_CROSS_AISLE_M = 1.5
_LONGEST_RUN = 7
"""Greatest number of shelves in a row without a gap to walk through."""


def front_side(layout: RoomLayout) -> str:
    """Side of a hall that customers come in by: that of the front door, or of a wide passage."""
    for kind in ("entrance", "passage", "doorway", "door"):
        for side in SIDES:
            if any(opening.kind == kind for opening in layout.wall_openings(side)):
                return side
    return SIDES[0]


def has_till(plan: FloorPlan, number: int) -> bool:
    """Whether customers of a hall pay in it: it has the front door, or is a shop of an arcade."""
    return any(
        opening.kind == "entrance"
        or (opening.is_passable and "arcade" in {plan.rooms[k].kind for k in opening.rooms})
        for opening in plan.openings_of(number)
    )


def behind(inner: Rect, front: str, deep: float) -> Rect:
    """Floor of a hall without the zone at its front."""
    return Rect(
        inner.x0 + (deep if front == "west" else 0.0),
        inner.y0 + (deep if front == "south" else 0.0),
        inner.x1 - (deep if front == "east" else 0.0),
        inner.y1 - (deep if front == "north" else 0.0),
    )


def line_walls(layout: RoomLayout, models: Sequence[Model], sides: Sequence[str]) -> None:
    """Place shelves side by side along walls, wherever they fit."""
    for side in sides:
        start, end, _ = layout.wall_line(side)
        at = start + 0.03
        model = layout.rng.choice(models)
        while at + model.width <= end - 0.02:
            pose = layout.pose_at_wall(model, side, round(at + model.width / 2, 3))
            if layout.fits(model, pose, front=0.9, tight=True):
                layout.place(model, pose)
                at += model.width + 0.004
                model = layout.rng.choice(models)
            else:
                at += 0.25


def place_aisles(
    layout: RoomLayout, models: Sequence[Model], zone: Rect, aisle_m: float
) -> list[PlacedModel]:
    """Place rows of double-sided shelves in a zone, with cross aisles in long rows.

    Args:
        layout: Layout of the hall.
        models: Shelves to choose from, all equally deep.
        zone: Floor that the rows and the aisles at their ends cover.
        aisle_m: Width of the aisles, metres.
    """
    rng = layout.rng
    along_x = (zone.width >= zone.depth) != rng.chance(0.35)
    long, short = (zone.width, zone.depth) if along_x else (zone.depth, zone.width)
    wide, deep = models[0].width, models[0].depth
    rows = int((short + aisle_m) / (deep + aisle_m))
    runs = max(ceil(long / (_LONGEST_RUN * wide + _CROSS_AISLE_M)), 1)
    count = max(int((long - _CROSS_AISLE_M * (runs - 1)) / runs / (wide + 0.004)), 0)
    run_m = count * (wide + 0.004)
    spare = long - runs * run_m - (runs - 1) * _CROSS_AISLE_M
    placed = []
    for row in range(rows):
        v = short * (row + 0.5) / rows
        one_kind = rng.choice(models)
        for k in range(runs * count):
            run, place = divmod(k, count)
            u = spare / 2 + run * (run_m + _CROSS_AISLE_M) + (place + 0.5) * (wide + 0.004)
            x, y = (zone.x0 + u, zone.y0 + v) if along_x else (zone.x0 + v, zone.y0 + u)
            pose = ModelPose(round(x, 3), round(y, 3), 0.0 if along_x else 90.0)
            model = one_kind if rng.chance(0.4) else rng.choice(models)
            if layout.fits(model, pose, tight=True):
                placed.append(layout.place(model, pose))
    return placed


def grid_points(zone: Rect, every_m: float) -> list[tuple[float, float]]:
    """Points of a zone, evenly spread."""
    columns, rows = (max(int(side / every_m + 0.3), 1) for side in (zone.width, zone.depth))
    return [
        (
            round(zone.x0 + zone.width * (column + 0.5) / columns, 3),
            round(zone.y0 + zone.depth * (row + 0.5) / rows, 3),
        )
        for column in range(columns)
        for row in range(rows)
    ]
