"""Bathrooms."""

from hypernav.houses.assembly import Placed
from hypernav.houses.furnish.dressing import scatter
from hypernav.houses.furnish.site import Site
from hypernav.houses.furnish.spots import SIDES, Spot, turned_point
from hypernav.houses.furniture.belongings import household
from hypernav.houses.furniture.decor import ornaments, plants, textiles, walls
from hypernav.houses.furniture.kitchen_and_bath import bathing, bathroom, laundry
from hypernav.houses.furniture.seating_and_storage import cabinets


def furnish_bathroom(site: Site, *, with_washer: bool) -> None:
    """Toilet with clearance, basin with mirror, tub or shower, towels.

    Args:
        site: The room.
        with_washer: Whether a washing machine belongs here.
    """
    dice, taste = site.dice, site.taste
    big = site.inner.area > 4.4
    tub = (
        site.at_wall(bathing.bathtub(dice, taste), where="corner", gap=0.012)
        if big and dice.chance(0.6)
        else None
    )
    if tub is None:
        site.at_wall(bathing.shower(dice, taste), where="corner", front=0.5, access=True)
    site_toilet = site.at_wall(
        bathroom.toilet(dice, taste), front=0.55, access=True, where=dice.choice(("any", "corner"))
    )
    basin = None
    for _ in range(3):
        basin = site.at_wall(bathroom.bathroom_sink(dice, taste), front=0.55, access=True)
        if basin is not None:
            break
    if tub is not None:
        _curtain(site, tub)
    if basin is not None:
        mirror = walls.mirror(dice, taste)
        site.on_wall(mirror, sides=SIDES, z=1.15, near=basin)
        scatter(site, basin, (household.soap_dispenser, household.toothbrush_cup), 2)
    if site_toilet is not None:
        scatter(
            site,
            site_toilet,
            (plants.small_plant, ornaments.candle, textiles.folded_towels),
            1 if dice.chance(0.4) else 0,
        )
    if with_washer:
        washer = site.at_wall(
            laundry.washing_machine(dice, taste), front=0.55, access=True, where="corner"
        )
        scatter(site, washer, (household.detergent, textiles.folded_towels), 1)
    site.on_wall(walls.towel_rack(dice, taste), sides=SIDES, z=0.82)
    site.on_wall(walls.toilet_paper(dice, taste), sides=SIDES, z=0.65)
    for maker, chance in (
        (household.trash_can, 0.6),
        (household.toilet_brush, 0.6),
        (laundry.laundry_basket, 0.35),
        (household.scale, 0.3),
        (cabinets.cabinet, 0.15),
        (plants.leafy_plant, 0.25),
    ):
        if dice.chance(chance):
            site.at_wall(maker(dice, taste), where="corner" if dice.chance(0.6) else "any")
    mat = textiles.bath_mat(dice, taste)
    host = tub or basin
    if host is not None:
        dx, dy = turned_point(0.0, host.model.depth / 2 + 0.3, host.yaw_deg)
        spot = Spot(host.x + dx, host.y + dy, host.yaw_deg)
        if not site.is_taken(mat, spot) and site.fits(mat, spot, in_clear=True):
            site.put(mat, spot, flat=True)


def _curtain(site: Site, tub: Placed) -> None:
    model = walls.shower_curtain(site.dice, site.taste, round(tub.model.width - 0.04, 3))
    dx, dy = turned_point(0.0, tub.model.depth / 2 + 0.06, tub.yaw_deg)
    spot = Spot(tub.x + dx, tub.y + dy, tub.yaw_deg, 0.25)
    if not site.is_taken(model, spot) and site.fits(model, spot, in_clear=True, tight=True):
        site.put(model, spot)
