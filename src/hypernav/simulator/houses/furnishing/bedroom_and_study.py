"""Furnishing of bedrooms and studies, and of a desk with its chair in any room."""

from hypernav.simulator.houses.assembly import PlacedModel
from hypernav.simulator.houses.furnishing.room_layout import SIDES, ModelPose, RoomLayout, beside
from hypernav.simulator.houses.furnishing.set_dressing import (
    place_plants,
    place_rug,
    scatter,
    stand_some,
)
from hypernav.simulator.houses.objects.belongings import (
    decor,
    devices,
    household,
    kitchenware,
    leisure,
    luggage_and_tools,
    plants,
    sports,
)
from hypernav.simulator.houses.objects.furniture import beds, seating, storage, tables


def place_desk(layout: RoomLayout) -> PlacedModel | None:
    """Place a desk at a wall with its chair, a computer and a lamp."""
    rng, palette = layout.rng, layout.palette
    model = tables.desk(rng, palette)
    piece = layout.place_at_wall(model, front=0.75, reserve_front=False)
    if piece is None:
        return None
    seat = seating.office_chair(rng, palette)
    for off in (0.03, 0.15):
        pose = beside(piece, 0.0, (model.depth + seat.depth) / 2 + off, 180.0)
        if layout.place_if_fits(seat, pose) is not None:
            break
    if rng.chance(0.5):
        layout.place_on_top(piece, devices.laptop(rng, palette), facing=0.0, where=(0.5, 0.5))
    else:
        layout.place_on_top(piece, devices.monitor(rng, palette), facing=0.0, where=(0.5, 0.1))
        layout.place_on_top(piece, devices.keyboard(rng, palette), facing=0.0, where=(0.5, 0.85))
    layout.place_on_top(
        piece, devices.desk_lamp(rng, palette), facing=0.0, where=(rng.choice((0.03, 0.97)), 0.2)
    )
    small = (
        decor.books,
        kitchenware.cup,
        decor.pen_cup,
        plants.small_plant,
        decor.photo_frame,
        devices.phone,
    )
    scatter(layout, piece, small, rng.integer(1, 3))
    return piece


def furnish_office(layout: RoomLayout) -> None:
    """Furnish with a desk, shelves, a printer and what fits."""
    rng, palette = layout.rng, layout.palette
    place_desk(layout)
    base = layout.place_at_wall(storage.filing_cabinet(rng, palette), front=0.4, where="corner")
    if base is not None and rng.chance(0.7):
        layout.place_on_top(base, devices.printer(rng, palette), facing=0.0)
    layout.place_at_wall(storage.bookshelf(rng, palette), front=0.4, access=True)
    if rng.chance(0.4):
        layout.place_at_wall(storage.bookshelf(rng, palette), front=0.4, access=True)
    things = (
        (seating.armchair, 0.45),
        (household.trash_can, 0.6),
        (devices.floor_lamp, 0.35),
        (leisure.guitar, 0.2),
        (leisure.piano, 0.12),
        (sports.treadmill, 0.12),
        (sports.exercise_bike, 0.1),
        (seating.bean_bag, 0.12),
        (luggage_and_tools.backpack, 0.3),
        (leisure.easel, 0.12),
        (devices.fan, 0.2),
        (household.sewing_machine, 0.0),
        (sports.dumbbells, 0.15),
    )
    stand_some(layout, rng.shuffled(things), corner_chance=0.5)
    if rng.chance(0.4):
        side = layout.place_at_wall(tables.console_table(rng, palette), front=0.4)
        small = (devices.printer, decor.globe, leisure.chess, devices.radio, plants.small_plant)
        scatter(layout, side, small, 2)
    place_plants(layout, 1)
    if rng.chance(0.4):
        x, y = layout.inner.centre
        place_rug(layout, decor.rug(rng, palette), ModelPose(x, y, 0.0))


