"""Furnishing of offices, and of a desk with its chair in any room."""

from hypernav.houses.assembly import PlacedModel
from hypernav.houses.furnishing.rugs_and_plants import place_plants, place_rug
from hypernav.houses.furnishing.set_dressing import scatter, stand_some
from hypernav.houses.objects.belongings import household, leisure, luggage_and_tools, sports, toys
from hypernav.houses.objects.decor import ornaments, plants, textiles
from hypernav.houses.objects.devices import electronics, lighting, screens
from hypernav.houses.objects.furniture import (
    cabinets,
    chairs,
    desks,
    shelves,
    sofas,
)
from hypernav.houses.objects.kitchen_and_bathroom import laundry, tableware
from hypernav.houses.placement.model_pose import ModelPose, turned_point
from hypernav.houses.placement.room_layout import RoomLayout


def place_desk(layout: RoomLayout) -> PlacedModel | None:
    """Place a desk at a wall with its chair, a computer and a lamp."""
    rng, palette = layout.rng, layout.palette
    model = desks.desk(rng, palette)
    piece = layout.place_at_wall(model, front=0.75, reserve_front=False)
    if piece is None:
        return None
    seat = chairs.office_chair(rng, palette)
    for off in (0.03, 0.15):
        dx, dy = turned_point(0.0, (model.depth + seat.depth) / 2 + off, piece.yaw_deg)
        pose = ModelPose(piece.x + dx, piece.y + dy, piece.yaw_deg + 180.0)
        if layout.fits(seat, pose):
            layout.place(seat, pose)
            break
    if rng.chance(0.5):
        layout.place_on_top(piece, screens.laptop(rng, palette), facing=0.0, where=(0.5, 0.5))
    else:
        layout.place_on_top(piece, screens.monitor(rng, palette), facing=0.0, where=(0.5, 0.1))
        layout.place_on_top(piece, screens.keyboard(rng, palette), facing=0.0, where=(0.5, 0.85))
    layout.place_on_top(
        piece, lighting.desk_lamp(rng, palette), facing=0.0, where=(rng.choice((0.03, 0.97)), 0.2)
    )
    scatter(
        layout,
        piece,
        (
            ornaments.books,
            tableware.cup,
            ornaments.pen_cup,
            plants.small_plant,
            ornaments.photo_frame,
            electronics.phone,
        ),
        rng.integer(1, 3),
    )
    return piece


def furnish_office(layout: RoomLayout) -> None:
    """Furnish with a desk, shelves, a printer and what fits."""
    rng, palette = layout.rng, layout.palette
    place_desk(layout)
    base = layout.place_at_wall(cabinets.filing_cabinet(rng, palette), front=0.4, where="corner")
    if base is not None and rng.chance(0.7):
        layout.place_on_top(base, electronics.printer(rng, palette), facing=0.0)
    layout.place_at_wall(shelves.bookshelf(rng, palette), front=0.4, access=True)
    if rng.chance(0.4):
        layout.place_at_wall(shelves.bookshelf(rng, palette), front=0.4, access=True)
    stand_some(
        layout,
        rng.shuffled(
            (
                (sofas.armchair, 0.45),
                (household.trash_can, 0.6),
                (lighting.floor_lamp, 0.35),
                (leisure.guitar, 0.2),
                (leisure.piano, 0.12),
                (sports.treadmill, 0.12),
                (sports.exercise_bike, 0.1),
                (sofas.bean_bag, 0.12),
                (luggage_and_tools.backpack, 0.3),
                (leisure.easel, 0.12),
                (electronics.fan, 0.2),
                (laundry.sewing_machine, 0.0),
                (sports.dumbbells, 0.15),
            )
        ),
        corner_chance=0.5,
    )
    if rng.chance(0.4):
        side = layout.place_at_wall(desks.console_table(rng, palette), front=0.4)
        scatter(
            layout,
            side,
            (
                electronics.printer,
                ornaments.globe,
                toys.chess,
                electronics.radio,
                plants.small_plant,
            ),
            2,
        )
    place_plants(layout, 1)
    if rng.chance(0.4):
        x, y = layout.inner.centre
        place_rug(layout, textiles.rug(rng, palette), ModelPose(x, y, 0.0))
