"""Kitchens: a row of fitted units along one wall, perhaps around a corner."""

from hypernav.houses.assembly import Placed
from hypernav.houses.furnish.dining import place_dining
from hypernav.houses.furnish.dressing import scatter
from hypernav.houses.furnish.floor_things import place_plants
from hypernav.houses.furnish.site import Site
from hypernav.houses.furnish.spots import SIDES, Spot
from hypernav.houses.furniture.belongings import household
from hypernav.houses.furniture.decor import plants
from hypernav.houses.furniture.devices import electronics, gadgets
from hypernav.houses.furniture.kitchen_and_bath import appliances, kitchen, laundry, tableware
from hypernav.houses.furniture.seating_and_storage import desks, shelves, stools
from hypernav.houses.kit.model import Model

_ON_COUNTER = (
    gadgets.microwave,
    gadgets.toaster,
    gadgets.kettle,
    gadgets.coffee_machine,
    gadgets.blender,
    tableware.knife_block,
    tableware.fruit_bowl,
    tableware.bottle,
    tableware.cutting_board,
    tableware.paper_towels,
    plants.small_plant,
    tableware.cup,
)


def furnish_kitchen(site: Site, *, table: bool, island: bool = True) -> None:
    """Units, appliances, a table if nobody else has one, a bin, a plant.

    Args:
        site: The room.
        table: Whether a dining table belongs here.
        island: Whether a free-standing worktop may.
    """
    dice, taste = site.dice, site.taste
    place_units(site)
    if table and min(site.inner.width, site.inner.depth) > 2.4:
        place_dining(site, seats=dice.choice((2, 4)))
    elif island and min(site.inner.width, site.inner.depth) > 3.2 and dice.chance(0.7):
        _island(site)
    for maker, chance in dice.shuffled(
        (
            (household.trash_can, 0.8),
            (shelves.wine_rack, 0.25),
            (stools.stool, 0.2),
            (household.broom, 0.15),
        )
    ):
        if dice.chance(chance):
            site.at_wall(maker(dice, taste), where="corner")
    if dice.chance(0.5):
        place_plants(site, 1)


def _island(site: Site) -> None:
    dice, taste = site.dice, site.taste
    model = desks.kitchen_island(dice, taste)
    x, y = site.inner.centre
    for yaw in dice.shuffled((0.0, 90.0, 180.0, -90.0)):
        spot = Spot(x, y, yaw)
        if site.fits(model, spot, access=True):
            piece = site.put(model, spot)
            scatter(site, piece, (tableware.fruit_bowl, plants.flower_vase, tableware.bottle), 2)
            return


def place_units(site: Site, shortest: float = 2.2) -> bool:
    """Fitted units along the wall that has most room for them; False if there is none."""
    best: tuple[float, str, float, float] | None = None
    for side in site.dice.shuffled(SIDES):
        for start, end in _runs(site, side):
            length = min(end - start, 4.3)
            score = length + 0.3 * site.dice.unit()
            if length >= shortest and (best is None or score > best[0]):
                best = (score, side, start, end)
    if best is None:
        return False
    _, side, start, end = best
    _fill_row(site, side, start, end)
    if site.room.kind == "kitchen" and site.inner.area > 11.0:
        _second_row(site, side)
    return True


def _second_row(site: Site, first: str) -> None:
    """More cabinets along another wall."""
    dice, taste = site.dice, site.taste
    for side in dice.shuffled([s for s in SIDES if s != first]):
        for start, end in _runs(site, side):
            if end - start < 1.3:
                continue
            top = appliances.worktop(dice, taste)
            widths = [0.8] * min(int((end - start - 0.02) / 0.802), 3)
            models = [kitchen.kitchen_cabinet(dice, taste, w, top) for w in widths]
            for model, spot in _row(site, side, models, start, end, low=dice.chance(0.5)):
                piece = site.put(model, spot)
                _above(site, side, piece, None)
                _on_counter(site, piece)
            _reserve_front(site, side, start, end)
            return


def _runs(site: Site, side: str) -> list[tuple[float, float]]:
    """Stretches of a wall where a worktop can stand."""
    start, end, _ = site.wall_line(side)
    probe = kitchen_probe()
    step = 0.05
    runs: list[tuple[float, float]] = []
    t, begin = start + probe.width / 2 + 0.005, None
    while t <= end - probe.width / 2:
        free = site.fits(probe, site.spot_at_wall(probe, side, round(t, 3)), front=0.9, floor=False)
        if free and begin is None:
            begin = t - probe.width / 2
        if not free and begin is not None:
            runs.append((begin, t - step + probe.width / 2))
            begin = None
        t += step
    if begin is not None:
        runs.append((begin, t - step + probe.width / 2))
    return runs


def kitchen_probe() -> Model:
    """An invisible unit, to feel for room."""
    return Model((), "probe", low=(-0.05, -0.3, 0.0), high=(0.05, 0.3, 0.94))


