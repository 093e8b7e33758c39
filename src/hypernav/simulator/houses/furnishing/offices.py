"""Furnishing of offices."""

from collections.abc import Callable

from hypernav.simulator.houses.assembly import PlacedModel
from hypernav.simulator.houses.furnishing.kitchen_and_dining import place_dining, place_units
from hypernav.simulator.houses.furnishing.living_room import place_seating_group
from hypernav.simulator.houses.furnishing.room_layout import ModelPose, RoomLayout, beside
from hypernav.simulator.houses.furnishing.rooms import Furnishing, RequiredGroups
from hypernav.simulator.houses.furnishing.set_dressing import (
    Maker,
    dress_public_room,
    place_plants,
    scatter,
    stand_some,
)
from hypernav.simulator.houses.modelling.model import Model
from hypernav.simulator.houses.objects.belongings import (
    decor,
    devices,
    household,
    kitchenware,
    leisure,
    luggage_and_tools,
    plants,
)
from hypernav.simulator.houses.objects.furniture import (
    office_equipment,
    sanitary,
    seating,
    storage,
    tables,
)
from hypernav.simulator.houses.plan.floor_plan import FloorPlan, Rect

_TUCK_M = 0.14
"""How far a chair is pushed under its desk, metres."""

_BACK_TO_BACK_M = 0.815
"""Distance between the middles of two desks that face each other, metres."""

_ISLAND_DEPTH_M = 2.9
_WALKWAY_M = 0.95
_ON_DESK: tuple[Maker, ...] = (
    decor.books,
    kitchenware.cup,
    decor.pen_cup,
    plants.small_plant,
    devices.phone,
    decor.photo_frame,
)

REQUIRED: dict[str, RequiredGroups] = {
    "office": (("desk",), ("chair",)),
    "open office": (("desk",), ("chair",)),
    "meeting room": (("meeting table",), ("chair",)),
    "conference room": (("meeting table",), ("chair",)),
    "lounge": (("sofa", "armchair"),),
    "reception": (("reception desk",),),
    "pantry": (("refrigerator",), ("sink",)),
    "restroom": (("toilet",), ("sink",)),
    "copy room": (("copier",),),
    "storage": (("storage rack",),),
    "server room": (("server rack",),),
}
"""Categories that each kind of room must hold: at least one of each group."""

_PICTURES = {"office": 1, "meeting room": 1, "reception": 1, "lounge": 2, "corridor": 2}


def furnish_cell_office(layout: RoomLayout) -> None:
    """Furnish with one or two desks at the walls, cabinets, a visitor's chair, a board."""
    rng, palette = layout.rng, layout.palette
    desk = office_equipment.work_desk(rng, palette, rng.choice((1.4, 1.6)))
    seat = seating.office_chair(rng, palette)
    for _ in range(2 if layout.inner.area > 13.0 and rng.chance(0.6) else 1):
        for _ in range(3):
            piece = layout.place_at_wall(desk, front=0.8, reserve_front=False)
            if piece is not None:
                _equip(layout, piece, seat)
                break
    things = (
        (storage.bookshelf, 0.6),
        (storage.filing_cabinet, 0.7),
        (storage.cabinet, 0.3),
        (office_equipment.drawer_unit, 0.4),
    )
    for maker, chance in rng.shuffled(things):
        if rng.chance(chance):
            piece = layout.place_at_wall(maker(rng, palette), front=0.45, access=True)
            scatter(layout, piece, (plants.small_plant, devices.printer), 1)
    things = (
        (seating.armchair, 0.25),
        (seating.dining_chair, 0.4),
        (household.trash_can, 0.6),
        (storage.coat_rack, 0.35),
        (office_equipment.desk_computer, 0.3),
        (office_equipment.paper_shredder, 0.15),
        (luggage_and_tools.backpack, 0.25),
        (devices.floor_lamp, 0.2),
        (devices.fan, 0.1),
    )
    stand_some(layout, rng.shuffled(things), corner_chance=0.5)
    if rng.chance(0.5):
        layout.hang_on_wall(office_equipment.whiteboard(rng, palette), z=0.95)
    if rng.chance(0.6):
        place_plants(layout, 1)


