"""Furnishing of halls in which goods are sold."""

from collections.abc import Sequence

from hypernav.houses.furnishing.rugs_and_plants import place_plants
from hypernav.houses.furnishing.set_dressing import Maker, scatter
from hypernav.houses.furnishing.trade.aisles import (
    behind,
    front_side,
    grid_points,
    has_till,
    line_walls,
    place_aisles,
)
from hypernav.houses.modelling.model import Model
from hypernav.houses.objects.belongings import household, luggage_and_tools, sports
from hypernav.houses.objects.decor import ornaments, plants
from hypernav.houses.objects.furniture import chairs, shelves, sofas, stools
from hypernav.houses.objects.shop import clothes, counters, shelving
from hypernav.houses.placement.model_pose import SIDES, YAW, ModelPose
from hypernav.houses.placement.room_layout import RoomLayout

_FRONT_M = 3.4
"""Depth of the zone at the front of a large hall that has no aisles, metres."""


def furnish_supermarket(layout: RoomLayout) -> None:
    """Furnish with checkouts at the front, aisles of goods, cooled shelves at the back."""
    rng, palette = layout.rng, layout.palette
    front = front_side(layout)
    if has_till(layout.plan, layout.number):
        _place_checkouts(layout, front)
    back = {"south": "north", "north": "south", "west": "east", "east": "west"}[front]
    fridges = [counters.display_refrigerator(rng, palette) for _ in range(3)]
    line_walls(layout, fridges, (back,))
    goods = [shelving.wall_gondola(rng, palette) for _ in range(4)]
    line_walls(layout, goods, rng.shuffled([s for s in SIDES if s not in (back, front)]))
    zone = behind(layout.inner.grown(-1.75), front, _front_depth(layout))
    rows = [shelving.gondola(rng, palette) for _ in range(6)]
    if min(zone.width, zone.depth) > 0.8:
        place_aisles(layout, rows, zone, rng.uniform(1.5, 2.0))
    if rng.chance(0.6):
        place_tables(layout, [counters.chest_freezer(rng, palette)], rng.integer(1, 2))
    _place_each(
        layout,
        (
            (counters.shopping_cart, 3),
            (counters.basket_stack, 1),
            (household.trash_can, 1),
            (shelving.magazine_rack, 1),
            (luggage_and_tools.cardboard_boxes, 1),
        ),
    )


def furnish_hardware_store(layout: RoomLayout) -> None:
    """Furnish with a counter and heavy racks in rows, tools and garden goods between them."""
    rng, palette = layout.rng, layout.palette
    front = front_side(layout)
    _place_till(layout)
    racks = [shelving.pallet_rack(rng, palette) for _ in range(5)]
    zone = behind(layout.inner.grown(-1.4), front, _front_depth(layout))
    if min(zone.width, zone.depth) > 0.75:
        place_aisles(layout, racks, zone, rng.uniform(1.5, 2.1))
    line_walls(
        layout, [shelves.metal_shelf(rng, palette) for _ in range(3)], rng.shuffled(SIDES)[:2]
    )
    _place_each(
        layout,
        (
            (luggage_and_tools.ladder, 2),
            (luggage_and_tools.toolbox, 2),
            (household.bucket, 2),
            (household.broom, 2),
            (luggage_and_tools.watering_can, 1),
            (sports.bicycle, 1),
            (luggage_and_tools.cardboard_boxes, 2),
            (plants.hedge_box, 2),
            (counters.shopping_cart, 1),
        ),
    )


def furnish_clothes_shop(layout: RoomLayout) -> None:
    """Furnish with racks, tables and mannequins in the middle, rails along the walls."""
    rng, palette = layout.rng, layout.palette
    front = front_side(layout)
    _place_till(layout)
    choices: tuple[tuple[Maker, float], ...] = (
        (clothes.clothes_rail, 4.0),
        (clothes.round_rack, 2.0),
        (shelving.display_table, 2.0),
        (clothes.shoe_display, 0.7),
        (clothes.mannequin, 1.2),
        (stools.ottoman, 0.4),
    )
    models = {maker: [maker(rng, palette) for _ in range(2)] for maker, _ in choices}
    zone = behind(layout.inner.grown(-1.7), front, 0.4)
    every = rng.uniform(2.2, 2.7)
    if min(zone.width, zone.depth) > 0.5:
        for x, y in grid_points(zone, every):
            model = rng.choice(models[rng.weighted(choices)])
            pose = ModelPose(x, y, rng.choice((0.0, 90.0)))
            if layout.fits(model, pose):
                layout.place(model, pose)
    rails = models[clothes.clothes_rail]
    line_walls(layout, rails, rng.shuffled([s for s in SIDES if s != front])[:2])
    _place_each(
        layout,
        (
            (clothes.mannequin, 2),
            (shelves.shoe_rack, 2),
            (sofas.armchair, 1),
            (stools.bench_seat, 1),
            (luggage_and_tools.handbag, 1),
            (luggage_and_tools.suitcase, 1),
        ),
    )
    place_plants(layout, rng.integer(0, 2))


def furnish_bookshop(layout: RoomLayout) -> None:
    """Furnish with bookshelves at the walls and in rows, tables of books, a counter, seats."""
    rng, palette = layout.rng, layout.palette
    front = front_side(layout)
    _place_till(layout)
    walls = [shelves.bookshelf(rng, palette) for _ in range(4)]
    line_walls(layout, walls, rng.shuffled([s for s in SIDES if s != front]))
    zone = behind(layout.inner.grown(-1.6), front, _front_depth(layout))
    rows = [shelving.library_shelf(rng, palette) for _ in range(4)]
    if min(zone.width, zone.depth) > 0.6:
        place_aisles(layout, rows, zone, rng.uniform(1.4, 1.9))
    place_tables(layout, [shelving.book_table(rng, palette)], 2)
    _place_each(
        layout,
        (
            (sofas.armchair, 2),
            (chairs.dining_chair, 1),
            (shelving.magazine_rack, 2),
            (stools.step_stool, 1),
            (shelving.book_cart, 1),
        ),
    )
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
    model = counters.checkout_counter(rng, palette)
    start, end, _ = layout.wall_line(front)
    wanted = 1 + int(layout.inner.area / 90.0)
    placed = 0
    for k in range(int((end - start - 1.6) / 1.9)):
        t = round(start + 1.4 + 1.9 * k, 3)
        middle = layout.pose_at_wall(model, front, t, 1.1 + model.width / 2 - model.depth / 2)
        pose = ModelPose(middle.x, middle.y, YAW[front] + 90.0)
        if placed < wanted and layout.fits(model, pose):
            piece = layout.place(model, pose)
            scatter(layout, piece, (ornaments.magazine, household.basket), 1)
            placed += 1
    if placed == 0:
        _place_till(layout)


def _place_till(layout: RoomLayout) -> None:
    """Place a counter where customers pay, with space behind it for the seller."""
    if not has_till(layout.plan, layout.number):
        return
    rng, palette = layout.rng, layout.palette
    model = counters.sales_counter(rng, palette)
    for gap in (1.1, 0.95, 0.9):
        piece = layout.place_at_wall(model, gap=gap, front=0.9, access=True)
        if piece is not None:
            scatter(layout, piece, (ornaments.pen_cup, plants.small_plant, ornaments.magazine), 2)
            return


def _place_each(layout: RoomLayout, choices: Sequence[tuple[Maker, int]]) -> None:
    """Place up to so many of each model along the walls."""
    for maker, most in layout.rng.shuffled(choices):
        for _ in range(layout.rng.integer(0, most)):
            layout.place_at_wall(maker(layout.rng, layout.palette))
