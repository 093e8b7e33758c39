"""Living and dining rooms."""

from hypernav.worlds.houses.assembly import Placed
from hypernav.worlds.houses.furnish.dressing import scatter
from hypernav.worlds.houses.furnish.site import SIDES, Site, Spot, footprint, turned_point
from hypernav.worlds.houses.furniture import (
    chairs,
    electronics,
    leisure,
    lighting,
    plants,
    screens,
    small,
    sofas,
    storage,
    tables,
    textiles,
)
from hypernav.worlds.houses.kit.model import Model

_ALONG = {"south": (0.0, 1.0), "north": (0.0, -1.0), "west": (1.0, 0.0), "east": (-1.0, 0.0)}


def furnish_living(site: Site, *, with_dining: bool, with_kitchen: bool) -> None:
    """A seating group around a television, then what else fits."""
    del with_kitchen
    dice, taste = site.dice, site.taste
    _seating_group(site)
    if with_dining:
        place_dining(site, seats=dice.choice((4, 4, 6)))
    for maker, chance in dice.shuffled(
        (
            (storage.bookshelf, 0.7),
            (storage.cabinet, 0.35),
            (storage.display_cabinet, 0.25),
            (leisure.piano, 0.25),
            (leisure.fireplace, 0.3),
            (storage.dresser, 0.1),
        )
    ):
        if dice.chance(chance):
            piece = site.at_wall(maker(dice, taste), front=0.45, access=True)
            scatter(
                site,
                piece,
                (plants.flower_vase, small.photo_frame, small.candle, small.globe, small.clock),
                2,
            )
    for maker, chance in dice.shuffled(
        (
            (lighting.floor_lamp, 0.7),
            (sofas.bean_bag, 0.2),
            (chairs.rocking_chair, 0.15),
            (chairs.ottoman, 0.3),
            (leisure.guitar, 0.2),
            (electronics.fan, 0.2),
            (leisure.cat_tree, 0.12),
            (leisure.pet_bed, 0.15),
            (electronics.speaker, 0.3),
            (small.basket, 0.2),
            (leisure.fish_tank, 0.12),
            (leisure.toy_box, 0.1),
        )
    ):
        if dice.chance(chance):
            site.at_wall(maker(dice, taste), where="corner")
    place_plants(site, dice.integer(1, 3))


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


def _seating_group(site: Site) -> None:
    """Television at one wall, sofa opposite, coffee table and rug between, armchairs at the side."""
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
        _cushions(site, piece)
    for _ in range(4):
        base = site.at_wall(stand, front=0.6, access=True)
        if base is None:
            break
        if site.on_top(base, television, facing=0.0, where=(0.5, 0.4)) is not None:
            return
        site.remove(base)
    site.on_wall(screens.wall_tv(dice, taste), sides=SIDES, z=1.0)


def _television(site: Site) -> tuple[Model, Model, bool]:
    stand = storage.tv_stand(site.dice, site.taste)
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
            _cushions(site, piece)
            _around_sofa(site, piece, side)
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
                    small.books,
                    electronics.speaker_small,
                    electronics.game_console,
                ),
                2,
            )
            return
        television = screens.tv(site.dice, site.taste)
    site.on_top(carrier, television, facing=0.0, where=(0.5, 0.4))
    scatter(
        site, carrier, (plants.small_plant, small.books, small.candle, electronics.game_console), 1
    )


def _cushions(site: Site, couch: Placed) -> None:
    """One or two cushions in the sofa's corners."""
    model = couch.model
    if model.width < 1.2 or site.dice.chance(0.25):
        return
    back = model.low[1] + 0.33
    for s in (-1.0, 1.0):
        if site.dice.chance(0.7):
            cushion = textiles.sofa_cushion(site.dice, site.taste)
            x, y = turned_point(s * (model.width / 2 - 0.42), back, couch.yaw_deg)
            site.put(cushion, Spot(couch.x + x, couch.y + y, couch.yaw_deg, 0.46), on_top=True)


def _around_sofa(site: Site, couch: Placed, tv_side: str) -> None:
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
                    small.books,
                    plants.flower_vase,
                    plants.small_plant,
                    small.bowl,
                    small.cup,
                    small.remote,
                    small.candle,
                    small.magazine,
                ),
                dice.integer(1, 3),
            )
    if dice.chance(0.75):
        rug = textiles.rug(dice, taste)
        dx, dy = turned_point(0.0, front + 0.5, couch.yaw_deg)
        put_rug(site, rug, Spot(couch.x + dx, couch.y + dy, couch.yaw_deg))
    for s in dice.shuffled((-1.0, 1.0)):
        if dice.chance(0.6):
            seat = dice.weighted(((sofas.armchair, 4.0), (chairs.ottoman, 0.5)))(dice, taste)
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
            scatter(site, piece, (small.books, small.cup, electronics.phone), 1)
    del tv_side


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
    scatter(site, table, (plants.flower_vase, small.fruit_bowl, small.candle), 1)
    if dice.chance(0.5):
        scatter(site, table, [small.plate] * min(seats, 4) + [small.cup] * 2, 5)
    else:
        scatter(site, table, (small.cup, small.books, small.bottle, small.bowl), dice.integer(1, 3))


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
    for maker in dice.shuffled((storage.cabinet, storage.display_cabinet, storage.wine_rack))[:2]:
        base = site.at_wall(maker(dice, taste), front=0.4, access=True)
        scatter(
            site, base, (plants.flower_vase, small.photo_frame, lighting.table_lamp, small.bowl), 2
        )
    place_plants(site, dice.integer(1, 2))