def furnish_open_office(layout: RoomLayout) -> None:
    """Furnish with islands of desks in rows, with cabinets, boards and plants at the walls."""
    rng, palette = layout.rng, layout.palette
    desk = office_equipment.work_desk(rng, palette, rng.choice((1.4, 1.6)))
    seat = seating.office_chair(rng, palette)
    screen = office_equipment.desk_screen(rng, palette, desk.width) if rng.chance(0.6) else None
    for pose, count in _islands(layout, desk.width):
        kind = rng.weighted((("desks", 9.0), ("table", 0.6), ("lounge", 0.5)))
        if kind == "desks":
            _place_island(layout, pose, count, desk, seat, screen)
        elif kind == "table":
            place_table(layout, office_equipment.meeting_table(rng, palette, 6), seat, pose)
        else:
            _place_lounge(layout, pose)
    things = (
        (storage.filing_cabinet, 2),
        (office_equipment.locker, 1),
        (storage.bookshelf, 2),
        (storage.cabinet, 1),
        (office_equipment.copier, 1 if rng.chance(0.3) else 0),
        (storage.coat_rack, 1),
        (household.trash_can, 2),
        (office_equipment.paper_shredder, 1 if rng.chance(0.4) else 0),
        (devices.fan, 1 if rng.chance(0.3) else 0),
    )
    for maker, count in rng.shuffled(things):
        model = maker(rng, palette)
        for _ in range(rng.integer(0, count)):
            piece = layout.place_at_wall(model, front=0.3, access=True)
            scatter(layout, piece, (plants.small_plant, devices.printer, decor.books), 1)
    for maker, chance in ((office_equipment.whiteboard, 0.8), (office_equipment.notice_board, 0.5)):
        if rng.chance(chance):
            layout.hang_on_wall(maker(rng, palette), z=0.95)
    place_plants(layout, rng.integer(1, 3))


def _islands(layout: RoomLayout, wide: float) -> list[tuple[ModelPose, int]]:
    """Middles of the islands of desks that a room has space for, and desks on each side.

    The islands lie along the room or across it, whichever holds more desks.
    """
    i = layout.inner
    choices = [_grid(i, yaw, count, wide) for yaw in (0.0, 90.0) for count in (1, 2, 3, 4)]
    most = max(sum(count for _, count in islands) for islands in choices)
    good = [found for found in choices if sum(count for _, count in found) >= 0.85 * most]
    return layout.rng.choice(good)


def _grid(inner: Rect, yaw: float, count: int, wide: float) -> list[tuple[ModelPose, int]]:
    """Islands of ``count`` desks on each side, evenly spread over a room."""
    long, short = (inner.width, inner.depth) if yaw == 0.0 else (inner.depth, inner.width)
    length = count * (wide + 0.004)
    rows = int((short - 0.5 * _WALKWAY_M) / (_ISLAND_DEPTH_M + 0.5 * _WALKWAY_M))
    columns = int((long - _WALKWAY_M) / (length + _WALKWAY_M))
    one_ended = columns == 0 and length + _WALKWAY_M + 0.12 <= long
    found = []
    for row in range(rows):
        for column in range(max(columns, int(one_ended))):
            u = 0.1 + length / 2 if one_ended else long * (column + 0.5) / columns
            v = short * (row + 0.5) / rows
            x, y = (inner.x0 + u, inner.y0 + v) if yaw == 0.0 else (inner.x0 + v, inner.y0 + u)
            found.append((ModelPose(round(x, 3), round(y, 3), yaw), count))
    return found


def _place_island(
    layout: RoomLayout,
    middle: ModelPose,
    count: int,
    desk: Model,
    seat: Model,
    screen: Model | None,
) -> None:
    """Place two rows of desks that face each other, each with its chair and its computer."""
    for k in range(count):
        x = (k - (count - 1) / 2) * (desk.width + 0.004)
        pair = []
        for side, turn in ((1.0, 0.0), (-1.0, 180.0)):
            pose = beside(middle, x, side * _BACK_TO_BACK_M / 2, turn)
            if layout.fits(desk, pose, tight=True):
                pair.append(layout.place(desk, pose))
        if screen is not None and len(pair) == 2:
            pose = beside(middle, x, 0.0, z=office_equipment.TABLE_M + 0.001)
            layout.place(screen, pose, on_top=True)
        for piece in pair:
            _equip(layout, piece, seat)


