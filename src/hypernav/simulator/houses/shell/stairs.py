"""Stairs, railings and the sides of the opening in the floor above."""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

from hypernav.simulator.houses.assembly import PlacedModel
from hypernav.simulator.houses.modelling.model import Finish, Mesh, ModelBuilder, unit_vectors
from hypernav.simulator.houses.modelling.solids import box
from hypernav.simulator.houses.plan.floor_plan import FloorPlan, Place, Rail, Rect, Step
from hypernav.simulator.houses.shell.finishes import RoomFinish
from hypernav.simulator.houses.shell.room_surfaces import floor_quad, quad, structural_model

FOUNDATION_M = 0.17
"""Depth of the lowest surface below the lowest floor. The voxels of Habitat's navigation meshes
(0.2 m high) begin there, so the meshes lie 3 cm above the floors and above rugs."""

_FLIGHT_M = 0.25
_RAMP_M = 0.15
_HOLLOW_M = 0.35
_RAIL_M = 0.9
_GAP_M = 0.13
_STEEL = Finish("", (0.3, 0.31, 0.33), 1.0, "", "metal")
_WOOD = Finish("wood", (0.55, 0.4, 0.27), 1.0, "", "wooden")


def build_stairs(plan: FloorPlan, finish: RoomFinish) -> list[PlacedModel]:
    """What the stairs of a storey consist of; of the lowest storey, the foundation as well."""
    stairs = plan.stairwell
    if stairs is None:
        return []
    name, pieces = plan.rooms[stairs.room].name, []
    if stairs.leads_up:
        steps = ModelBuilder()
        for step in stairs.steps:
            for solid in _step(step, stands=not stairs.leads_down and stairs.kind != "ramp"):
                steps.add(_WOOD, solid)
        is_ramp = stairs.kind == "ramp"
        model = structural_model(steps, "ramp" if is_ramp else "stairs", name)
        synonyms = () if is_ramp else ("staircase", "stairway", "steps")
        model = replace(model, model=replace(model.model, synonyms=synonyms), structural=False)
        pieces.append(model)
        sides = ModelBuilder()
        atrium = () if plan.atrium is None else (plan.atrium,)
        for low, high, facing in [*_sides(stairs.well), *_sides(atrium)]:
            top = plan.height + plan.slab
            sides.add(finish.ceiling, _side(low, high, plan.height, top, facing))
        pieces.append(structural_model(sides, "stairwell", name))
    rails = [*stairs.rails] if stairs.leads_up else []
    if stairs.leads_down:
        rails += [*stairs.guards, *([] if stairs.leads_up else [stairs.foot])]
        if plan.atrium is not None:
            rails += _around(plan.atrium.grown(0.03))
    railing = ModelBuilder()
    for rail in rails:
        _railing(railing, rail)
    pieces.append(structural_model(railing, "railing", name))
    if not stairs.leads_down:
        base = ModelBuilder()
        for room in plan.rooms:
            c = room.cell
            base.add(finish.ceiling, floor_quad(c.x0, c.y0, c.x1, c.y1, -FOUNDATION_M, up=False))
        pieces.append(structural_model(base, "foundation", ""))
    return pieces


def _step(step: Step, *, stands: bool) -> list[Mesh]:
    """Solids of a tread, a landing or a ramp.

    Args:
        step: The step.
        stands: Whether it is solid down to the floor, as in the lowest flight; the other flights
            span the opening.
    """
    r = step.rect
    if step.rise:
        ramp = box(r.width, r.depth, _RAMP_M, at=(*r.centre, -_RAMP_M))
        return [_sheared(ramp, 0, r.x0, step.z, step.rise / r.width)]
    low = 0.0 if stands else step.z - _FLIGHT_M
    # Boxes are hollow: a wide one that is higher than a robot would have room for it inside.
    count = math.ceil(r.depth / _HOLLOW_M) if stands else 1
    deep = r.depth / count
    return [
        box(r.width, deep, step.z - low, at=(r.centre[0], r.y0 + (k + 0.5) * deep, low))
        for k in range(count)
    ]


