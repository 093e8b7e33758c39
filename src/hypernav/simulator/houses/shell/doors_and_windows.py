"""Models of door leaves, the front door, windows and the balcony's railing."""

from hypernav.simulator.houses.assembly import PlacedModel
from hypernav.simulator.houses.modelling.curves import rod
from hypernav.simulator.houses.modelling.materials import (
    BLACK_METAL,
    GLASS,
    STEEL,
    image_finish,
    lacquer,
    wood,
)
from hypernav.simulator.houses.modelling.model import Finish, Mesh, Model, ModelBuilder
from hypernav.simulator.houses.modelling.solids import box, panel
from hypernav.simulator.houses.plan.floor_plan import WALL_M, FloorPlan, Opening, Room
from hypernav.simulator.houses.plan.openings import LEAF_M, leaf_rect
from hypernav.simulator.houses.random_stream import RandomStream
from hypernav.simulator.houses.shell.room_surfaces import bar, structural_model, wall_planes

_FRAME = Finish("", (0.95, 0.95, 0.94), 1.0, "white", "plastic")


def door_leaf(finish: Finish, wide: float, high: float) -> Model:
    """Door leaf along x, with two sunken panels and handles."""
    builder = ModelBuilder()
    builder.add(finish, box(wide, LEAF_M - 0.012, high, at=(0, 0, 0.008)).swapped_uv())
    rail = 0.11
    for side in (-1.0, 1.0):
        y = side * (LEAF_M / 2 - 0.004)
        for x in (-1.0, 1.0):
            part = box(rail, 0.008, high, at=(x * (wide - rail) / 2, y, 0.008), bevel=0.002)
            builder.add(finish, part.swapped_uv())
        for z in (0.008, high * 0.42, high - rail):
            builder.add(finish, box(wide - 2 * rail, 0.008, rail, at=(0, y, z), bevel=0.002))
        x = wide / 2 - 0.06
        builder.add(
            STEEL,
            rod(
                (x, side * LEAF_M / 2, 1.02), (x, side * (LEAF_M / 2 + 0.04), 1.02), 0.008, sides=6
            ),
            rod(
                (x, side * (LEAF_M / 2 + 0.04), 1.02),
                (x - 0.11, side * (LEAF_M / 2 + 0.04), 1.02),
                0.008,
                sides=8,
            ),
        )
    return builder.model("door", "room door", main=finish)


def build_openings(plan: FloorPlan, rng: RandomStream) -> list[PlacedModel]:
    """Door leaves, front door, windows and railing of a house."""
    leaf_finish = rng.choice(
        (lacquer("white"), lacquer("white"), wood("oak"), wood("walnut"), wood("beech"))
    )
    pieces: list[PlacedModel] = []
    for number, opening in enumerate(plan.openings):
        own = rng.fork("opening", number)
        if opening.kind == "door":
            pieces.append(_open_leaf(plan, opening, leaf_finish))
        elif opening.kind == "entrance":
            pieces.append(_front_door(plan, opening, own))
        elif opening.kind == "window":
            pieces.append(_window(plan, opening, own))
        elif opening.kind == "glass door":
            pieces.append(_glass_door_frame(plan, opening))
    for room in plan.rooms:
        if room.is_outside:
            host = next(o for o in plan.openings if o.kind == "glass door")
            pieces.append(_railing(room, host, rng.fork("railing")))
    return pieces


def _open_leaf(plan: FloorPlan, opening: Opening, finish: Finish) -> PlacedModel:
    rect = leaf_rect(opening)
    assert rect is not None
    model = door_leaf(finish, max(rect.width, rect.depth), opening.top - 0.02)
    x, y = rect.centre
    upper = opening.leaf_room == opening.rooms[1]
    # The handle is at the leaf's +x end, which must point away from the wall.
    yaw = (90.0 if upper else -90.0) if opening.along == "x" else (0.0 if upper else 180.0)
    return PlacedModel(model, x, y, 0.0, yaw, plan.rooms[opening.leaf_room].name)


def _front_door(plan: FloorPlan, opening: Opening, rng: RandomStream) -> PlacedModel:
    finish = rng.choice(
        (
            wood("walnut"),
            wood("oak"),
            lacquer("dark gray"),
            lacquer("navy"),
            lacquer("green"),
            lacquer("red"),
        )
    )
    model = door_leaf(finish, opening.width - 0.01, opening.top - 0.015)
    model = model.named("front door", "entrance door")
    x, y = opening.middle
    host = max(opening.rooms)
    inward = 1.0 if opening.rooms[1] == host else -1.0
    shift = inward * (WALL_M / 2 - 0.03)
    if opening.along == "x":
        return PlacedModel(
            model, x, y + shift, 0.0, 0.0 if inward > 0 else 180.0, plan.rooms[host].name
        )
    return PlacedModel(
        model, x + shift, y, 0.0, -90.0 if inward > 0 else 90.0, plan.rooms[host].name
    )


