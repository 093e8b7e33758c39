"""The seating group: a television at one wall, a sofa opposite."""

from hypernav.houses.furnish.around_sofa import furnish_around, put_cushions
from hypernav.houses.furnish.dressing import scatter
from hypernav.houses.furnish.site import Site
from hypernav.houses.furnish.spots import SIDES, Spot
from hypernav.houses.furniture.decor import ornaments, plants
from hypernav.houses.furniture.devices import electronics, screens
from hypernav.houses.furniture.seating_and_storage import cabinets, sofas
from hypernav.houses.kit.model import Model

_ALONG = {"south": (0.0, 1.0), "north": (0.0, -1.0), "west": (1.0, 0.0), "east": (-1.0, 0.0)}


def place_seating_group(site: Site) -> None:
    """Television at one wall, sofa opposite, coffee table and rug between."""
    dice, taste = site.dice, site.taste
    couch = dice.weighted(((sofas.sofa, 5.0), (sofas.l_shaped_sofa, 3.0), (sofas.futon, 0.7)))(
        dice, taste
    )
    stand, television, wall_mounted = _television(site)
    for sofa_model in (couch, sofas.sofa(dice, taste), sofas.armchair(dice, taste)):
        for side in sorted(
            dice.shuffled(SIDES), key=lambda s: len(site.wall_openings(s)) * 0.5 + dice.unit()
        ):
            if _try_group(site, side, sofa_model, stand, television, wall_mounted):
                return
    piece = site.at_wall(couch, access=True, where="middle")
    if piece is not None:
        put_cushions(site, piece)
    for _ in range(4):
        base = site.at_wall(stand, front=0.6, access=True)
        if base is None:
            break
        if site.on_top(base, television, facing=0.0, where=(0.5, 0.4)) is not None:
            return
        site.remove(base)
    site.on_wall(screens.wall_tv(dice, taste), sides=SIDES, z=1.0)


def _television(site: Site) -> tuple[Model, Model, bool]:
    stand = cabinets.tv_stand(site.dice, site.taste)
    if site.dice.chance(0.3):
        return stand, screens.wall_tv(site.dice, site.taste), True
    return stand, screens.tv(site.dice, site.taste), False


def _try_group(
    site: Site, side: str, couch: Model, stand: Model, television: Model, wall_mounted: bool
) -> bool:
    dice = site.dice
    start, end, _ = site.wall_line(side)
    across = site.inner.depth if side in ("south", "north") else site.inner.width
    half = max(stand.width, couch.width) / 2 + 0.05
    if end - start < 2 * half or across < 3.0:
        return False
    count = max(int((end - half - (start + half)) / 0.25), 1)
    spread = [start + half + (end - start - 2 * half) * k / count for k in range(count + 1)]
    for t in dice.shuffled(spread):
        t = round(t, 3)
        base = site.spot_at_wall(stand, side, t)
        if not site.fits(stand, base, front=0.5, access=True) or not _screen_fits(
            site, side, t, base, stand, television
        ):
            continue
        far = across - couch.depth / 2 - 0.03
        near = stand.depth + 1.9 + couch.depth / 2
        distances = (
            [far] if across < 5.2 else [round(min(near + dice.uniform(0.2, 0.8), far), 3), far]
        )
        for distance in distances:
            if distance < near - 0.25:
                continue
            spot = _facing_spot(site, side, t, distance)
            if not site.fits(couch, spot, access=True):
                continue
            site.put(stand, base, front=0.5, access=True)
            piece = site.put(couch, spot, access=False)
            _mount(site, side, t, base, television, wall_mounted)
            put_cushions(site, piece)
            furnish_around(site, piece)
            return True
    return False


def _screen_fits(
    site: Site, side: str, t: float, base: Spot, stand: Model, television: Model
) -> bool:
    """Whether a television on its stand, or on the wall above, would cover no window."""
    mounted = site.spot_at_wall(television, side, t, 0.004, 0.95)
    standing = Spot(base.x, base.y, base.yaw_deg, stand.height)
    return site.fits(television, mounted, in_clear=True) or site.fits(
        television, standing, in_clear=True
    )


def _facing_spot(site: Site, side: str, t: float, distance: float) -> Spot:
    """A spot at a distance from a wall that faces it."""
    _, _, plane = site.wall_line(side)
    dx, dy = _ALONG[side]
    yaw = {"south": 180.0, "north": 0.0, "west": 90.0, "east": -90.0}[side]
    if side in ("south", "north"):
        return Spot(t, plane + dy * distance, yaw)
    return Spot(plane + dx * distance, t, yaw)


def _mount(
    site: Site, side: str, t: float, base: Spot, television: Model, wall_mounted: bool
) -> None:
    carrier = next(p for p in site.placed if p.x == base.x and p.y == base.y)
    if wall_mounted:
        spot = site.spot_at_wall(television, side, t, 0.004, 0.95)
        if site.fits(television, spot, in_clear=True):
            site.put(television, spot)
            scatter(
                site,
                carrier,
                (
                    plants.small_plant,
                    ornaments.books,
                    electronics.speaker_small,
                    electronics.game_console,
                ),
                2,
            )
            return
        television = screens.tv(site.dice, site.taste)
    site.on_top(carrier, television, facing=0.0, where=(0.5, 0.4))
    scatter(
        site,
        carrier,
        (plants.small_plant, ornaments.books, ornaments.candle, electronics.game_console),
        1,
    )