def _equip(layout: RoomLayout, desk: PlacedModel, seat: Model) -> None:
    """Place a chair before a desk, and a computer and small things on it."""
    rng, palette = layout.rng, layout.palette
    y = (desk.model.depth + seat.depth) / 2 - _TUCK_M
    pose = beside(desk, 0.0, y, 180.0)
    layout.place_if_fits(seat, pose, over=[layout.obstacle_of(desk)])
    if rng.chance(0.25):
        layout.place_on_top(desk, devices.laptop(rng, palette), facing=0.0, where=(0.5, 0.6))
    else:
        layout.place_on_top(desk, devices.monitor(rng, palette), facing=0.0, where=(0.5, 0.15))
        layout.place_on_top(desk, devices.keyboard(rng, palette), facing=0.0, where=(0.5, 0.6))
    scatter(layout, desk, _ON_DESK, rng.integer(0, 2))


def place_table(layout: RoomLayout, table: Model, seat: Model, pose: ModelPose) -> bool:
    """Place a table with chairs along its long sides; False if it doesn't fit."""
    if not layout.fits(table, pose):
        return False
    placed = layout.place(table, pose)
    per_side = max(int((table.width - 0.1) / (seat.width + 0.08)), 1)
    for k in range(per_side):
        x = (k + 0.5 - per_side / 2) * (table.width - 0.2) / per_side
        for side, turn in ((1.0, 180.0), (-1.0, 0.0)):
            y = side * ((table.depth + seat.depth) / 2 - _TUCK_M)
            chair = beside(pose, x, y, turn)
            layout.place_if_fits(seat, chair, over=[layout.obstacle_of(placed)])
    scatter(layout, placed, (devices.laptop, kitchenware.cup, decor.books, kitchenware.bottle), 2)
    return True


def _place_lounge(layout: RoomLayout, pose: ModelPose) -> None:
    """Place a sofa with a coffee table before it, a place to rest between the desks."""
    rng, palette = layout.rng, layout.palette
    sofa, table = seating.sofa(rng, palette), tables.coffee_table(rng, palette)
    for model, y in ((sofa, 0.0), (table, sofa.depth / 2 + 0.4 + table.depth / 2)):
        own = beside(pose, 0.0, y)
        layout.place_if_fits(model, own)


def furnish_meeting_room(layout: RoomLayout) -> None:
    """Furnish with a table and chairs in the middle, a screen and a board."""
    rng, palette = layout.rng, layout.palette
    i = layout.inner
    seat = rng.choice((seating.office_chair, seating.dining_chair))(rng, palette)
    yaw = 0.0 if i.width >= i.depth else 90.0
    long = max(i.width, i.depth)
    for seats in (10, 8, 6, 4):
        table = office_equipment.meeting_table(rng, palette, seats)
        if table.width + 2.0 > long and seats > 4:
            continue
        if any(
            place_table(layout, table, seat, ModelPose(*i.centre, y)) for y in (yaw, 90.0 - yaw)
        ):
            break
    ends = ("west", "east") if i.width >= i.depth else ("south", "north")
    screen = rng.choice((devices.wall_tv, devices.wall_tv, office_equipment.projector_screen))(
        rng, palette
    )
    hung = layout.hang_on_wall(screen, sides=ends, z=1.0)
    if hung is not None and hung.model.category == "projector screen":
        pose = ModelPose(*i.centre, hung.yaw_deg + 180.0, layout.height - 0.001)
        layout.place(office_equipment.projector(rng, palette), pose)
    if rng.chance(0.75):
        layout.hang_on_wall(office_equipment.whiteboard(rng, palette), z=0.95)
    if rng.chance(0.5):
        base = layout.place_at_wall(storage.cabinet(rng, palette), front=0.4)
        scatter(layout, base, (plants.flower_vase, devices.phone, decor.books), 1)
    if rng.chance(0.4):
        layout.place_at_wall(household.trash_can(rng, palette), where="corner")
    if rng.chance(0.6):
        place_plants(layout, 1)


def furnish_lounge(layout: RoomLayout) -> None:
    """Furnish with sofas before a screen, shelves, and something to play with."""
    rng = layout.rng
    place_seating_group(layout)
    things = (
        (storage.bookshelf, 0.5),
        (seating.bean_bag, 0.5),
        (seating.armchair, 0.4),
        (seating.ottoman, 0.3),
        (devices.floor_lamp, 0.5),
        (leisure.guitar, 0.15),
        (leisure.piano, 0.12),
        (office_equipment.vending_machine, 0.4),
    )
    stand_some(layout, rng.shuffled(things))
    place_plants(layout, rng.integer(1, 2))


