"""Set dressing of any room: curtains, lamps, pictures, rugs, plants, small things."""

from collections.abc import Callable, Sequence

from hypernav.simulator.houses.assembly import PlacedModel
from hypernav.simulator.houses.furnishing.room_layout import (
    SIDES,
    SKIRTING_M,
    ModelPose,
    RoomLayout,
    footprint,
)
from hypernav.simulator.houses.modelling.materials import Palette
from hypernav.simulator.houses.modelling.model import Model
from hypernav.simulator.houses.objects.belongings import decor, plants
from hypernav.simulator.houses.objects.furniture import office_equipment
from hypernav.simulator.houses.random_stream import RandomStream

Maker = Callable[[RandomStream, Palette], Model]

_LAMP_EVERY_M = 3.6


def hang_curtains(layout: RoomLayout) -> None:
    """Hang curtains at the windows, where furniture leaves space for them."""
    for side in SIDES:
        for opening in layout.wall_openings(side):
            if opening.kind != "window" or opening.width < 0.9:
                continue
            high = min(opening.top + 0.14, layout.height - 0.05)
            model = decor.curtain(layout.rng, layout.palette, opening.width, high - 0.03)
            pose = layout.pose_at_wall(model, side, (opening.start + opening.end) / 2, 0.03, 0.02)
            start, end, _ = layout.wall_line(side)
            along = pose.x if side in ("south", "north") else pose.y
            if along - model.width / 2 < start + 0.01 or along + model.width / 2 > end - 0.01:
                continue
            if not layout.is_taken(model, pose) and layout.keeps_floor_connected(model, pose):
                layout.place(model, pose)


def place_radiators(layout: RoomLayout) -> None:
    """Place radiators under some windows."""
    for side in SIDES:
        for opening in layout.wall_openings(side):
            if opening.kind == "window" and opening.bottom > 0.85 and layout.rng.chance(0.35):
                model = decor.radiator(layout.rng, layout.palette)
                pose = layout.pose_at_wall(model, side, (opening.start + opening.end) / 2, 0.03)
                if model.width < opening.width + 0.3 and layout.fits(model, pose):
                    layout.place(model, pose)


def hang_lamp(layout: RoomLayout, maker: Maker, xy: tuple[float, float] | None = None) -> None:
    """Hang a lamp from the ceiling, at the room's centre if no position is given."""
    model = maker(layout.rng, layout.palette)
    x, y = xy or layout.inner.centre
    pose = ModelPose(x, y, 0.0, layout.height - 0.001)
    if not layout.is_taken(model, pose):
        layout.place(model, pose)


def hang_pictures(layout: RoomLayout, count: int) -> None:
    """Hang pictures, clocks or mirrors on free wall."""
    for _ in range(count):
        maker = layout.rng.weighted(
            ((decor.framed_picture, 6.0), (decor.wall_clock, 1.0), (decor.mirror, 1.0))
        )
        model = maker(layout.rng, layout.palette)
        layout.hang_on_wall(model, z=round(1.62 - model.height / 2, 3))


def stand_some(
    layout: RoomLayout,
    choices: Sequence[tuple[Maker, float]],
    *,
    corner_chance: float | None = None,
    where: str = "any",
    access: bool = False,
    gap: float = SKIRTING_M,
) -> None:
    """Stand things at walls, each with a chance of its own.

    Args:
        layout: Layout of the room.
        choices: What makes the things, and their chances.
        corner_chance: Chance of each to stand in a corner; None if ``where`` says it for all.
        where: Order of positions, see `RoomLayout.place_at_wall`.
        access: Whether their fronts must be reached with full walking width.
        gap: Distance to the wall, metres.
    """
    rng = layout.rng
    for maker, chance in choices:
        if rng.chance(chance):
            model = maker(rng, layout.palette)
            if corner_chance is not None:
                where = "corner" if rng.chance(corner_chance) else "any"
            layout.place_at_wall(model, where=where, access=access, gap=gap)


def stand_each(layout: RoomLayout, choices: Sequence[tuple[Maker, int]], *, least: int = 0) -> None:
    """Stand between ``least`` and so many of each thing at walls."""
    for maker, most in choices:
        for _ in range(layout.rng.integer(least, most)):
            layout.place_at_wall(maker(layout.rng, layout.palette))


def scatter(
    layout: RoomLayout, base: PlacedModel | None, makers: Sequence[Maker], count: int
) -> list[PlacedModel]:
    """Place up to ``count`` small objects on a placed model; every maker is used at most once."""
    if base is None:
        return []
    result = []
    for maker in layout.rng.shuffled(makers)[:count]:
        piece = layout.place_on_top(base, maker(layout.rng, layout.palette))
        if piece is not None:
            result.append(piece)
    return result


def place_rug(layout: RoomLayout, rug: Model, pose: ModelPose) -> PlacedModel | None:
    """Place a rug, also under furniture, if it lies within the room and on no other rug."""
    rect = footprint(rug, pose)
    if not layout.inner.grown(-0.02).holds(rect):
        return None
    if any(
        rect.overlaps(footprint(p.model, ModelPose(p.x, p.y, p.yaw_deg)))
        for p in layout.placed
        if p.model.category == "rug"
    ):
        return None
    return layout.place(rug, pose, flat=True)


def place_plants(layout: RoomLayout, count: int) -> None:
    """Place large plants in corners and along walls."""
    for _ in range(count):
        maker = layout.rng.choice(
            (
                plants.snake_plant,
                plants.monstera,
                plants.indoor_tree,
                plants.leafy_plant,
                plants.leafy_plant,
            )
        )
        layout.place_at_wall(
            maker(layout.rng, layout.palette), where="corner" if layout.rng.chance(0.7) else "any"
        )


def hang_lamps_in_rows(layout: RoomLayout) -> None:
    """Hang equal lamps at even distances."""
    i = layout.inner
    model = office_equipment.light_panel(layout.rng, layout.palette)
    yaw = 0.0 if i.width >= i.depth else 90.0
    columns, rows = (max(round(side / _LAMP_EVERY_M), 1) for side in (i.width, i.depth))
    for row in range(rows):
        for column in range(columns):
            x = round(i.x0 + i.width * (column + 0.5) / columns, 3)
            y = round(i.y0 + i.depth * (row + 0.5) / rows, 3)
            pose = ModelPose(x, y, yaw, layout.height - 0.001)
            if not layout.is_taken(model, pose):
                layout.place(model, pose)


def dress_public_room(layout: RoomLayout, pictures: int) -> None:
    """Hang lamps and pictures."""
    hang_lamps_in_rows(layout)
    hang_pictures(layout, pictures)
