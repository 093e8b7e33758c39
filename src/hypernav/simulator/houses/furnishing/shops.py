"""Furnishing of shops and libraries."""

from collections.abc import Callable, Sequence
from math import ceil

from hypernav.simulator.houses.assembly import PlacedModel
from hypernav.simulator.houses.furnishing.offices import (
    FURNISHERS,
    REQUIRED,
    place_counter,
    place_table,
)
from hypernav.simulator.houses.furnishing.room_layout import SIDES, YAW, ModelPose, RoomLayout
from hypernav.simulator.houses.furnishing.rooms import Furnishing, RequiredGroups
from hypernav.simulator.houses.furnishing.set_dressing import (
    Maker,
    dress_public_room,
    place_plants,
    scatter,
    stand_each,
    stand_some,
)
from hypernav.simulator.houses.modelling.model import Model
from hypernav.simulator.houses.objects.belongings import (
    decor,
    devices,
    household,
    luggage_and_tools,
    plants,
    sports,
)
from hypernav.simulator.houses.objects.furniture import (
    office_equipment,
    seating,
    shop_fittings,
    storage,
    tables,
)
from hypernav.simulator.houses.plan.floor_plan import FloorPlan, Rect

_CROSS_AISLE_M = 1.5
_LONGEST_RUN = 7
"""Greatest number of shelves in a row without a gap to walk through."""

_FRONT_M = 3.4
"""Depth of the zone at the front of a large hall that has no aisles, metres."""

_SHOPS = ("supermarket", "hardware store", "clothes shop", "bookshop")
_TILLS = ("checkout counter", "sales counter")
_REQUIRED: dict[str, RequiredGroups] = {
    "supermarket": (("grocery shelf",),),
    "hardware store": (("storage rack",),),
    "clothes shop": (("clothes rack",),),
    "bookshop": (("bookshelf",),),
    "library": (("bookshelf",), ("reception desk",), ("chair",)),
    "reading room": (("meeting table",), ("chair",)),
    "study room": (("meeting table",), ("chair",)),
    "staff room": REQUIRED["pantry"],
    **{kind: REQUIRED[kind] for kind in ("office", "restroom")},
}


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


def furnish_supermarket(layout: RoomLayout) -> None:
    """Furnish with checkouts at the front, aisles of goods, cooled shelves at the back."""
    rng, palette = layout.rng, layout.palette
    front = front_side(layout)
    if has_till(layout.plan, layout.number):
        _place_checkouts(layout, front)
    back = {"south": "north", "north": "south", "west": "east", "east": "west"}[front]
    fridges = [shop_fittings.display_refrigerator(rng, palette) for _ in range(3)]
    line_walls(layout, fridges, (back,))
    goods = [shop_fittings.wall_gondola(rng, palette) for _ in range(4)]
    line_walls(layout, goods, rng.shuffled([s for s in SIDES if s not in (back, front)]))
    zone = behind(layout.inner.grown(-1.75), front, _front_depth(layout))
    rows = [shop_fittings.gondola(rng, palette) for _ in range(6)]
    if min(zone.width, zone.depth) > 0.8:
        place_aisles(layout, rows, zone, rng.uniform(1.5, 2.0))
    if rng.chance(0.6):
        place_tables(layout, [shop_fittings.chest_freezer(rng, palette)], rng.integer(1, 2))
    things = (
        (shop_fittings.shopping_cart, 3),
        (shop_fittings.basket_stack, 1),
        (household.trash_can, 1),
        (shop_fittings.magazine_rack, 1),
        (luggage_and_tools.cardboard_boxes, 1),
    )
    stand_each(layout, rng.shuffled(things))