def furnish_reception(layout: RoomLayout) -> None:
    """Furnish with a counter that faces the room, a chair behind it, seats to wait on."""
    rng, palette = layout.rng, layout.palette
    place_counter(layout)
    sofa = layout.place_at_wall(seating.sofa(rng, palette), front=0.9, reserve_front=False)
    if sofa is not None:
        table = tables.coffee_table(rng, palette)
        y = sofa.model.depth / 2 + 0.4 + table.depth / 2
        pose = beside(sofa, 0.0, y)
        if layout.fits(table, pose):
            scatter(layout, layout.place(table, pose), (decor.magazine, plants.flower_vase), 2)
    things = (
        (seating.armchair, 0.6),
        (storage.coat_rack, 0.6),
        (office_equipment.water_dispenser, 0.4),
        (luggage_and_tools.umbrella, 0.5),
        (storage.display_cabinet, 0.2),
        (office_equipment.vending_machine, 0.15),
    )
    stand_some(layout, rng.shuffled(things))
    if rng.chance(0.5):
        layout.hang_on_wall(devices.wall_tv(rng, palette), z=1.2)
    place_plants(layout, rng.integer(1, 3))


def place_counter(layout: RoomLayout) -> None:
    """Place the reception desk with free floor behind it for a chair."""
    rng, palette = layout.rng, layout.palette
    desk = office_equipment.reception_desk(rng, palette)
    seat = seating.office_chair(rng, palette)
    for gap in (1.15, 1.0):
        piece = layout.place_at_wall(desk, gap=gap, front=0.8, access=True, where="middle")
        if piece is None:
            continue
        pose = beside(piece, 0.0, -desk.depth / 2 - 0.36)
        layout.place_if_fits(seat, pose)
        layout.place_on_top(piece, devices.monitor(rng, palette), facing=180.0, where=(0.3, 0.9))
        layout.place_on_top(piece, devices.keyboard(rng, palette), facing=180.0, where=(0.3, 0.2))
        scatter(layout, piece, (devices.phone, decor.pen_cup), 2)
        return


def furnish_pantry(layout: RoomLayout) -> None:
    """Furnish with kitchen units, a coffee machine, tables to eat at, machines."""
    rng, palette = layout.rng, layout.palette
    place_units(layout)
    base = next(
        (p for p in layout.placed if p.model.category == "kitchen cabinet" and not p.z), None
    )
    scatter(layout, base, (kitchenware.coffee_machine, kitchenware.microwave), 2)
    for _ in range(1 + (layout.inner.area > 22.0)):
        place_dining(layout, seats=rng.choice((2, 4, 4)))
    things = (
        (office_equipment.water_dispenser, 0.7),
        (office_equipment.vending_machine, 0.4),
        (household.trash_can, 0.9),
        (storage.wine_rack, 0.05),
    )
    stand_some(layout, rng.shuffled(things), where="corner")
    if rng.chance(0.4):
        layout.hang_on_wall(office_equipment.notice_board(rng, palette), z=1.0)
    if rng.chance(0.4):
        place_plants(layout, 1)


def furnish_restroom(layout: RoomLayout) -> None:
    """Furnish with toilets, basins with mirrors, soap and a bin."""
    rng, palette = layout.rng, layout.palette
    toilet, basin = sanitary.toilet(rng, palette), sanitary.bathroom_sink(rng, palette)
    pairs = 2 if layout.inner.area > 8.5 else 1
    for _ in range(pairs):
        layout.place_at_wall(toilet, front=0.55, access=True, where="corner")
    for _ in range(pairs):
        for _ in range(3):
            piece = layout.place_at_wall(basin, front=0.55, access=True)
            if piece is not None:
                layout.hang_on_wall(decor.mirror(rng, palette), z=1.15, near=piece)
                scatter(layout, piece, (household.soap_dispenser,), 1)
                break
    layout.hang_on_wall(decor.toilet_paper(rng, palette), z=0.65)
    layout.place_at_wall(household.trash_can(rng, palette), where="corner")
    stand_some(layout, ((household.toilet_brush, 0.6), (plants.leafy_plant, 0.2)), where="corner")


