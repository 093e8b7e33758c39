"""Furnishing of bedrooms."""

from hypernav.houses.assembly import PlacedModel
from hypernav.houses.furnishing.office import place_desk
from hypernav.houses.furnishing.rugs_and_plants import place_plants, place_rug
from hypernav.houses.furnishing.set_dressing import scatter, stand_some
from hypernav.houses.objects.belongings import leisure, luggage_and_tools, sports, toys
from hypernav.houses.objects.decor import ornaments, plants, textiles
from hypernav.houses.objects.devices import electronics, lighting, screens
from hypernav.houses.objects.furniture import (
    beds,
    cabinets,
    desks,
    shelves,
    sofas,
    stools,
    tables,
)
from hypernav.houses.objects.kitchen_and_bathroom import laundry, tableware
from hypernav.houses.placement.model_pose import SIDES, ModelPose, turned_point
from hypernav.houses.placement.room_layout import RoomLayout


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
    layout.place_at_wall(cabinets.wardrobe(rng, palette), front=0.55, access=True, where="corner")
    if child:
        for maker in rng.shuffled(
            (
                toys.toy_box,
                toys.dollhouse,
                toys.teddy_bear,
                toys.toy_blocks,
                toys.toy_car,
                sports.football,
            )
        )[:3]:
            layout.place_at_wall(maker(rng, palette), where="corner")
    if rng.chance(0.6 if child else 0.35):
        place_desk(layout)
    for maker, chance in rng.shuffled(
        (
            (cabinets.dresser, 0.55),
            (desks.dressing_table, 0.25),
            (shelves.bookshelf, 0.3),
            (cabinets.tv_stand, 0.3),
        )
    ):
        if not rng.chance(chance):
            continue
        base = layout.place_at_wall(maker(rng, palette), front=0.45, access=True)
        if maker is cabinets.tv_stand and base is not None:
            layout.place_on_top(base, screens.tv(rng, palette), facing=0.0, where=(0.5, 0.4))
        scatter(
            layout,
            base,
            (
                lighting.table_lamp,
                ornaments.photo_frame,
                plants.small_plant,
                ornaments.clock,
                electronics.hair_dryer,
                textiles.folded_blanket,
            ),
            2,
        )
    stand_some(
        layout,
        rng.shuffled(
            (
                (sofas.armchair, 0.2),
                (stools.bench_seat, 0.1),
                (laundry.laundry_basket, 0.3),
                (luggage_and_tools.backpack, 0.25),
                (luggage_and_tools.suitcase, 0.25),
                (leisure.guitar, 0.12),
                (lighting.floor_lamp, 0.25),
                (luggage_and_tools.handbag, 0.15),
                (sofas.bean_bag, 0.15),
                (sports.treadmill, 0.08),
                (sports.exercise_bike, 0.07),
                (sports.dumbbells, 0.12),
                (beds.crib, 0.1),
                (leisure.easel, 0.06),
                (electronics.fan, 0.15),
                (electronics.air_purifier, 0.15),
                (textiles.rolled_mat, 0.1),
                (luggage_and_tools.shoes, 0.2),
                (stools.ottoman, 0.15),
                (sports.exercise_ball, 0.08),
            )
        ),
        corner_chance=0.5,
    )
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
    lamp = lighting.table_lamp(rng, palette)
    for s in rng.shuffled((-1.0, 1.0)):
        x = s * (model.width / 2 + stand.width / 2 + 0.035)
        y = -model.depth / 2 + stand.depth / 2 + 0.01
        dx, dy = turned_point(x, y, bed.yaw_deg)
        pose = ModelPose(bed.x + dx, bed.y + dy, bed.yaw_deg)
        if not layout.fits(stand, pose):
            continue
        piece = layout.place(stand, pose)
        layout.place_on_top(piece, lamp, facing=0.0, where=(0.5, 0.3))
        scatter(
            layout, piece, (ornaments.books, ornaments.clock, electronics.phone, tableware.cup), 1
        )
    if rng.chance(0.6):
        rug = textiles.rug(rng, palette) if rng.chance(0.5) else textiles.small_rug(rng, palette)
        dx, dy = turned_point(0.0, model.depth / 2 - 0.2, bed.yaw_deg)
        place_rug(layout, rug, ModelPose(bed.x + dx, bed.y + dy, bed.yaw_deg))