def furnish_hardware_store(layout: RoomLayout) -> None:
    """Furnish with a counter and heavy racks in rows, tools and garden goods between them."""
    rng, palette = layout.rng, layout.palette
    front = front_side(layout)
    _place_till(layout)
    racks = [shop_fittings.pallet_rack(rng, palette) for _ in range(5)]
    zone = behind(layout.inner.grown(-1.4), front, _front_depth(layout))
    if min(zone.width, zone.depth) > 0.75:
        place_aisles(layout, racks, zone, rng.uniform(1.5, 2.1))
    line_walls(
        layout, [storage.metal_shelf(rng, palette) for _ in range(3)], rng.shuffled(SIDES)[:2]
    )
    things = (
        (luggage_and_tools.ladder, 2),
        (luggage_and_tools.toolbox, 2),
        (household.bucket, 2),
        (household.broom, 2),
        (luggage_and_tools.watering_can, 1),
        (sports.bicycle, 1),
        (luggage_and_tools.cardboard_boxes, 2),
        (plants.hedge_box, 2),
        (shop_fittings.shopping_cart, 1),
    )
    stand_each(layout, rng.shuffled(things))


def furnish_clothes_shop(layout: RoomLayout) -> None:
    """Furnish with racks, tables and mannequins in the middle, rails along the walls."""
    rng, palette = layout.rng, layout.palette
    front = front_side(layout)
    _place_till(layout)
    choices: tuple[tuple[Maker, float], ...] = (
        (shop_fittings.clothes_rail, 4.0),
        (shop_fittings.round_rack, 2.0),
        (shop_fittings.display_table, 2.0),
        (shop_fittings.shoe_display, 0.7),
        (shop_fittings.mannequin, 1.2),
        (seating.ottoman, 0.4),
    )
    models = {maker: [maker(rng, palette) for _ in range(2)] for maker, _ in choices}
    zone = behind(layout.inner.grown(-1.7), front, 0.4)
    every = rng.uniform(2.2, 2.7)
    if min(zone.width, zone.depth) > 0.5:
        for x, y in grid_points(zone, every):
            model = rng.choice(models[rng.weighted(choices)])
            pose = ModelPose(x, y, rng.choice((0.0, 90.0)))
            layout.place_if_fits(model, pose)
    rails = models[shop_fittings.clothes_rail]
    line_walls(layout, rails, rng.shuffled([s for s in SIDES if s != front])[:2])
    things = (
        (shop_fittings.mannequin, 2),
        (storage.shoe_rack, 2),
        (seating.armchair, 1),
        (seating.bench_seat, 1),
        (luggage_and_tools.handbag, 1),
        (luggage_and_tools.suitcase, 1),
    )
    stand_each(layout, rng.shuffled(things))
    place_plants(layout, rng.integer(0, 2))


def furnish_bookshop(layout: RoomLayout) -> None:
    """Furnish with bookshelves at the walls and in rows, tables of books, a counter, seats."""
    rng, palette = layout.rng, layout.palette
    front = front_side(layout)
    _place_till(layout)
    walls = [storage.bookshelf(rng, palette) for _ in range(4)]
    line_walls(layout, walls, rng.shuffled([s for s in SIDES if s != front]))
    zone = behind(layout.inner.grown(-1.6), front, _front_depth(layout))
    rows = [shop_fittings.library_shelf(rng, palette) for _ in range(4)]
    if min(zone.width, zone.depth) > 0.6:
        place_aisles(layout, rows, zone, rng.uniform(1.4, 1.9))
    place_tables(layout, [shop_fittings.book_table(rng, palette)], 2)
    things = (
        (seating.armchair, 2),
        (seating.dining_chair, 1),
        (shop_fittings.magazine_rack, 2),
        (seating.step_stool, 1),
        (shop_fittings.book_cart, 1),
    )
    stand_each(layout, rng.shuffled(things))
    place_plants(layout, rng.integer(0, 2))


def place_tables(layout: RoomLayout, models: Sequence[Model], count: int) -> None:
    """Place up to ``count`` models on free floor anywhere in a hall."""
    rng = layout.rng
    left = count
    for x, y in rng.shuffled(grid_points(layout.inner.grown(-1.2), 1.3)):
        if left == 0:
            return
        model, pose = rng.choice(models), ModelPose(x, y, rng.choice((0.0, 90.0)))
        if layout.fits(model, pose, access=True):
            layout.place(model, pose, access=True)
            left -= 1


