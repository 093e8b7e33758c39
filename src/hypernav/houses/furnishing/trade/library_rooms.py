"""Furnishing of libraries: stacks, places to read, the desk of the librarian."""

from hypernav.houses.furnishing.rugs_and_plants import place_plants
from hypernav.houses.furnishing.trade.aisles import (
    behind,
    front_side,
    grid_points,
    line_walls,
    place_aisles,
)
from hypernav.houses.furnishing.workplace.meeting_rooms import place_counter
from hypernav.houses.furnishing.workplace.work_rooms import place_table
from hypernav.houses.objects.belongings import household
from hypernav.houses.objects.devices import lighting
from hypernav.houses.objects.furniture import chairs, shelves, sofas, stools, tables
from hypernav.houses.objects.shop import shelving
from hypernav.houses.objects.workplace import boards, machines, office_furniture
from hypernav.houses.placement.model_pose import SIDES, ModelPose
from hypernav.houses.placement.room_layout import RoomLayout


def furnish_library(layout: RoomLayout) -> None:
    """Furnish with a desk and tables to read at in front, stacks behind, shelves at the walls."""
    rng, palette = layout.rng, layout.palette
    front = front_side(layout)
    place_counter(layout)
    i = layout.inner
    reading = 0.4 * (i.depth if front in ("south", "north") else i.width)
    stacks = behind(i.grown(-1.5), front, reading)
    rows = [shelving.library_shelf(rng, palette) for _ in range(5)]
    if min(stacks.width, stacks.depth) > 0.6:
        place_aisles(layout, rows, stacks, rng.uniform(1.3, 1.7))
    line_walls(layout, [shelves.bookshelf(rng, palette) for _ in range(3)], rng.shuffled(SIDES)[:2])
    _place_reading_tables(layout, 1 + int(i.area / 45.0))
    for maker, most in (
        (sofas.armchair, 3),
        (machines.copier, 1),
        (shelving.book_cart, 2),
        (shelving.magazine_rack, 2),
        (stools.step_stool, 1),
        (tables.side_table, 1),
        (lighting.floor_lamp, 2),
        (household.trash_can, 1),
        (sofas.bean_bag, 2),
    ):
        for _ in range(rng.integer(0, most)):
            layout.place_at_wall(maker(rng, palette))
    place_plants(layout, rng.integer(1, 3))


def furnish_reading_room(layout: RoomLayout) -> None:
    """Furnish with tables to read at, armchairs and shelves."""
    rng, palette = layout.rng, layout.palette
    _place_reading_tables(layout, 1 + int(layout.inner.area / 16.0))
    for maker, most in (
        (shelves.bookshelf, 2),
        (sofas.armchair, 2),
        (lighting.floor_lamp, 1),
    ):
        for _ in range(rng.integer(0, most)):
            layout.place_at_wall(maker(rng, palette))
    place_plants(layout, 1)


def furnish_study_room(layout: RoomLayout) -> None:
    """Furnish with one table, chairs and a board."""
    rng, palette = layout.rng, layout.palette
    seat = chairs.dining_chair(rng, palette)
    table = office_furniture.meeting_table(rng, palette, 4)
    for yaw in rng.shuffled((0.0, 90.0)):
        if place_table(layout, table, seat, ModelPose(*layout.inner.centre, yaw)):
            break
    layout.hang_on_wall(boards.whiteboard(rng, palette), sides=SIDES, z=0.95)
    layout.place_at_wall(household.trash_can(rng, palette), where="corner")


def _place_reading_tables(layout: RoomLayout, count: int) -> None:
    rng, palette = layout.rng, layout.palette
    table = office_furniture.meeting_table(rng, palette, rng.choice((4, 6)))
    seat = chairs.dining_chair(rng, palette)
    left = count
    for x, y in rng.shuffled(grid_points(layout.inner.grown(-1.4), 1.5)):
        if left == 0:
            return
        pose = ModelPose(x, y, rng.choice((0.0, 90.0)))
        clear = layout.fits(table, pose) and layout.is_free(layout.front_zone(table, pose, 0.8))
        if clear and place_table(layout, table, seat, pose):
            left -= 1