def furnish_bedroom(layout: RoomLayout, *, first: bool) -> None:
    """Furnish with a bed, its head to the wall, nightstands, a wardrobe, and what fits.

    Args:
        layout: Layout of the room.
        first: Whether this is the main bedroom; others may be children's or guest rooms.
    """
    rng, palette = layout.rng, layout.palette
    child = not first and rng.chance(0.5)
    bed = _place_bed(layout, double=first or (not child and rng.chance(0.5)), child=child)
    if bed is not None:
        _beside_bed(layout, bed)
    layout.place_at_wall(storage.wardrobe(rng, palette), front=0.55, access=True, where="corner")
    if child:
        for maker in rng.shuffled(
            (
                leisure.toy_box,
                leisure.dollhouse,
                leisure.teddy_bear,
                leisure.toy_blocks,
                leisure.toy_car,
                sports.football,
            )
        )[:3]:
            layout.place_at_wall(maker(rng, palette), where="corner")
    if rng.chance(0.6 if child else 0.35):
        place_desk(layout)
    things = (
        (storage.dresser, 0.55),
        (tables.dressing_table, 0.25),
        (storage.bookshelf, 0.3),
        (storage.tv_stand, 0.3),
    )
    for maker, chance in rng.shuffled(things):
        if not rng.chance(chance):
            continue
        base = layout.place_at_wall(maker(rng, palette), front=0.45, access=True)
        if maker is storage.tv_stand and base is not None:
            layout.place_on_top(base, devices.tv(rng, palette), facing=0.0, where=(0.5, 0.4))
        small = (
            devices.table_lamp,
            decor.photo_frame,
            plants.small_plant,
            decor.clock,
            devices.hair_dryer,
            decor.folded_blanket,
        )
        scatter(layout, base, small, 2)
    things = (
        (seating.armchair, 0.2),
        (seating.bench_seat, 0.1),
        (household.laundry_basket, 0.3),
        (luggage_and_tools.backpack, 0.25),
        (luggage_and_tools.suitcase, 0.25),
        (leisure.guitar, 0.12),
        (devices.floor_lamp, 0.25),
        (luggage_and_tools.handbag, 0.15),
        (seating.bean_bag, 0.15),
        (sports.treadmill, 0.08),
        (sports.exercise_bike, 0.07),
        (sports.dumbbells, 0.12),
        (beds.crib, 0.1),
        (leisure.easel, 0.06),
        (devices.fan, 0.15),
        (devices.air_purifier, 0.15),
        (decor.rolled_mat, 0.1),
        (luggage_and_tools.shoes, 0.2),
        (seating.ottoman, 0.15),
        (sports.exercise_ball, 0.08),
    )
    stand_some(layout, rng.shuffled(things), corner_chance=0.5)
    if rng.chance(0.55):
        place_plants(layout, 1)


def _place_bed(layout: RoomLayout, *, double: bool, child: bool) -> PlacedModel | None:
    rng, palette = layout.rng, layout.palette
    choices = [beds.double_bed, beds.single_bed] if double else [beds.single_bed]
    if child and rng.chance(0.35) and layout.height > 2.4:
        choices = [beds.bunk_bed, beds.single_bed]
    for maker in choices:
        model = maker(rng, palette)
        wide = model.width > 1.3
        walls = sorted(SIDES, key=lambda s: len(layout.wall_openings(s)) + rng.unit())
        for side in walls:
            piece = layout.place_at_wall(
                model, sides=(side,), where="middle" if wide else "corner", access=False
            )
            if piece is not None:
                return piece
    return None


def _beside_bed(layout: RoomLayout, bed: PlacedModel) -> None:
    rng, palette = layout.rng, layout.palette
    model = bed.model
    stand = tables.nightstand(rng, palette)
    lamp = devices.table_lamp(rng, palette)
    for s in rng.shuffled((-1.0, 1.0)):
        x = s * (model.width / 2 + stand.width / 2 + 0.035)
        y = -model.depth / 2 + stand.depth / 2 + 0.01
        pose = beside(bed, x, y)
        if not layout.fits(stand, pose):
            continue
        piece = layout.place(stand, pose)
        layout.place_on_top(piece, lamp, facing=0.0, where=(0.5, 0.3))
        scatter(layout, piece, (decor.books, decor.clock, devices.phone, kitchenware.cup), 1)
    if rng.chance(0.6):
        rug = decor.rug(rng, palette) if rng.chance(0.5) else decor.small_rug(rng, palette)
        place_rug(layout, rug, beside(bed, 0.0, model.depth / 2 - 0.2))