def _fill_row(site: Site, side: str, start: float, end: float) -> None:
    """Fridge at one end, then sink, dishwasher, oven and cabinets, with wall units above."""
    dice, taste = site.dice, site.taste
    top = appliances.worktop(dice, taste)
    fridge = appliances.refrigerator(dice, taste)
    units = [kitchen.kitchen_sink(dice, taste, top), appliances.oven(dice, taste)]
    left = end - start - fridge.width - 0.8 - 0.6 - 0.08
    if left > 0.62 and dice.chance(0.7):
        units.append(appliances.dishwasher(dice, taste))
        left -= 0.6
    for _ in range(3):
        if left > 0.42:
            wide = min(dice.choice((0.4, 0.5, 0.6, 0.8)), round(left - 0.02, 2))
            units.append(kitchen.kitchen_cabinet(dice, taste, wide, top))
            left -= wide
    best: list[tuple[Model, Spot]] = []
    for attempt in range(10):
        order = dice.shuffled(units)
        row = _row(
            site,
            side,
            [fridge, *order] if attempt % 2 else [*order, fridge],
            start,
            end,
            low=attempt % 4 < 2,
        )
        if len(row) > len(best):
            best = row
        if len(row) == len(units) + 1:
            break
    for model, spot in best:
        piece = site.put(model, spot)
        _above(site, side, piece, fridge)
        _on_counter(site, piece)
    _reserve_front(site, side, start, end)
    if all(model is not fridge for model, _ in best):
        site.at_wall(fridge, front=0.7, access=True, where="corner")


def _row(
    site: Site, side: str, models: list[Model], start: float, end: float, *, low: bool
) -> list[tuple[Model, Spot]]:
    """Where the units of a row would stand, from one end on; without those that can't."""
    total = sum(m.width for m in models) + 0.002 * len(models)
    at = start + 0.01 if low else max(end - total - 0.01, start + 0.01)
    result = []
    for model in models:
        spot = site.spot_at_wall(model, side, at + model.width / 2)
        at += model.width + 0.002
        if at < end + 0.01 and site.fits(model, spot, tight=True):
            result.append((model, spot))
    return result


def _reserve_front(site: Site, side: str, start: float, end: float) -> None:
    probe = Model(
        (), "probe", low=(-(end - start) / 2, -0.3, 0.0), high=((end - start) / 2, 0.3, 0.9)
    )
    spot = site.spot_at_wall(probe, side, (start + end) / 2)
    site.reserve(site.front_zone(probe, spot, 0.85))


def _above(site: Site, side: str, piece: Placed, fridge: Model | None) -> None:
    dice, taste = site.dice, site.taste
    if piece.model is fridge:
        return
    along = piece.x if side in ("south", "north") else piece.y
    if piece.model.category == "oven":
        hood = appliances.range_hood(dice, taste)
        spot = site.spot_at_wall(hood, side, along, 0.004, 1.6)
        if site.fits(hood, spot, in_clear=True, tight=True):
            site.put(hood, spot)
        return
    unit = kitchen.wall_cabinet(dice, taste, round(piece.model.width - 0.004, 3))
    spot = site.spot_at_wall(unit, side, along, 0.004, 1.45)
    if dice.chance(0.9) and site.fits(unit, spot, in_clear=True, tight=True):
        site.put(unit, spot)


def _on_counter(site: Site, piece: Placed) -> None:
    if piece.model.category == "oven":
        if site.dice.chance(0.7):
            site.on_top(piece, tableware.pot(site.dice, site.taste))
        return
    if piece.model.category in ("kitchen cabinet", "dishwasher"):
        used = {p.model.category for p in site.placed}
        makers = [m for m in _ON_COUNTER if m.__name__.replace("_", " ") not in used]
        scatter(site, piece, makers, site.dice.integer(1, 3))


def furnish_laundry(site: Site) -> None:
    """Washing machine and dryer side by side, then racks and baskets."""
    dice, taste = site.dice, site.taste
    washer = site.at_wall(
        laundry.washing_machine(dice, taste), front=0.7, access=True, where="corner"
    )
    scatter(site, washer, (household.detergent,), 1)
    dryer = site.at_wall(laundry.clothes_dryer(dice, taste), front=0.7, access=True, where="corner")
    scatter(site, dryer, (household.detergent, household.basket), 1)
    for maker, chance in (
        (laundry.laundry_basket, 0.9),
        (laundry.ironing_board, 0.5),
        (laundry.drying_rack, 0.5),
        (shelves.metal_shelf, 0.4),
        (household.bucket, 0.5),
        (household.broom, 0.5),
        (electronics.vacuum_cleaner, 0.3),
    ):
        if dice.chance(chance):
            site.at_wall(maker(dice, taste), where="corner" if dice.chance(0.5) else "any")