def _window(plan: FloorPlan, opening: Opening, rng: RandomStream) -> PlacedModel:
    low, high = wall_planes(plan, opening)
    host = max(opening.rooms)
    inward = 1.0 if opening.rooms[1] == host else -1.0
    outer, inner = (low, high) if inward > 0 else (high, low)
    at = outer + inward * 0.08
    builder = ModelBuilder()
    a, b, z0, z1 = opening.start, opening.end, opening.bottom, opening.top
    rim = 0.055
    strips = [
        (a, a + rim, z0, z1),
        (b - rim, b, z0, z1),
        (a + rim, b - rim, z0, z0 + rim),
        (a + rim, b - rim, z1 - rim, z1),
    ]
    panes = 2 if opening.width > 0.8 else 1
    for k in range(1, panes):
        middle = a + (b - a) * k / panes
        strips.append((middle - rim * 0.6, middle + rim * 0.6, z0 + rim, z1 - rim))
    for s, e, low_z, high_z in strips:
        builder.add(
            _FRAME, bar(opening.along, s, e, at - 0.03, at + 0.03, low_z, high_z, bevel=0.004)
        )
    part = _facing(
        panel(opening.width, z1 - z0), opening.along, (a + b) / 2, at - inward * 0.005, z0, inward
    )
    builder.add(_pane(rng), part)
    part = bar(
        opening.along,
        a - 0.04,
        b + 0.04,
        at + inward * 0.03,
        inner + inward * 0.035,
        z0 - 0.025,
        z0 + 0.004,
        bevel=0.005,
    )
    builder.add(_FRAME, part)
    if panes == 2:
        part = bar(
            opening.along,
            (a + b) / 2 - 0.008,
            (a + b) / 2 + 0.008,
            at + inward * 0.03,
            at + inward * 0.06,
            (z0 + z1) / 2 - 0.05,
            (z0 + z1) / 2 + 0.05,
        )
        builder.add(STEEL, part)
    piece = structural_model(builder, "window", plan.rooms[host].name)
    return PlacedModel(piece.model, piece.x, piece.y, 0.0, 0.0, piece.room)


def _pane(rng: RandomStream) -> Finish:
    return image_finish(f"outdoors {rng.integer(0, 5)}", unlit=True)


def _facing(mesh: Mesh, along: str, t: float, across: float, z: float, inward: float) -> Mesh:
    """Panel rotated so that it faces the room."""
    if along == "x":
        return mesh.turned(0.0 if inward > 0 else 180.0).moved(t, across, z)
    return mesh.turned(-90.0 if inward > 0 else 90.0).moved(across, t, z)


def _glass_door_frame(plan: FloorPlan, opening: Opening) -> PlacedModel:
    builder = ModelBuilder()
    a, b, top = opening.start, opening.end, opening.top
    at = opening.at + (0.12 if max(opening.rooms) == opening.rooms[1] else -0.12)
    for s, e, z0, z1 in (
        (a, a + 0.035, 0.0, top),
        (b - 0.035, b, 0.0, top),
        (a, b, top - 0.05, top),
    ):
        builder.add(_FRAME, bar(opening.along, s, e, at - 0.03, at + 0.03, z0, z1, bevel=0.004))
    return structural_model(builder, "balcony door frame", plan.rooms[min(opening.rooms)].name)


def _railing(room: Room, door: Opening, rng: RandomStream) -> PlacedModel:
    c = room.inner
    builder = ModelBuilder()
    x, y = c.centre
    glass = rng.chance(0.4)
    sides = [
        ("x", c.y0, c.x0, c.x1, door.along == "x" and door.at < y),
        ("x", c.y1, c.x0, c.x1, door.along == "x" and door.at > y),
        ("y", c.x0, c.y0, c.y1, door.along == "y" and door.at < x),
        ("y", c.x1, c.y0, c.y1, door.along == "y" and door.at > x),
    ]
    metal = rng.choice((BLACK_METAL, STEEL))
    for along, at, start, end, is_wall in sides:
        if is_wall:
            continue
        builder.add(
            metal,
            bar(along, start - 0.02, end + 0.02, at - 0.025, at + 0.025, 1.02, 1.06, bevel=0.005),
        )
        builder.add(metal, bar(along, start, end, at - 0.015, at + 0.015, 0.08, 0.11))
        count = max(round((end - start) / (0.9 if glass else 0.11)), 1)
        for k in range(count + 1):
            t = start + (end - start) * k / count
            half = 0.018 if glass or k in (0, count) else 0.007
            builder.add(metal, bar(along, t - half, t + half, at - half, at + half, 0.0, 1.03))
        if glass:
            builder.add(
                GLASS, bar(along, start + 0.03, end - 0.03, at - 0.005, at + 0.005, 0.12, 0.98)
            )
    return structural_model(builder, "railing", room.name)
