"""Rugs and large plants."""

from hypernav.houses.assembly import Placed
from hypernav.houses.furnish.site import Site
from hypernav.houses.furnish.spots import Spot, footprint
from hypernav.houses.furniture.decor import plants
from hypernav.houses.kit.model import Model


def put_rug(site: Site, rug: Model, spot: Spot) -> Placed | None:
    """Lay a rug flat under whatever stands there, if it lies wholly in the room."""
    rect = footprint(rug, spot)
    if not site.inner.grown(-0.02).holds(rect):
        return None
    if any(
        rect.overlaps(footprint(p.model, Spot(p.x, p.y, p.yaw_deg)))
        for p in site.placed
        if p.model.category == "rug"
    ):
        return None
    return site.put(rug, spot, flat=True)


def place_plants(site: Site, count: int) -> None:
    """Large plants in corners and along walls."""
    for _ in range(count):
        maker = site.dice.choice(
            (
                plants.snake_plant,
                plants.monstera,
                plants.indoor_tree,
                plants.leafy_plant,
                plants.leafy_plant,
            )
        )
        site.at_wall(
            maker(site.dice, site.taste), where="corner" if site.dice.chance(0.7) else "any"
        )