def _front_depth(layout: RoomLayout) -> float:
    """Depth of the zone without aisles; shallow halls and those without a till have none."""
    i = layout.inner
    deep = i.depth if front_side(layout) in ("south", "north") else i.width
    if not has_till(layout.plan, layout.number):
        return 0.0
    return min(_FRONT_M, max(0.5 * (deep - 6.0), 0.0))


def _place_checkouts(layout: RoomLayout, front: str) -> None:
    """Place checkouts in a row at the front, at right angles to the wall; else a counter."""
    rng, palette = layout.rng, layout.palette
    model = shop_fittings.checkout_counter(rng, palette)
    start, end, _ = layout.wall_line(front)
    wanted = 1 + int(layout.inner.area / 90.0)
    placed = 0
    for k in range(int((end - start - 1.6) / 1.9)):
        t = round(start + 1.4 + 1.9 * k, 3)
        middle = layout.pose_at_wall(model, front, t, 1.1 + model.width / 2 - model.depth / 2)
        pose = ModelPose(middle.x, middle.y, YAW[front] + 90.0)
        if placed < wanted and layout.fits(model, pose):
            piece = layout.place(model, pose)
            scatter(layout, piece, (decor.magazine, household.basket), 1)
            placed += 1
    if placed == 0:
        _place_till(layout)


def _place_till(layout: RoomLayout) -> None:
    """Place a counter where customers pay, with space behind it for the seller."""
    if not has_till(layout.plan, layout.number):
        return
    rng, palette = layout.rng, layout.palette
    model = shop_fittings.sales_counter(rng, palette)
    for gap in (1.1, 0.95, 0.9):
        piece = layout.place_at_wall(model, gap=gap, front=0.9, access=True)
        if piece is not None:
            scatter(layout, piece, (decor.pen_cup, plants.small_plant, decor.magazine), 2)
            return


def furnish_library(layout: RoomLayout) -> None:
    """Furnish with a desk and tables to read at in front, stacks behind, shelves at the walls."""
    rng, palette = layout.rng, layout.palette
    front = front_side(layout)
    place_counter(layout)
    i = layout.inner
    reading = 0.4 * (i.depth if front in ("south", "north") else i.width)
    stacks = behind(i.grown(-1.5), front, reading)
    rows = [shop_fittings.library_shelf(rng, palette) for _ in range(5)]
    if min(stacks.width, stacks.depth) > 0.6:
        place_aisles(layout, rows, stacks, rng.uniform(1.3, 1.7))
    line_walls(layout, [storage.bookshelf(rng, palette) for _ in range(3)], rng.shuffled(SIDES)[:2])
    _place_reading_tables(layout, 1 + int(i.area / 45.0))
    things = (
        (seating.armchair, 3),
        (office_equipment.copier, 1),
        (shop_fittings.book_cart, 2),
        (shop_fittings.magazine_rack, 2),
        (seating.step_stool, 1),
        (tables.side_table, 1),
        (devices.floor_lamp, 2),
        (household.trash_can, 1),
        (seating.bean_bag, 2),
    )
    stand_each(layout, things)
    place_plants(layout, rng.integer(1, 3))


def furnish_reading_room(layout: RoomLayout) -> None:
    """Furnish with tables to read at, armchairs and shelves."""
    _place_reading_tables(layout, 1 + int(layout.inner.area / 16.0))
    things = ((storage.bookshelf, 2), (seating.armchair, 2), (devices.floor_lamp, 1))
    stand_each(layout, things)
    place_plants(layout, 1)


def furnish_study_room(layout: RoomLayout) -> None:
    """Furnish with one table, chairs and a board."""
    rng, palette = layout.rng, layout.palette
    seat = seating.dining_chair(rng, palette)
    table = office_equipment.meeting_table(rng, palette, 4)
    for yaw in rng.shuffled((0.0, 90.0)):
        if place_table(layout, table, seat, ModelPose(*layout.inner.centre, yaw)):
            break
    layout.hang_on_wall(office_equipment.whiteboard(rng, palette), z=0.95)
    layout.place_at_wall(household.trash_can(rng, palette), where="corner")


