"""Furnishing of all rooms of a building, one after the other, without what nobody could see."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from hypernav.simulator.houses.assembly import PlacedModel
from hypernav.simulator.houses.furnishing.room_layout import Obstacle, RoomLayout
from hypernav.simulator.houses.modelling.materials import Palette, vary
from hypernav.simulator.houses.modelling.model import rotation_matrix
from hypernav.simulator.houses.plan.floor_plan import FloorPlan, Rect
from hypernav.simulator.houses.random_stream import RandomStream

_ATTEMPTS = 12

RequiredGroups = tuple[tuple[str, ...], ...]
"""Categories that a room must hold: at least one of each group."""
_CAMERA_HEIGHT_M = 0.88
_VIEW_RANGE_M = 0.92
_SURFACE_POINTS = 20
_MAX_VIEW_POSITIONS = 12
_MIN_VISIBLE_SHARE = 0.2
_MIN_VIEW_POSITIONS = 2
_ON_TOP_M = 0.02


@dataclass(frozen=True)
class Furnishing:
    """Rules by which the rooms of one kind of building are furnished.

    Attributes:
        required: Gives the groups of categories that the room with an index must hold.
        furnish: Furnishes an empty room by its kind.
        dress: Adds what hangs on walls and ceilings of a furnished room.
    """

    required: Callable[[FloorPlan, int], RequiredGroups]
    furnish: Callable[[RoomLayout], None]
    dress: Callable[[RoomLayout], None]


def furnish_rooms(
    plan: FloorPlan, rules: Furnishing, palette: Palette, rng: RandomStream
) -> list[PlacedModel]:
    """Random furniture and other objects of all rooms."""
    pieces: list[PlacedModel] = []
    for number, room in enumerate(plan.rooms):
        if plan.stairwell is not None and number == plan.stairwell.room:
            continue
        own = rng.fork("room", number)
        layout = _best_layout(plan, number, rules, own, vary(palette, own.fork("taste")))
        if not room.is_outside:
            rules.dress(layout)
        remove_hidden(layout)
        pieces += layout.placed
    return pieces


def _best_layout(
    plan: FloorPlan, number: int, rules: Furnishing, rng: RandomStream, palette: Palette
) -> RoomLayout:
    """Layout of a room with all required objects, or the best of several attempts."""
    required = rules.required(plan, number)
    best: tuple[int, RoomLayout] | None = None
    for attempt in range(_ATTEMPTS):
        layout = RoomLayout(plan, number, rng.fork("attempt", attempt), palette)
        rules.furnish(layout)
        there = {p.model.category for p in layout.placed}
        score = sum(any(name in there for name in group) for group in required)
        if best is None or score > best[0]:
            best = (score, layout)
        if score == len(required):
            break
    assert best is not None
    return best[1]


def remove_hidden(layout: RoomLayout) -> None:
    """Remove small objects and pictures that no robot could see.

    An object that is hidden behind furniture, or hangs out of reach above a bed, can't be a goal.
    The test is strict: bounding boxes of other objects occlude, and a sufficient share of the
    object's own surface points must be visible from positions beside it where a robot can stand.
    """
    standing_points = layout.standing_points()
    for piece in [p for p in layout.placed if layout.is_removable(p)]:
        if layout.is_obstacle(piece) and not _is_visible(piece, layout, standing_points):
            layout.remove(piece)


def _is_visible(
    piece: PlacedModel, layout: RoomLayout, standing_points: Float64[np.ndarray, "n 2"]
) -> bool:
    own = layout.obstacle_of(piece)
    x = np.maximum(
        np.maximum(own.rect.x0 - standing_points[:, 0], standing_points[:, 0] - own.rect.x1), 0.0
    )
    y = np.maximum(
        np.maximum(own.rect.y0 - standing_points[:, 1], standing_points[:, 1] - own.rect.y1), 0.0
    )
    near = standing_points[x * x + y * y <= _VIEW_RANGE_M**2]
    if len(near) == 0:
        return False
    near = near[:: max(len(near) // _MAX_VIEW_POSITIONS, 1)]
    targets = _surface_points(piece)
    cameras = np.column_stack([near, np.full(len(near), _CAMERA_HEIGHT_M)])
    clear = _is_unobstructed(
        np.repeat(cameras, len(targets), axis=0),
        np.tile(targets, (len(cameras), 1)),
        _occluders(own, layout),
    )
    seeing = clear.reshape(len(cameras), -1).mean(axis=1) >= _MIN_VISIBLE_SHARE
    return int(seeing.sum()) >= min(_MIN_VIEW_POSITIONS, len(cameras))


def _occluders(own: Obstacle, layout: RoomLayout) -> list[Obstacle]:
    """Obstacles that may occlude an object.

    Objects that it lies in (a sofa) and curtains occlude by their parts, not as a whole.
    """
    whole = {id(s) for s in layout.obstacles if s is not own and not _lies_within(s, own)}
    others: list[Obstacle] = []
    for piece in layout.placed:
        if not layout.is_obstacle(piece) or layout.obstacle_of(piece) is own:
            continue
        obstacle = layout.obstacle_of(piece)
        if _lies_within(obstacle, own) or piece.model.category.endswith("curtain"):
            others += [s for s in _parts_of(piece) if not _lies_within(s, own)]
            whole.discard(id(obstacle))
    return others + [s for s in layout.obstacles if id(s) in whole]


def _lies_within(outer: Obstacle, inner: Obstacle) -> bool:
    """Whether an obstacle lies within another, not on top of it."""
    return outer.rect.holds(inner.rect) and outer.low < inner.low < outer.high - _ON_TOP_M


def _parts_of(piece: PlacedModel) -> list[Obstacle]:
    """Bounding boxes of the parts of a placed model."""
    obstacles = []
    for part in piece.model.parts:
        points = _to_scene(part.mesh.positions, piece)
        (x0, y0, z0), (x1, y1, z1) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
        obstacles.append(Obstacle(Rect(x0, y0, x1, y1), z0, z1))
    return obstacles


def _surface_points(piece: PlacedModel) -> Float64[np.ndarray, "n 3"]:
    """Sample of a placed model's vertices, scene frame."""
    points = np.concatenate([part.mesh.positions for part in piece.model.parts])
    return _to_scene(points[:: max(len(points) // _SURFACE_POINTS, 1)], piece)


def _to_scene(points: Float64[np.ndarray, "n 3"], piece: PlacedModel) -> Float64[np.ndarray, "n 3"]:
    """Points of a model's frame in the scene frame."""
    r = rotation_matrix(piece.yaw_deg)
    x = points[:, 0] * r[0, 0] + points[:, 1] * r[0, 1]
    y = points[:, 0] * r[1, 0] + points[:, 1] * r[1, 1]
    return np.column_stack([x + piece.x, y + piece.y, points[:, 2] + piece.z])


def _is_unobstructed(
    starts: Float64[np.ndarray, "n 3"], ends: Float64[np.ndarray, "n 3"], obstacles: list[Obstacle]
) -> Bool[np.ndarray, "n"]:
    """Mask of the line segments that meet no obstacle."""
    if not obstacles:
        return np.ones(len(starts), dtype=bool)
    low = np.array([(s.rect.x0, s.rect.y0, s.low) for s in obstacles])
    high = np.array([(s.rect.x1, s.rect.y1, s.high) for s in obstacles])
    ray = ends - starts
    ray = np.where(np.abs(ray) < 1e-9, 1e-9, ray)[:, None]
    a, b = (low - starts[:, None]) / ray, (high - starts[:, None]) / ray
    enter = np.minimum(a, b).max(axis=2)
    leave = np.maximum(a, b).min(axis=2)
    hit = (enter < leave) & (leave > 0.0) & (enter < 0.999)
    return ~hit.any(axis=1)
