"""Joinery that many models share: legs, fronts with handles, open cases."""

import numpy as np

from hypernav.simulator.houses.modelling.curves import cylinder, rod
from hypernav.simulator.houses.modelling.model import Finish, Mesh, ModelBuilder, Vector, join
from hypernav.simulator.houses.modelling.solids import box


def four_legs(
    x: float,
    y: float,
    height: float,
    *,
    thick: float = 0.045,
    taper: float = 0.7,
    round_: bool = False,
) -> list[Mesh]:
    """Legs under the corners of a rectangle, their outer sides flush with it.

    Args:
        x: Width of the rectangle, metres.
        y: Depth of the rectangle, metres.
        height: Height of the legs, metres.
        thick: Side or diameter at the upper end, metres.
        taper: Thickness at the floor as a share of the thickness at the upper end.
        round_: Whether the legs are round instead of square.
    """
    hx, hy = x / 2.0 - thick / 2.0, y / 2.0 - thick / 2.0
    legs = []
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            top = (sx * hx, sy * hy, height)
            foot = (sx * hx, sy * hy, 0.0)
            legs.append(
                rod(foot, top, thick * taper / 2.0, end_radius=thick / 2.0, sides=10)
                if round_
                else square_bar(foot, top, thick * taper, thick)
            )
    return legs


def square_bar(start: Vector, end: Vector, side: float, end_side: float | None = None) -> Mesh:
    """A bar of square section that rises from ``start`` to ``end``, with horizontal ends."""
    bar = box(1.0, 1.0, 1.0)
    upper = bar.positions[:, 2:3]
    low, high = np.array(start), np.array(end)
    top = side if end_side is None else end_side
    scale = side + (top - side) * upper
    positions = low + (high - low) * upper
    positions[:, :2] += (bar.positions * scale)[:, :2]
    return Mesh(positions, bar.normals, bar.uv[:, ::-1] * (high[2] - low[2], side), bar.faces)


def handle(kind: str, length: float) -> Mesh:
    """Handle on the plane y = 0 that sticks out to +y, centred, along x.

    Args:
        kind: "bar", "knob" or "cup".
        length: Length in metres; a knob ignores it.
    """
    if kind == "knob":
        return cylinder(0.014, 0.022, sides=10, top_radius=0.017, bevel=0.004).turned(-90, "x")
    if kind == "cup":
        return box(length * 0.6, 0.02, 0.03, bevel=0.006).moved(0, 0.01, -0.015)
    bar = rod((-length / 2, 0.028, 0.0), (length / 2, 0.028, 0.0), 0.006)
    posts = [
        rod((s * length * 0.42, 0.0, 0.0), (s * length * 0.42, 0.028, 0.0), 0.005, sides=6)
        for s in (-1.0, 1.0)
    ]
    return join([bar, *posts])


def front(
    builder: ModelBuilder,
    finish: Finish,
    metal: Finish,
    x: float,
    z: float,
    *,
    at: Vector,
    grip: str = "bar",
    upright: bool = False,
    side: float = 0.0,
    framed: bool = False,
) -> None:
    """Add a door or drawer front on the plane y = at[1], facing +y.

    Args:
        builder: Builder that the parts are added to.
        finish: Finish of the front.
        metal: Finish of the handle.
        x: Width, metres.
        z: Height, metres.
        at: Centre of its lower edge, on the plane of the case.
        grip: Kind of handle; empty for none.
        upright: Whether the handle is vertical.
        side: Position of the handle: -1 left edge, 0 middle, 1 right edge.
        framed: Whether it has a raised border, as in country kitchens.
    """
    thick = 0.018
    mesh = box(
        x - 0.004, thick, z - 0.004, at=(at[0], at[1] + thick / 2, at[2] + 0.002), bevel=0.003
    )
    builder.add(finish, mesh.swapped_uv() if z > x * 1.4 else mesh)
    if framed and x > 0.2 and z > 0.2:
        rail = 0.055
        y = at[1] + thick + 0.004
        for dx in (-1.0, 1.0):
            part = box(
                rail,
                0.01,
                z - 0.004,
                bevel=0.003,
                at=(at[0] + dx * (x / 2 - rail / 2 - 0.002), y, at[2] + 0.002),
            )
            builder.add(finish, part)
        for dz in (0.002, z - rail - 0.002):
            builder.add(
                finish, box(x - 2 * rail, 0.01, rail, at=(at[0], y, at[2] + dz), bevel=0.003)
            )
    if grip:
        piece = handle(grip, min(0.16, 0.6 * (z if upright else x)))
        if upright:
            piece = piece.turned(90, "y")
        dx = side * (x / 2 - 0.035)
        dz = z / 2 if side or not upright else z - 0.1
        builder.add(
            metal, piece.moved(at[0] + dx, at[1] + thick + (0.004 if framed else 0.0), at[2] + dz)
        )


def case(
    builder: ModelBuilder,
    finish: Finish,
    x: float,
    y: float,
    z: float,
    *,
    at: Vector,
    board: float = 0.018,
    back: Finish | None = None,
) -> None:
    """Add an open case: two sides, bottom, top and back; its opening faces +y.

    Args:
        builder: Builder that the parts are added to.
        finish: Finish of the boards.
        x: Outer width, metres.
        y: Depth, metres.
        z: Height, metres.
        at: Centre of its lower side.
        board: Thickness of the boards, metres.
        back: Finish of the back; the same as the boards if None.
    """
    for s in (-1.0, 1.0):
        part = box(board, y, z, at=(at[0] + s * (x - board) / 2, at[1], at[2]), bevel=0.002)
        builder.add(finish, part.swapped_uv())
    for level in (0.0, z - board):
        builder.add(
            finish, box(x - 2 * board, y, board, at=(at[0], at[1], at[2] + level), bevel=0.002)
        )
    builder.add(
        back or finish.tinted(0.85),
        box(x - 2 * board, 0.006, z - 2 * board, at=(at[0], at[1] - y / 2 + 0.006, at[2] + board)),
    )
