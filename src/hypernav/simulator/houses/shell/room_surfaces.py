"""Walls with holes for doors and windows, floors, ceilings and skirting boards of all rooms."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from hypernav.simulator.houses.assembly import PlacedModel
from hypernav.simulator.houses.modelling.model import Finish, Mesh, ModelBuilder, join
from hypernav.simulator.houses.modelling.solids import box
from hypernav.simulator.houses.plan.floor_plan import (
    OUTER_M,
    WALL_M,
    FloorPlan,
    Opening,
    Rect,
    Room,
)
from hypernav.simulator.houses.plan.openings import outer_walls
from hypernav.simulator.houses.shell.finishes import RoomFinish

Hole = tuple[float, float, float, float]
"""Hole in a wall: ``(start, end, bottom, top)``, metres along the wall and in height."""

_SKIRTING_M = 0.07
_CASING_M = 0.065
_FACADE = Finish("plaster", (0.86, 0.82, 0.75), 2.0)
_CAP = Finish("", (0.25, 0.25, 0.27))


def quad(corners: Sequence[tuple[float, float, float]], facing: tuple[float, float, float]) -> Mesh:
    """Rectangle from its four corners in order; texture coordinates are metres of the scene."""
    points = np.array(corners, dtype=np.float64)
    normal = np.array(facing, dtype=np.float64)
    turn = np.cross(points[1] - points[0], points[2] - points[0])
    if float((turn * normal).sum()) < 0:
        points = points[::-1]
    # Grain and tiles run along the longer horizontal axis of floors, upright on walls.
    axis = int(np.abs(normal).argmax())
    u, v = ((1, 2), (0, 2), (0, 1))[axis]
    faces = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int64)
    return Mesh(points, np.tile(normal, (4, 1)), points[:, [u, v]], faces)


def floor_quad(x0: float, y0: float, x1: float, y1: float, z: float, *, up: bool = True) -> Mesh:
    """Level rectangle that faces up or down."""
    corners = [(x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z)]
    return quad(corners, (0.0, 0.0, 1.0 if up else -1.0))


def wall_rects(start: float, end: float, high: float, holes: Sequence[Hole]) -> list[Hole]:
    """Rectangles of a wall from ``start`` to ``end`` around its holes."""
    rects: list[Hole] = []
    at = start
    for a, b, bottom, top in sorted(holes):
        a, b = max(a, start), min(b, end)
        if a > at:
            rects.append((at, a, 0.0, high))
        if bottom > 0.0:
            rects.append((a, b, 0.0, bottom))
        if top < high:
            rects.append((a, b, top, high))
        at = b
    if at < end:
        rects.append((at, end, 0.0, high))
    return rects


def wall_face(
    along: str, at: float, side: float, start: float, end: float, high: float, holes: Sequence[Hole]
) -> Mesh:
    """Visible face of a wall.

    Args:
        along: Axis that the wall runs along, "x" or "y".
        at: Coordinate of the face: y if the wall runs along x, else x.
        side: Direction that it faces: 1 to larger, -1 to smaller coordinates.
        start: Lower end along the wall.
        end: Upper end along the wall.
        high: Height of the wall, metres.
        holes: Holes in the wall.
    """
    meshes = []
    for a, b, low, top in wall_rects(start, end, high, holes):
        corners = [
            wall_point(along, a, at, low),
            wall_point(along, b, at, low),
            wall_point(along, b, at, top),
            wall_point(along, a, at, top),
        ]
        meshes.append(quad(corners, (0.0, side, 0.0) if along == "x" else (side, 0.0, 0.0)))
    return join(meshes)


def wall_point(along: str, t: float, across: float, z: float) -> tuple[float, float, float]:
    """Point at ``t`` along a wall and ``across`` it."""
    return (t, across, z) if along == "x" else (across, t, z)


def reveal(along: str, low: float, high: float, hole: Hole, *, sill: bool) -> Mesh:
    """Inner faces (reveal) of a hole through a wall between two planes."""
    a, b, bottom, top = hole
    meshes = []
    for t, side in ((a, 1.0), (b, -1.0)):
        corners = [
            wall_point(along, t, low, bottom),
            wall_point(along, t, high, bottom),
            wall_point(along, t, high, top),
            wall_point(along, t, low, top),
        ]
        meshes.append(quad(corners, (side, 0.0, 0.0) if along == "x" else (0.0, side, 0.0)))
    levels = [(top, -1.0)] + ([(bottom, 1.0)] if sill else [])
    for z, side in levels:
        corners = [
            wall_point(along, a, low, z),
            wall_point(along, b, low, z),
            wall_point(along, b, high, z),
            wall_point(along, a, high, z),
        ]
        meshes.append(quad(corners, (0.0, 0.0, side)))
    return join(meshes)


def structural_model(builder: ModelBuilder, name: str, room: str) -> PlacedModel:
    """Structural model of parts that were made in the scene frame."""
    model = builder.model(name)
    x = min(float(p.mesh.positions[:, 0].min()) for p in builder.parts)
    y = min(float(p.mesh.positions[:, 1].min()) for p in builder.parts)
    return PlacedModel(model, x - model.low[0], y - model.low[1], 0.0, 0.0, room, structural=True)


def build_rooms(plan: FloorPlan, finishes: Sequence[RoomFinish]) -> list[PlacedModel]:
    """Floor, walls and ceiling of every room, each as an instance of its own, and the facade."""
    pieces = []
    for number, (room, finish) in enumerate(zip(plan.rooms, finishes, strict=True)):
        inner = room.inner
        floor, ceiling, walls = ModelBuilder(), ModelBuilder(), ModelBuilder()
        for rect in _around(inner, plan.left_out(number, below=True)):
            floor.add(finish.floor, floor_quad(rect.x0, rect.y0, rect.x1, rect.y1, 0.0))
        for opening in plan.openings:
            if opening.bottom == 0.0 and number == max(opening.rooms):
                floor.add(finish.floor, _threshold(plan, opening))
        for rect in _around(inner, plan.left_out(number, below=False)):
            ceiling.add(
                finish.ceiling,
                floor_quad(rect.x0, rect.y0, rect.x1, rect.y1, plan.height, up=False),
            )
        pieces.append(structural_model(floor, "floor", room.name))
        if not room.is_outside:
            _walls(walls, plan, number, finish)
            pieces += [
                structural_model(walls, "wall", room.name),
                structural_model(ceiling, "ceiling", room.name),
            ]
    facade = ModelBuilder()
    for number, room in enumerate(plan.rooms):
        if not room.is_outside:
            _outside(facade, plan, number)
    pieces.append(structural_model(facade, "facade", ""))
    return pieces


def _around(inner: Rect, well: Sequence[Rect]) -> list[Rect]:
    """Rectangles that cover a room except for an opening."""
    if not well:
        return [inner]
    xs = sorted({inner.x0, inner.x1, *(x for r in well for x in (r.x0, r.x1))})
    ys = sorted({inner.y0, inner.y1, *(y for r in well for y in (r.y0, r.y1))})
    cells = [Rect(a, c, b, d) for a, b in pairwise(xs) for c, d in pairwise(ys)]
    return [cell for cell in cells if not any(rect.holds(cell) for rect in well)]


def _holes(openings: Sequence[Opening], along: str, at: float) -> list[Hole]:
    return [
        (o.start, o.end, o.bottom, o.top)
        for o in openings
        if o.along == along and abs(o.at - at) < 1e-6
    ]


def _sides(room: Room) -> list[tuple[str, float, float, float, float, float]]:
    """``(along, centre line, plane, facing, start, end)`` of the four walls."""
    c, i = room.cell, room.inner
    return [
        ("x", c.y0, i.y0, 1.0, i.x0, i.x1),
        ("x", c.y1, i.y1, -1.0, i.x0, i.x1),
        ("y", c.x0, i.x0, 1.0, i.y0, i.y1),
        ("y", c.x1, i.x1, -1.0, i.y0, i.y1),
    ]


def _walls(builder: ModelBuilder, plan: FloorPlan, number: int, finish: RoomFinish) -> None:
    room = plan.rooms[number]
    openings = plan.openings_of(number)
    stairs = plan.stairwell
    stands_over_stairs = stairs is not None and stairs.leads_down and number == stairs.room
    for along, middle, plane, facing, start, end in _sides(room):
        holes = _holes(openings, along, middle)
        builder.add(finish.wall, wall_face(along, plane, facing, start, end, plan.height, holes))
        if not stands_over_stairs:
            _skirting(builder, finish.trim, along, plane, facing, start, end, holes)
        for hole in holes:
            if hole[2] == 0.0:
                _casing(builder, finish.trim, along, plane, facing, hole)
    c = room.cell
    for rect in (
        Rect(c.x0, c.y0, c.x1, room.inner.y0),
        Rect(c.x0, room.inner.y1, c.x1, c.y1),
        Rect(c.x0, room.inner.y0, room.inner.x0, room.inner.y1),
        Rect(room.inner.x1, room.inner.y0, c.x1, room.inner.y1),
    ):
        builder.add(_CAP, floor_quad(rect.x0, rect.y0, rect.x1, rect.y1, plan.height + 0.001))
    for opening in openings:
        # The reveals belong to the room with the higher index, or to the only room.
        if number == max(opening.rooms) or (
            max(opening.rooms) < len(plan.rooms)
            and plan.rooms[max(opening.rooms)].is_outside
            and number == min(opening.rooms)
        ):
            low, high = wall_planes(plan, opening)
            hole = (opening.start, opening.end, opening.bottom, opening.top)
            builder.add(
                finish.trim if opening.bottom == 0.0 else finish.wall,
                reveal(opening.along, low, high, hole, sill=opening.bottom > 0.0),
            )


def wall_planes(plan: FloorPlan, opening: Opening) -> tuple[float, float]:
    """Coordinates of the two faces of the wall around an opening."""
    outside = [k < 0 or plan.rooms[k].is_outside for k in opening.rooms]
    low = opening.at - (OUTER_M if outside[0] else WALL_M / 2)
    high = opening.at + (OUTER_M if outside[1] else WALL_M / 2)
    return low, high


def _threshold(plan: FloorPlan, opening: Opening) -> Mesh:
    low, high = wall_planes(plan, opening)
    if opening.along == "x":
        return floor_quad(opening.start, low, opening.end, high, 0.0)
    return floor_quad(low, opening.start, high, opening.end, 0.0)


def bar(
    along: str,
    start: float,
    end: float,
    across0: float,
    across1: float,
    z0: float,
    z1: float,
    bevel: float = 0.0,
) -> Mesh:
    """Box given by its extent along a wall, across it and in height."""
    a0, a1 = sorted((across0, across1))
    t, a = (start + end) / 2, (a0 + a1) / 2
    if along == "x":
        mesh = box(end - start, a1 - a0, z1 - z0, at=(t, a, z0), bevel=bevel)
    else:
        mesh = box(a1 - a0, end - start, z1 - z0, at=(a, t, z0), bevel=bevel)
    # Grain runs along the bar.
    return mesh.swapped_uv() if z1 - z0 > end - start else mesh


def _skirting(
    builder: ModelBuilder,
    trim: Finish,
    along: str,
    plane: float,
    facing: float,
    start: float,
    end: float,
    holes: Sequence[Hole],
) -> None:
    at = start
    for a, b, bottom, _ in [*sorted(holes), (end, end, 0.0, 0.0)]:
        if bottom > 0.0:
            continue
        stop = a - _CASING_M if a < end else end
        if stop - at > 0.02:
            builder.add(trim, bar(along, at, stop, plane, plane + facing * 0.012, 0.0, _SKIRTING_M))
        at = b + _CASING_M


def _casing(
    builder: ModelBuilder, trim: Finish, along: str, plane: float, facing: float, hole: Hole
) -> None:
    a, b, _, top = hole
    out = plane + facing * 0.014
    for start, end, z0, z1 in (
        (a - _CASING_M, a, 0.0, top + _CASING_M),
        (b, b + _CASING_M, 0.0, top + _CASING_M),
        (a, b, top, top + _CASING_M),
    ):
        builder.add(trim, bar(along, start, end, plane, out, z0, z1, bevel=0.003))


def _outside(builder: ModelBuilder, plan: FloorPlan, number: int) -> None:
    openings = plan.openings_of(number)
    for along, at, start, end, side in outer_walls(plan.rooms, number):
        holes = [h for h in _holes(openings, along, at) if h[0] < end and h[1] > start]
        plane = at + side * OUTER_M
        low = start - _corner(plan, along, at, start, side, -1.0)
        high = end + _corner(plan, along, at, end, side, 1.0)
        if high <= low:
            continue
        tall = plan.height + plan.slab
        builder.add(_FACADE, wall_face(along, plane, side, low, high, tall, holes))
        # Its top fills an inner corner.
        cap = (min(low, start), max(high, end), *sorted((at, plane)))
        rect = (
            Rect(cap[0], cap[2], cap[1], cap[3])
            if along == "x"
            else Rect(cap[2], cap[0], cap[3], cap[1])
        )
        builder.add(_CAP, floor_quad(rect.x0, rect.y0, rect.x1, rect.y1, plan.height + 0.001))


def _corner(
    plan: FloorPlan, along: str, at: float, end: float, side: float, forward: float
) -> float:
    """Extension of an outer wall beyond its end: around an outer corner, not into an inner one.

    Args:
        plan: Floor plan of the house.
        along: Axis that the wall runs along.
        at: Coordinate of its centre line.
        end: Coordinate of the end along the wall.
        side: Direction of outside: 1 to larger, -1 to smaller coordinates.
        forward: Direction of the end along the wall: 1 or -1.
    """
    step = 0.01
    t = end + forward * step
    for across, reach in ((at + side * step, -OUTER_M), (at - side * step, 0.0)):
        x, y = (t, across) if along == "x" else (across, t)
        point = Rect(x, y, x, y)
        if any(not room.is_outside and room.cell.holds(point) for room in plan.rooms):
            return reach
    return OUTER_M
