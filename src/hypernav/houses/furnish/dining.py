"""Dining rooms, and the table with its chairs wherever it stands."""

from hypernav.houses.assembly import Placed
from hypernav.houses.furnish.dressing import scatter
from hypernav.houses.furnish.floor_things import place_plants, put_rug
from hypernav.houses.furnish.site import Site
from hypernav.houses.furnish.spots import Spot, footprint, turned_point
from hypernav.houses.furniture.decor import ornaments, plants, textiles
from hypernav.houses.furniture.devices import lighting
from hypernav.houses.furniture.kitchen_and_bath import tableware
from hypernav.houses.furniture.seating_and_storage import cabinets, chairs, shelves, tables
from hypernav.houses.kit.model import Model


def furnish_dining(site: Site) -> None:
    """A large table, a sideboard and what fits."""
    dice, taste = site.dice, site.taste
    piece = place_dining(site, seats=dice.choice((4, 6, 6, 8)))
    if piece is not None:
        rug = textiles.rug(dice, taste)
        if dice.chance(0.4):
            put_rug(site, rug, Spot(piece.x, piece.y, piece.yaw_deg))
        lamp = dice.choice((lighting.chandelier, lighting.pendant))(dice, taste)
        site.put(lamp, Spot(piece.x, piece.y, 0.0, site.height - 0.001))
    for maker in dice.shuffled((cabinets.cabinet, cabinets.display_cabinet, shelves.wine_rack))[:2]:
        base = site.at_wall(maker(dice, taste), front=0.4, access=True)
        scatter(
            site,
            base,
            (plants.flower_vase, ornaments.photo_frame, lighting.table_lamp, tableware.bowl),
            2,
        )
    place_plants(site, dice.integer(1, 2))


def place_dining(site: Site, seats: int) -> Placed | None:
    """A dining table with its chairs, laid for a meal or with a vase."""
    dice, taste = site.dice, site.taste
    chair = chairs.dining_chair(dice, taste)
    sizes = [s for s in (8, 6, 4, 2) if s <= seats]
    for count in sizes:
        table = tables.dining_table(dice, taste, count)
        spots = [
            (x, y, yaw)
            for x, y in _centres(site)
            for yaw in ((0.0, 90.0) if dice.chance(0.5) else (90.0, 0.0))
        ]
        for around in (0.75, 0.4):
            for x, y, yaw in spots:
                spot = Spot(x, y, yaw)
                if site.is_free(footprint(table, spot).grown(around)) and site.fits(table, spot):
                    return _set_table(site, table, chair, spot, count)
    return None


def _centres(site: Site) -> list[tuple[float, float]]:
    i = site.inner
    cx, cy = i.centre
    points = [(cx, cy)]
    nx, ny = max(int(i.width / 0.4), 2), max(int(i.depth / 0.4), 2)
    grid = [
        (round(i.x0 + i.width * a / nx, 3), round(i.y0 + i.depth * b / ny, 3))
        for a in range(1, nx)
        for b in range(1, ny)
    ]
    if site.room.kind != "dining room":
        points = []
    return points + site.dice.shuffled(grid)[:36]


def _set_table(site: Site, table: Model, chair: Model, spot: Spot, seats: int) -> Placed:
    round_ = "round" in table.attributes
    tuck = 0.16
    reach = chair.depth / 2 - tuck
    hx, hy = table.width / 2, table.depth / 2
    seatings: list[tuple[float, float, float]] = []
    per_side = {2: 1, 4: 2, 6: 2, 8: 3}[seats]
    if round_:
        seatings = [
            (0, hy + reach, 180.0),
            (0, -hy - reach, 0.0),
            (hx + reach, 0, 90.0),
            (-hx - reach, 0, -90.0),
        ][:seats]
    else:
        usable = table.width - 0.3
        for k in range(per_side):
            x = (k + 0.5 - per_side / 2) * usable / per_side
            seatings += [(x, hy + reach, 180.0), (x, -hy - reach, 0.0)]
        if seats >= 6:
            end = chair.depth / 2 + 0.03
            seatings += [(hx + end, 0, 90.0), (-hx - end, 0, -90.0)]
    placed = site.put(table, spot)
    carrier = site.solid_of(placed)
    for x, y, yaw in seatings:
        dx, dy = turned_point(x, y, spot.yaw_deg)
        seat = Spot(spot.x + dx, spot.y + dy, spot.yaw_deg + yaw)
        if site.fits(chair, seat, over=[carrier]):
            site.put(chair, seat)
    _lay_table(site, placed, seats)
    return placed


def _lay_table(site: Site, table: Placed, seats: int) -> None:
    dice = site.dice
    scatter(site, table, (plants.flower_vase, tableware.fruit_bowl, ornaments.candle), 1)
    if dice.chance(0.5):
        scatter(site, table, [tableware.plate] * min(seats, 4) + [tableware.cup] * 2, 5)
    else:
        scatter(
            site,
            table,
            (tableware.cup, ornaments.books, tableware.bottle, tableware.bowl),
            dice.integer(1, 3),
        )
