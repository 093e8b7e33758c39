"""Bedrooms and offices."""

from hypernav.houses.assembly import Placed
from hypernav.houses.furnish.dressing import scatter
from hypernav.houses.furnish.floor_things import place_plants, put_rug
from hypernav.houses.furnish.site import Site
from hypernav.houses.furnish.spots import SIDES, Spot, turned_point
from hypernav.houses.furniture.belongings import belongings, household, pastime, sport, toys
from hypernav.houses.furniture.decor import ornaments, plants, textiles
from hypernav.houses.furniture.devices import electronics, lighting, screens
from hypernav.houses.furniture.kitchen_and_bath import laundry, tableware
from hypernav.houses.furniture.seating_and_storage import (
    beds,
    cabinets,
    chairs,
    desks,
    shelves,
    sofas,
    stools,
    tables,
)


def furnish_bedroom(site: Site, *, first: bool) -> None:
    """A bed with its head to the wall, nightstands, a wardrobe, and what fits.

    Args:
        site: The room.
        first: Whether this is the main bedroom; others may be children's or guest rooms.
    """
    dice, taste = site.dice, site.taste
    child = not first and dice.chance(0.5)
    bed = _place_bed(site, double=first or (not child and dice.chance(0.5)), child=child)
    if bed is not None:
        _beside_bed(site, bed)
    site.at_wall(cabinets.wardrobe(dice, taste), front=0.55, access=True, where="corner")
    if child:
        for maker in dice.shuffled(
            (
                toys.toy_box,
                toys.dollhouse,
                toys.teddy_bear,
                toys.toy_blocks,
                toys.toy_car,
                sport.football,
            )
        )[:3]:
            site.at_wall(maker(dice, taste), where="corner")
    if dice.chance(0.6 if child else 0.35):
        place_desk(site)
    for maker, chance in dice.shuffled(
        (
            (cabinets.dresser, 0.55),
            (desks.dressing_table, 0.25),
            (shelves.bookshelf, 0.3),
            (cabinets.tv_stand, 0.3),
        )
    ):
        if not dice.chance(chance):
            continue
        base = site.at_wall(maker(dice, taste), front=0.45, access=True)
        if maker is cabinets.tv_stand and base is not None:
            site.on_top(base, screens.tv(dice, taste), facing=0.0, where=(0.5, 0.4))
        scatter(
            site,
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
    for maker, chance in dice.shuffled(
        (
            (sofas.armchair, 0.2),
            (stools.bench_seat, 0.1),
            (laundry.laundry_basket, 0.3),
            (belongings.backpack, 0.25),
            (belongings.suitcase, 0.25),
            (pastime.guitar, 0.12),
            (lighting.floor_lamp, 0.25),
            (belongings.handbag, 0.15),
            (sofas.bean_bag, 0.15),
            (sport.treadmill, 0.08),
            (sport.exercise_bike, 0.07),
            (sport.dumbbells, 0.12),
            (beds.crib, 0.1),
            (pastime.easel, 0.06),
            (electronics.fan, 0.15),
            (electronics.air_purifier, 0.15),
            (textiles.rolled_mat, 0.1),
            (belongings.shoes, 0.2),
            (stools.ottoman, 0.15),
            (sport.exercise_ball, 0.08),
        )
    ):
        if dice.chance(chance):
            site.at_wall(maker(dice, taste), where="corner" if dice.chance(0.5) else "any")
    if dice.chance(0.55):
        place_plants(site, 1)


def _place_bed(site: Site, *, double: bool, child: bool) -> Placed | None:
    dice, taste = site.dice, site.taste
    choices = [beds.double_bed, beds.single_bed] if double else [beds.single_bed]
    if child and dice.chance(0.35) and site.height > 2.4:
        choices = [beds.bunk_bed, beds.single_bed]
    for maker in choices:
        model = maker(dice, taste)
        wide = model.width > 1.3
        walls = sorted(SIDES, key=lambda s: len(site.wall_openings(s)) + dice.unit())
        for side in walls:
            piece = site.at_wall(
                model, sides=(side,), where="middle" if wide else "corner", access=False
            )
            if piece is not None:
                return piece
    return None


def _beside_bed(site: Site, bed: Placed) -> None:
    dice, taste = site.dice, site.taste
    model = bed.model
    stand = tables.nightstand(dice, taste)
    lamp = lighting.table_lamp(dice, taste)
    for s in dice.shuffled((-1.0, 1.0)):
        x = s * (model.width / 2 + stand.width / 2 + 0.035)
        y = -model.depth / 2 + stand.depth / 2 + 0.01
        dx, dy = turned_point(x, y, bed.yaw_deg)
        spot = Spot(bed.x + dx, bed.y + dy, bed.yaw_deg)
        if not site.fits(stand, spot):
            continue
        piece = site.put(stand, spot)
        site.on_top(piece, lamp, facing=0.0, where=(0.5, 0.3))
        scatter(
            site, piece, (ornaments.books, ornaments.clock, electronics.phone, tableware.cup), 1
        )
    if dice.chance(0.6):
        rug = textiles.rug(dice, taste) if dice.chance(0.5) else textiles.small_rug(dice, taste)
        dx, dy = turned_point(0.0, model.depth / 2 - 0.2, bed.yaw_deg)
        put_rug(site, rug, Spot(bed.x + dx, bed.y + dy, bed.yaw_deg))


def place_desk(site: Site) -> Placed | None:
    """A desk at a wall with its chair, a computer and a lamp."""
    dice, taste = site.dice, site.taste
    model = desks.desk(dice, taste)
    piece = site.at_wall(model, front=0.75, keep=False)
    if piece is None:
        return None
    seat = chairs.office_chair(dice, taste)
    for off in (0.03, 0.15):
        dx, dy = turned_point(0.0, (model.depth + seat.depth) / 2 + off, piece.yaw_deg)
        spot = Spot(piece.x + dx, piece.y + dy, piece.yaw_deg + 180.0)
        if site.fits(seat, spot):
            site.put(seat, spot)
            break
    if dice.chance(0.5):
        site.on_top(piece, screens.laptop(dice, taste), facing=0.0, where=(0.5, 0.5))
    else:
        site.on_top(piece, screens.monitor(dice, taste), facing=0.0, where=(0.5, 0.1))
        site.on_top(piece, screens.keyboard(dice, taste), facing=0.0, where=(0.5, 0.85))
    site.on_top(
        piece, lighting.desk_lamp(dice, taste), facing=0.0, where=(dice.choice((0.03, 0.97)), 0.2)
    )
    scatter(
        site,
        piece,
        (
            ornaments.books,
            tableware.cup,
            ornaments.pen_cup,
            plants.small_plant,
            ornaments.photo_frame,
            electronics.phone,
        ),
        dice.integer(1, 3),
    )
    return piece


def furnish_office(site: Site) -> None:
    """A desk, shelves, a printer, a seat."""
    dice, taste = site.dice, site.taste
    place_desk(site)
    base = site.at_wall(cabinets.filing_cabinet(dice, taste), front=0.4, where="corner")
    if base is not None and dice.chance(0.7):
        site.on_top(base, electronics.printer(dice, taste), facing=0.0)
    site.at_wall(shelves.bookshelf(dice, taste), front=0.4, access=True)
    if dice.chance(0.4):
        site.at_wall(shelves.bookshelf(dice, taste), front=0.4, access=True)
    for maker, chance in dice.shuffled(
        (
            (sofas.armchair, 0.45),
            (household.trash_can, 0.6),
            (lighting.floor_lamp, 0.35),
            (pastime.guitar, 0.2),
            (pastime.piano, 0.12),
            (sport.treadmill, 0.12),
            (sport.exercise_bike, 0.1),
            (sofas.bean_bag, 0.12),
            (belongings.backpack, 0.3),
            (pastime.easel, 0.12),
            (electronics.fan, 0.2),
            (laundry.sewing_machine, 0.0),
            (sport.dumbbells, 0.15),
        )
    ):
        if dice.chance(chance):
            site.at_wall(maker(dice, taste), where="corner" if dice.chance(0.5) else "any")
    if dice.chance(0.4):
        side = site.at_wall(desks.console_table(dice, taste), front=0.4)
        scatter(
            site,
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
    place_plants(site, 1)
    if dice.chance(0.4):
        x, y = site.inner.centre
        put_rug(site, textiles.rug(dice, taste), Spot(x, y, 0.0))