def _place_reading_tables(layout: RoomLayout, count: int) -> None:
    rng, palette = layout.rng, layout.palette
    table = office_equipment.meeting_table(rng, palette, rng.choice((4, 6)))
    seat = seating.dining_chair(rng, palette)
    left = count
    for x, y in rng.shuffled(grid_points(layout.inner.grown(-1.4), 1.5)):
        if left == 0:
            return
        pose = ModelPose(x, y, rng.choice((0.0, 90.0)))
        clear = layout.fits(table, pose) and layout.is_free(layout.front_zone(table, pose, 0.8))
        if clear and place_table(layout, table, seat, pose):
            left -= 1


def furnish_stock_room(layout: RoomLayout) -> None:
    """Furnish with racks along the walls and in rows, boxes, a ladder."""
    rng, palette = layout.rng, layout.palette
    line_walls(
        layout, [storage.metal_shelf(rng, palette) for _ in range(3)], rng.shuffled(SIDES)[:2]
    )
    zone = layout.inner.grown(-1.4)
    if min(zone.width, zone.depth) > 0.8:
        place_aisles(layout, [shop_fittings.pallet_rack(rng, palette)], zone, 1.5)
    things = (
        (luggage_and_tools.cardboard_boxes, 1.0),
        (luggage_and_tools.cardboard_boxes, 0.6),
        (luggage_and_tools.ladder, 0.6),
        (luggage_and_tools.toolbox, 0.4),
        (household.broom, 0.6),
        (household.bucket, 0.5),
    )
    stand_some(layout, rng.shuffled(things), corner_chance=0.6)


def furnish_fitting_room(layout: RoomLayout) -> None:
    """Furnish with a mirror, hooks and a stool."""
    rng, palette = layout.rng, layout.palette
    layout.hang_on_wall(decor.mirror(rng, palette), z=0.8)
    layout.hang_on_wall(decor.wall_hooks(rng, palette), z=1.4)
    layout.place_at_wall(seating.stool(rng, palette), where="corner")


def furnish_arcade(layout: RoomLayout) -> None:
    """Furnish with benches and plants in the middle, machines and bins at the sides."""
    rng, palette = layout.rng, layout.palette
    long = max(layout.inner.width, layout.inner.depth)
    middle = [seating.bench_seat(rng, palette), plants.indoor_tree(rng, palette)]
    place_tables(layout, middle, 1 + int(long / 6.0))
    things = (
        (office_equipment.vending_machine, 2),
        (household.trash_can, 3),
        (luggage_and_tools.fire_extinguisher, 2),
        (plants.leafy_plant, 2),
    )
    stand_each(layout, things, least=1)
    place_plants(layout, 1)


_FURNISHERS: dict[str, Callable[[RoomLayout], None]] = {
    "supermarket": furnish_supermarket,
    "hardware store": furnish_hardware_store,
    "clothes shop": furnish_clothes_shop,
    "bookshop": furnish_bookshop,
    "library": furnish_library,
    "reading room": furnish_reading_room,
    "study room": furnish_study_room,
    "stock room": furnish_stock_room,
    "fitting room": furnish_fitting_room,
    "arcade": furnish_arcade,
    "staff room": FURNISHERS["pantry"],
    **{kind: FURNISHERS[kind] for kind in ("office", "restroom", "corridor")},
}


def _required(plan: FloorPlan, number: int) -> RequiredGroups:
    required = _REQUIRED.get(plan.rooms[number].kind, ())
    return (
        (*required, _TILLS)
        if plan.rooms[number].kind in _SHOPS and has_till(plan, number)
        else required
    )


def _furnish(layout: RoomLayout) -> None:
    _FURNISHERS[layout.room.kind](layout)


def _dress(layout: RoomLayout) -> None:
    dress_public_room(layout, 2 if layout.room.kind in ("library", "bookshop", "corridor") else 0)


SHOP_FURNISHING = Furnishing(_required, _furnish, _dress)
"""Rules by which shops and libraries are furnished."""