def _around(rect: Rect) -> list[Rail]:
    """Railings on all sides of an opening."""
    corners = [(rect.x0, rect.y0), (rect.x1, rect.y0), (rect.x1, rect.y1), (rect.x0, rect.y1)]
    return [Rail(*ends) for ends in pairwise([*corners, corners[0]])]


def _railing(builder: ModelBuilder, rail: Rail) -> None:
    (x0, y0), (x1, y1) = rail.start, rail.end
    along_x = abs(x1 - x0) > abs(y1 - y0)
    length = math.dist(rail.start, rail.end)
    count = max(2, math.ceil(length / _GAP_M) + 1)
    for k in range(count):
        t = k / (count - 1)
        at = (x0 + t * (x1 - x0), y0 + t * (y1 - y0), rail.z[0] + t * (rail.z[1] - rail.z[0]))
        thick = 0.04 if k in (0, count - 1) else 0.02
        builder.add(_STEEL, box(thick, thick, _RAIL_M, at=at))
    middle = ((x0 + x1) / 2.0, (y0 + y1) / 2.0, _RAIL_M - 0.04)
    size = (length + 0.05, 0.05) if along_x else (0.05, length + 0.05)
    start, axis = ((x0, y0)[not along_x], int(not along_x))
    run = (x1 - x0) if along_x else (y1 - y0)
    slope = (rail.z[1] - rail.z[0]) / run
    handrail = box(*size, 0.05, at=middle)
    builder.add(_WOOD, _sheared(handrail, axis, start, rail.z[0], slope))


def _sheared(mesh: Mesh, axis: int, start: float, z: float, slope: float) -> Mesh:
    """A level bar laid on a slope that passes a height at its start."""
    positions, normals = mesh.positions.copy(), mesh.normals.copy()
    positions[:, 2] += z + slope * (positions[:, axis] - start)
    normals[:, axis] -= slope * normals[:, 2]
    return replace(mesh, positions=positions, normals=unit_vectors(normals))


def _sides(well: Sequence[Rect]) -> list[tuple[Place, Place, Place]]:
    """Outer edges of an opening: both ends of each, and the direction into the opening."""
    found: list[tuple[Place, Place, Place]] = []
    for k, r in enumerate(well):
        others = [*well[:k], *well[k + 1 :]]
        for low, high, facing in (
            ((r.x0, r.y0), (r.x1, r.y0), (0.0, 1.0)),
            ((r.x0, r.y1), (r.x1, r.y1), (0.0, -1.0)),
            ((r.x0, r.y0), (r.x0, r.y1), (1.0, 0.0)),
            ((r.x1, r.y0), (r.x1, r.y1), (-1.0, 0.0)),
        ):
            found += [(a, b, facing) for a, b in _outside(low, high, facing, others)]
    return found


def _outside(
    low: Place, high: Place, facing: Place, others: Sequence[Rect]
) -> list[tuple[Place, Place]]:
    """The parts of an edge behind which no other rectangle of the opening lies."""
    along = 0 if low[1] == high[1] else 1
    cuts = {low[along], high[along]}
    for r in others:
        cuts |= {c for c in ((r.x0, r.x1), (r.y0, r.y1))[along] if low[along] < c < high[along]}
    edges = sorted(cuts)
    parts = []
    for a, b in pairwise(edges):
        middle = (a + b) / 2.0
        x, y = (middle, low[1]) if along == 0 else (low[0], middle)
        behind = Rect(*(2 * (x - 0.01 * facing[0], y - 0.01 * facing[1])))
        if not any(r.holds(behind) for r in others):
            ends = ((a, low[1]), (b, low[1])) if along == 0 else ((low[0], a), (low[0], b))
            parts.append(ends)
    return parts


def _side(low: Place, high: Place, bottom: float, top: float, facing: Place) -> Mesh:
    corners = [(*low, bottom), (*high, bottom), (*high, top), (*low, top)]
    return quad(corners, (*facing, 0.0))
