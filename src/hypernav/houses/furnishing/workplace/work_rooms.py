"""Furnishing of rooms with desks: cell offices and open offices."""

from hypernav.houses.assembly import PlacedModel
from hypernav.houses.furnishing.rugs_and_plants import place_plants
from hypernav.houses.furnishing.set_dressing import Maker, scatter, stand_some
from hypernav.houses.modelling.model import Model
from hypernav.houses.objects.belongings import household, luggage_and_tools
from hypernav.houses.objects.decor import ornaments, plants
from hypernav.houses.objects.devices import electronics, lighting, screens
from hypernav.houses.objects.furniture import cabinets, chairs, shelves, sofas, tables
from hypernav.houses.objects.kitchen_and_bathroom import tableware
from hypernav.houses.objects.workplace import boards, machines, office_furniture
from hypernav.houses.placement.model_pose import SIDES, ModelPose, turned_point
from hypernav.houses.placement.room_layout import RoomLayout
from hypernav.houses.plan.shapes import Rect

_TUCK_M = 0.14
"""How far a chair is pushed under its desk, metres."""

_BACK_TO_BACK_M = 0.815
"""Distance between the middles of two desks that face each other, metres."""

_ISLAND_DEPTH_M = 2.9
_WALKWAY_M = 0.95
_ON_DESK: tuple[Maker, ...] = (
    ornaments.books,
    tableware.cup,
    ornaments.pen_cup,
    plants.small_plant,
    electronics.phone,
    ornaments.photo_frame,
)


def furnish_cell_office(layout: RoomLayout) -> None:
    """Furnish with one or two desks at the walls, cabinets, a visitor's chair, a board."""
    rng, palette = layout.rng, layout.palette
    desk = office_furniture.work_desk(rng, palette, rng.choice((1.4, 1.6)))
    seat = chairs.office_chair(rng, palette)
    for _ in range(2 if layout.inner.area > 13.0 and rng.chance(0.6) else 1):
        for _ in range(3):
            piece = layout.place_at_wall(desk, front=0.8, reserve_front=False)
            if piece is not None:
                _equip(layout, piece, seat)
                break
    for maker, chance in rng.shuffled(
        (
            (shelves.bookshelf, 0.6),
            (cabinets.filing_cabinet, 0.7),
            (cabinets.cabinet, 0.3),
            (office_furniture.drawer_unit, 0.4),
        )
    ):
        if rng.chance(chance):
            piece = layout.place_at_wall(maker(rng, palette), front=0.45, access=True)
            scatter(layout, piece, (plants.small_plant, electronics.printer), 1)
    stand_some(
        layout,
        rng.shuffled(
            (
                (sofas.armchair, 0.25),
                (chairs.dining_chair, 0.4),
                (household.trash_can, 0.6),
                (shelves.coat_rack, 0.35),
                (machines.desk_computer, 0.3),
                (machines.paper_shredder, 0.15),
                (luggage_and_tools.backpack, 0.25),
                (lighting.floor_lamp, 0.2),
                (electronics.fan, 0.1),
            )
        ),
        corner_chance=0.5,
    )
    if rng.chance(0.5):
        layout.hang_on_wall(boards.whiteboard(rng, palette), sides=SIDES, z=0.95)
    if rng.chance(0.6):
        place_plants(layout, 1)


