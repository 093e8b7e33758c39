"""Furnishing of rooms where people meet: meeting rooms, lounges, the reception."""

from hypernav.houses.furnishing.rugs_and_plants import place_plants
from hypernav.houses.furnishing.seating_group import place_seating_group
from hypernav.houses.furnishing.set_dressing import scatter
from hypernav.houses.furnishing.workplace.work_rooms import place_table
from hypernav.houses.objects.belongings import household, leisure, luggage_and_tools
from hypernav.houses.objects.decor import ornaments, plants
from hypernav.houses.objects.devices import electronics, lighting, screens
from hypernav.houses.objects.furniture import cabinets, chairs, shelves, sofas, stools, tables
from hypernav.houses.objects.workplace import boards, machines, office_furniture
from hypernav.houses.placement.model_pose import SIDES, ModelPose, turned_point
from hypernav.houses.placement.room_layout import RoomLayout


def furnish_meeting_room(layout: RoomLayout) -> None:
    """Furnish with a table and chairs in the middle, a screen and a board."""
    rng, palette = layout.rng, layout.palette
    i = layout.inner
    seat = rng.choice((chairs.office_chair, chairs.dining_chair))(rng, palette)
    yaw = 0.0 if i.width >= i.depth else 90.0
    long = max(i.width, i.depth)
    for seats in (10, 8, 6, 4):
        table = office_furniture.meeting_table(rng, palette, seats)
        if table.width + 2.0 > long and seats > 4:
            continue
        if any(
            place_table(layout, table, seat, ModelPose(*i.centre, y)) for y in (yaw, 90.0 - yaw)
        ):
            break
    ends = ("west", "east") if i.width >= i.depth else ("south", "north")
    screen = rng.choice((screens.wall_tv, screens.wall_tv, boards.projector_screen))(rng, palette)
    hung = layout.hang_on_wall(screen, sides=ends, z=1.0)
    if hung is not None and hung.model.category == "projector screen":
        pose = ModelPose(*i.centre, hung.yaw_deg + 180.0, layout.height - 0.001)
        layout.place(machines.projector(rng, palette), pose)
    if rng.chance(0.75):
        layout.hang_on_wall(boards.whiteboard(rng, palette), sides=SIDES, z=0.95)
    if rng.chance(0.5):
        base = layout.place_at_wall(cabinets.cabinet(rng, palette), front=0.4)
        scatter(layout, base, (plants.flower_vase, electronics.phone, ornaments.books), 1)
    if rng.chance(0.4):
        layout.place_at_wall(household.trash_can(rng, palette), where="corner")
    if rng.chance(0.6):
        place_plants(layout, 1)


def furnish_lounge(layout: RoomLayout) -> None:
    """Furnish with sofas before a screen, shelves, and something to play with."""
    rng, palette = layout.rng, layout.palette
    place_seating_group(layout)
    for maker, chance in rng.shuffled(
        (
            (shelves.bookshelf, 0.5),
            (sofas.bean_bag, 0.5),
            (sofas.armchair, 0.4),
            (stools.ottoman, 0.3),
            (lighting.floor_lamp, 0.5),
            (leisure.guitar, 0.15),
            (leisure.piano, 0.12),
            (machines.vending_machine, 0.4),
        )
    ):
        if rng.chance(chance):
            layout.place_at_wall(maker(rng, palette))
    place_plants(layout, rng.integer(1, 2))


def furnish_reception(layout: RoomLayout) -> None:
    """Furnish with a counter that faces the room, a chair behind it, seats to wait on."""
    rng, palette = layout.rng, layout.palette
    place_counter(layout)
    sofa = layout.place_at_wall(sofas.sofa(rng, palette), front=0.9, reserve_front=False)
    if sofa is not None:
        table = tables.coffee_table(rng, palette)
        y = sofa.model.depth / 2 + 0.4 + table.depth / 2
        dx, dy = turned_point(0.0, y, sofa.yaw_deg)
        pose = ModelPose(sofa.x + dx, sofa.y + dy, sofa.yaw_deg)
        if layout.fits(table, pose):
            scatter(layout, layout.place(table, pose), (ornaments.magazine, plants.flower_vase), 2)
    for maker, chance in rng.shuffled(
        (
            (sofas.armchair, 0.6),
            (shelves.coat_rack, 0.6),
            (machines.water_dispenser, 0.4),
            (luggage_and_tools.umbrella, 0.5),
            (cabinets.display_cabinet, 0.2),
            (machines.vending_machine, 0.15),
        )
    ):
        if rng.chance(chance):
            layout.place_at_wall(maker(rng, palette))
    if rng.chance(0.5):
        layout.hang_on_wall(screens.wall_tv(rng, palette), sides=SIDES, z=1.2)
    place_plants(layout, rng.integer(1, 3))


def place_counter(layout: RoomLayout) -> None:
    """Place the reception desk with free floor behind it for a chair."""
    rng, palette = layout.rng, layout.palette
    desk = office_furniture.reception_desk(rng, palette)
    seat = chairs.office_chair(rng, palette)
    for gap in (1.15, 1.0):
        piece = layout.place_at_wall(desk, gap=gap, front=0.8, access=True, where="middle")
        if piece is None:
            continue
        dx, dy = turned_point(0.0, -desk.depth / 2 - 0.36, piece.yaw_deg)
        pose = ModelPose(piece.x + dx, piece.y + dy, piece.yaw_deg)
        if layout.fits(seat, pose):
            layout.place(seat, pose)
        layout.place_on_top(piece, screens.monitor(rng, palette), facing=180.0, where=(0.3, 0.9))
        layout.place_on_top(piece, screens.keyboard(rng, palette), facing=180.0, where=(0.3, 0.2))
        scatter(layout, piece, (electronics.phone, ornaments.pen_cup), 2)
        return