def furnish_copy_room(layout: RoomLayout) -> None:
    """Furnish with a copier, a printer on a cabinet, paper, a shredder."""
    rng, palette = layout.rng, layout.palette
    for _ in range(3):
        if (
            layout.place_at_wall(office_equipment.copier(rng, palette), front=0.7, access=True)
            is not None
        ):
            break
    base = layout.place_at_wall(storage.filing_cabinet(rng, palette), front=0.5, access=True)
    if base is not None:
        layout.place_on_top(base, devices.printer(rng, palette), facing=0.0)
    things = (
        (storage.metal_shelf, 0.8),
        (office_equipment.paper_shredder, 0.7),
        (household.trash_can, 0.7),
        (luggage_and_tools.cardboard_boxes, 0.6),
    )
    stand_some(layout, rng.shuffled(things), where="corner")
    if rng.chance(0.5):
        layout.hang_on_wall(office_equipment.notice_board(rng, palette), z=1.0)


def furnish_storage(layout: RoomLayout) -> None:
    """Furnish with racks along the walls, boxes, and what the cleaners need."""
    rng, palette = layout.rng, layout.palette
    rack = storage.metal_shelf(rng, palette)
    for _ in range(max(int(layout.inner.area / 3.5), 1)):
        layout.place_at_wall(rack, front=0.5, access=True)
    things = (
        (luggage_and_tools.cardboard_boxes, 0.9),
        (office_equipment.locker, 0.4),
        (devices.vacuum_cleaner, 0.6),
        (luggage_and_tools.ladder, 0.5),
        (luggage_and_tools.toolbox, 0.5),
        (household.broom, 0.6),
        (household.bucket, 0.6),
    )
    stand_some(layout, rng.shuffled(things), corner_chance=0.6)


def furnish_server_room(layout: RoomLayout) -> None:
    """Furnish with racks of computers side by side."""
    rng, palette = layout.rng, layout.palette
    rack = office_equipment.server_rack(rng, palette)
    for _ in range(max(int(layout.inner.area / 4.0), 2)):
        layout.place_at_wall(rack, front=0.7, access=True, where="corner")
    things = (
        (luggage_and_tools.cardboard_boxes, 0.5),
        (luggage_and_tools.fire_extinguisher, 0.8),
        (seating.stool, 0.3),
    )
    stand_some(layout, things, where="corner")


def furnish_corridor(layout: RoomLayout) -> None:
    """Furnish a corridor with what leaves it open: boards, plants, extinguishers, a bench."""
    rng, palette = layout.rng, layout.palette
    long = max(layout.inner.width, layout.inner.depth)
    for _ in range(1 + int(long / 15.0)):
        layout.place_at_wall(luggage_and_tools.fire_extinguisher(rng, palette))
    things = (
        (office_equipment.water_dispenser, 0.35),
        (office_equipment.copier, 0.15),
        (seating.bench_seat, 0.3),
        (plants.snake_plant, 0.5),
        (plants.leafy_plant, 0.4),
        (office_equipment.locker, 0.2),
        (office_equipment.vending_machine, 0.12),
        (household.trash_can, 0.3),
    )
    stand_some(layout, rng.shuffled(things), access=True)
    for maker, chance in ((office_equipment.notice_board, 0.6), (decor.wall_clock, 0.4)):
        if rng.chance(chance):
            model = maker(rng, palette)
            layout.hang_on_wall(model, z=round(1.5 - model.height / 2, 3))


FURNISHERS: dict[str, Callable[[RoomLayout], None]] = {
    "office": furnish_cell_office,
    "open office": furnish_open_office,
    "meeting room": furnish_meeting_room,
    "conference room": furnish_meeting_room,
    "lounge": furnish_lounge,
    "reception": furnish_reception,
    "pantry": furnish_pantry,
    "restroom": furnish_restroom,
    "copy room": furnish_copy_room,
    "storage": furnish_storage,
    "server room": furnish_server_room,
    "corridor": furnish_corridor,
}
"""Function that furnishes each kind of room."""


def _required(plan: FloorPlan, number: int) -> RequiredGroups:
    return REQUIRED.get(plan.rooms[number].kind, ())


def _furnish(layout: RoomLayout) -> None:
    FURNISHERS[layout.room.kind](layout)


def _dress(layout: RoomLayout) -> None:
    dress_public_room(layout, _PICTURES.get(layout.room.kind, 0))


OFFICE_FURNISHING = Furnishing(_required, _furnish, _dress)
"""Rules by which offices are furnished."""