def furnish_open_office(layout: RoomLayout) -> None:
    """Furnish with islands of desks in rows, with cabinets, boards and plants at the walls."""
    rng, palette = layout.rng, layout.palette
    desk = office_furniture.work_desk(rng, palette, rng.choice((1.4, 1.6)))
    seat = chairs.office_chair(rng, palette)
    screen = office_furniture.desk_screen(rng, palette, desk.width) if rng.chance(0.6) else None
    for pose, count in _islands(layout, desk.width):
        kind = rng.weighted((("desks", 9.0), ("table", 0.6), ("lounge", 0.5)))
        if kind == "desks":
            _place_island(layout, pose, count, desk, seat, screen)
        elif kind == "table":
            place_table(layout, office_furniture.meeting_table(rng, palette, 6), seat, pose)
        else:
            _place_lounge(layout, pose)
    for maker, count in rng.shuffled(
        (
            (cabinets.filing_cabinet, 2),
            (office_furniture.locker, 1),
            (shelves.bookshelf, 2),
            (cabinets.cabinet, 1),
            (machines.copier, 1 if rng.chance(0.3) else 0),
            (shelves.coat_rack, 1),
            (household.trash_can, 2),
            (machines.paper_shredder, 1 if rng.chance(0.4) else 0),
            (electronics.fan, 1 if rng.chance(0.3) else 0),
        )
    ):
        model = maker(rng, palette)
        for _ in range(rng.integer(0, count)):
            piece = layout.place_at_wall(model, front=0.3, access=True)
            scatter(layout, piece, (plants.small_plant, electronics.printer, ornaments.books), 1)
    for maker, chance in ((boards.whiteboard, 0.8), (boards.notice_board, 0.5)):
        if rng.chance(chance):
            layout.hang_on_wall(maker(rng, palette), sides=SIDES, z=0.95)
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
            dx, dy = turned_point(x, side * _BACK_TO_BACK_M / 2, middle.yaw_deg)
            pose = ModelPose(middle.x + dx, middle.y + dy, middle.yaw_deg + turn)
            if layout.fits(desk, pose, tight=True):
                pair.append(layout.place(desk, pose))
        if screen is not None and len(pair) == 2:
            dx, dy = turned_point(x, 0.0, middle.yaw_deg)
            z = office_furniture.TABLE_M + 0.001
            layout.place(
                screen, ModelPose(middle.x + dx, middle.y + dy, middle.yaw_deg, z), on_top=True
            )
        for piece in pair:
            _equip(layout, piece, seat)


def _equip(layout: RoomLayout, desk: PlacedModel, seat: Model) -> None:
    """Place a chair before a desk, and a computer and small things on it."""
    rng, palette = layout.rng, layout.palette
    y = (desk.model.depth + seat.depth) / 2 - _TUCK_M
    dx, dy = turned_point(0.0, y, desk.yaw_deg)
    pose = ModelPose(desk.x + dx, desk.y + dy, desk.yaw_deg + 180.0)
    if layout.fits(seat, pose, over=[layout.obstacle_of(desk)]):
        layout.place(seat, pose)
    if rng.chance(0.25):
        layout.place_on_top(desk, screens.laptop(rng, palette), facing=0.0, where=(0.5, 0.6))
    else:
        layout.place_on_top(desk, screens.monitor(rng, palette), facing=0.0, where=(0.5, 0.15))
        layout.place_on_top(desk, screens.keyboard(rng, palette), facing=0.0, where=(0.5, 0.6))
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
            dx, dy = turned_point(x, y, pose.yaw_deg)
            chair = ModelPose(pose.x + dx, pose.y + dy, pose.yaw_deg + turn)
            if layout.fits(seat, chair, over=[layout.obstacle_of(placed)]):
                layout.place(seat, chair)
    scatter(layout, placed, (screens.laptop, tableware.cup, ornaments.books, tableware.bottle), 2)
    return True


def _place_lounge(layout: RoomLayout, pose: ModelPose) -> None:
    """Place a sofa with a coffee table before it, a place to rest between the desks."""
    rng, palette = layout.rng, layout.palette
    sofa, table = sofas.sofa(rng, palette), tables.coffee_table(rng, palette)
    for model, y in ((sofa, 0.0), (table, sofa.depth / 2 + 0.4 + table.depth / 2)):
        dx, dy = turned_point(0.0, y, pose.yaw_deg)
        own = ModelPose(pose.x + dx, pose.y + dy, pose.yaw_deg)
        if layout.fits(model, own):
            layout.place(model, own)
