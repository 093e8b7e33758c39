"""What belongs to a sofa: cushions, a coffee table, armchairs, a side table, a rug."""

from hypernav.houses.assembly import Placed
from hypernav.houses.furnish.dressing import scatter
from hypernav.houses.furnish.floor_things import put_rug
from hypernav.houses.furnish.site import Site
from hypernav.houses.furnish.spots import Spot, turned_point
from hypernav.houses.furniture.decor import ornaments, plants, textiles
from hypernav.houses.furniture.devices import electronics, lighting
from hypernav.houses.furniture.kitchen_and_bath import tableware
from hypernav.houses.furniture.seating_and_storage import sofas, stools, tables
from hypernav.houses.kit.model import Model


def put_cushions(site: Site, couch: Placed) -> None:
    """One or two cushions in the sofa's corners."""
    model = couch.model
    if model.width < 1.2 or site.dice.chance(0.25):
        return
    back = model.low[1] + 0.47
    for s in (-1.0, 1.0):
        if site.dice.chance(0.7):
            cushion = textiles.sofa_cushion(site.dice, site.taste)
            x, y = turned_point(s * (model.width / 2 - 0.47), back, couch.yaw_deg)
            site.put(cushion, Spot(couch.x + x, couch.y + y, couch.yaw_deg, 0.475), on_top=True)


def furnish_around(site: Site, couch: Placed) -> None:
    """A coffee table before a sofa, a rug under it, armchairs and side tables beside it."""
    dice, taste = site.dice, site.taste
    model = couch.model
    chaise = "L-shaped" in model.attributes
    front = model.depth / 2
    if dice.chance(0.85):
        table = tables.coffee_table(dice, taste)
        off = front + 0.38 + table.depth / 2 if not chaise else front - 0.25 + table.depth / 2
        shift = 0.0
        if chaise:
            seat_x = _chaise_side(model)
            shift = -seat_x * (0.32 + table.width * 0.1)
        dx, dy = turned_point(shift, off, couch.yaw_deg)
        spot = Spot(couch.x + dx, couch.y + dy, couch.yaw_deg)
        over = [site.solid_of(couch)] if chaise else []
        if site.fits(table, spot, over=over, in_clear=True) and not (
            chaise and _hits_chaise(table, shift, off, model)
        ):
            piece = site.put(table, spot)
            scatter(
                site,
                piece,
                (
                    ornaments.books,
                    plants.flower_vase,
                    plants.small_plant,
                    tableware.bowl,
                    tableware.cup,
                    ornaments.remote,
                    ornaments.candle,
                    ornaments.magazine,
                ),
                dice.integer(1, 3),
            )
    if dice.chance(0.75):
        rug = textiles.rug(dice, taste)
        dx, dy = turned_point(0.0, front + 0.5, couch.yaw_deg)
        put_rug(site, rug, Spot(couch.x + dx, couch.y + dy, couch.yaw_deg))
    for s in dice.shuffled((-1.0, 1.0)):
        if dice.chance(0.6):
            seat = dice.weighted(((sofas.armchair, 4.0), (stools.ottoman, 0.5)))(dice, taste)
            dx, dy = turned_point(s * (model.width / 2 + 0.25), front + 0.55, couch.yaw_deg)
            spot = Spot(couch.x + dx, couch.y + dy, couch.yaw_deg + s * 90.0)
            if site.fits(seat, spot, access=False):
                site.put(seat, spot)
    for s in dice.shuffled((-1.0, 1.0)):
        side_table = tables.side_table(dice, taste)
        back = -model.depth / 2 + side_table.depth / 2 + 0.02
        dx, dy = turned_point(
            s * (model.width / 2 + side_table.width / 2 + 0.04), back, couch.yaw_deg
        )
        spot = Spot(couch.x + dx, couch.y + dy, couch.yaw_deg)
        if dice.chance(0.5) and site.fits(side_table, spot):
            piece = site.put(side_table, spot)
            scatter(site, piece, (lighting.table_lamp,), 1)
            scatter(site, piece, (ornaments.books, tableware.cup, electronics.phone), 1)


def _chaise_side(model: Model) -> float:
    """Which end of an L-shaped sofa reaches forward: -1 its left, 1 its right."""
    ahead = model.high[1] - 0.2
    xs = [
        float(p.mesh.positions[p.mesh.positions[:, 1] > ahead][:, 0].mean())
        for p in model.parts
        if (p.mesh.positions[:, 1] > ahead).any()
    ]
    return 1.0 if sum(xs) > 0 else -1.0


def _hits_chaise(table: Model, shift: float, off: float, couch: Model) -> bool:
    """Whether a table in the corner of an L-shaped sofa would touch it."""
    x0, x1 = shift - table.width / 2 - 0.05, shift + table.width / 2 + 0.05
    y0, y1 = off - table.depth / 2 - 0.05, off + table.depth / 2 + 0.05
    for part in couch.parts:
        low, high = part.mesh.positions.min(axis=0), part.mesh.positions.max(axis=0)
        if low[0] < x1 and high[0] > x0 and low[1] < y1 and high[1] > y0:
            return True
    return False
