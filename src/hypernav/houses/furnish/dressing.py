"""What every room gets in the end: curtains, lamps, pictures, rugs and things on surfaces."""

from collections.abc import Callable, Sequence

from hypernav.houses.assembly import Placed
from hypernav.houses.dice import Dice
from hypernav.houses.furnish.site import Site
from hypernav.houses.furnish.spots import SIDES, Spot
from hypernav.houses.furniture.decor import walls
from hypernav.houses.kit.model import Model
from hypernav.houses.palette import Taste

Maker = Callable[[Dice, Taste], Model]


def hang_curtains(site: Site) -> None:
    """Curtains at the windows, where furniture leaves room for them."""
    for side in SIDES:
        for opening in site.wall_openings(side):
            if opening.kind != "window" or opening.width < 0.9:
                continue
            high = min(opening.top + 0.14, site.height - 0.05)
            model = walls.curtain(site.dice, site.taste, opening.width, high - 0.03)
            spot = site.spot_at_wall(model, side, (opening.start + opening.end) / 2, 0.03, 0.02)
            start, end, _ = site.wall_line(side)
            along = spot.x if side in ("south", "north") else spot.y
            if along - model.width / 2 < start + 0.01 or along + model.width / 2 > end - 0.01:
                continue
            if not site.is_taken(model, spot) and site.leaves_ways(model, spot):
                site.put(model, spot)


def put_radiators(site: Site) -> None:
    """A radiator under some windows."""
    for side in SIDES:
        for opening in site.wall_openings(side):
            if opening.kind == "window" and opening.bottom > 0.85 and site.dice.chance(0.35):
                model = walls.radiator(site.dice, site.taste)
                spot = site.spot_at_wall(model, side, (opening.start + opening.end) / 2, 0.03)
                if model.width < opening.width + 0.3 and site.fits(model, spot):
                    site.put(model, spot)


def hang_lamp(site: Site, maker: Maker, xy: tuple[float, float] | None = None) -> None:
    """A lamp at the ceiling, in the middle if nothing else is said."""
    model = maker(site.dice, site.taste)
    x, y = xy or site.inner.centre
    spot = Spot(x, y, 0.0, site.height - 0.001)
    if not site.is_taken(model, spot):
        site.put(model, spot)


def hang_pictures(site: Site, count: int) -> None:
    """Pictures, a clock or a mirror on free stretches of wall."""
    for _ in range(count):
        maker = site.dice.weighted(
            ((walls.framed_picture, 6.0), (walls.clock, 1.0), (walls.mirror, 1.0))
        )
        model = maker(site.dice, site.taste)
        site.on_wall(model, sides=SIDES, z=round(1.62 - model.height / 2, 3))


def scatter(site: Site, base: Placed | None, makers: Sequence[Maker], count: int) -> list[Placed]:
    """Small things on a surface, at most ``count``; a maker is used once."""
    if base is None:
        return []
    result = []
    for maker in site.dice.shuffled(makers)[:count]:
        piece = site.on_top(base, maker(site.dice, site.taste))
        if piece is not None:
            result.append(piece)
    return result
