"""Halls, storage rooms and balconies."""

from hypernav.houses.furnish.dressing import scatter
from hypernav.houses.furnish.floor_things import put_rug
from hypernav.houses.furnish.site import Site
from hypernav.houses.furnish.spots import SIDES, Spot, turned_point
from hypernav.houses.furniture.belongings import belongings, household, pets, sport
from hypernav.houses.furniture.decor import ornaments, plants, textiles, walls
from hypernav.houses.furniture.devices import electronics, lighting
from hypernav.houses.furniture.kitchen_and_bath import laundry, tableware
from hypernav.houses.furniture.seating_and_storage import desks, shelves, stools


def furnish_hall(site: Site) -> None:
    """Shoes, coats, a table with a mirror, a runner; narrow halls stay nearly empty."""
    dice, taste = site.dice, site.taste
    base = site.at_wall(desks.console_table(dice, taste), access=True) if dice.chance(0.6) else None
    if base is not None:
        scatter(
            site,
            base,
            (
                plants.flower_vase,
                tableware.bowl,
                lighting.table_lamp,
                ornaments.photo_frame,
                belongings.handbag,
            ),
            2,
        )
        site.on_wall(walls.mirror(dice, taste), sides=SIDES, z=1.15, near=base)
    for maker, chance in dice.shuffled(
        (
            (shelves.shoe_rack, 0.6),
            (shelves.coat_rack, 0.45),
            (belongings.umbrella, 0.6),
            (stools.bench_seat, 0.2),
            (belongings.shoes, 0.4),
            (plants.snake_plant, 0.25),
            (belongings.suitcase, 0.12),
            (belongings.fire_extinguisher, 0.08),
            (belongings.backpack, 0.2),
            (sport.skateboard, 0.08),
            (sport.football, 0.08),
        )
    ):
        if dice.chance(chance):
            site.at_wall(maker(dice, taste), where="corner" if dice.chance(0.5) else "any")
    if dice.chance(0.5):
        site.on_wall(walls.wall_hooks(dice, taste), sides=SIDES, z=1.3)
    if dice.chance(0.5):
        x, y = site.inner.centre
        put_rug(
            site,
            textiles.runner(dice, taste),
            Spot(x, y, 0.0 if site.inner.width > site.inner.depth else 90.0),
        )
    for opening in site.openings:
        if opening.kind == "entrance":
            inside = 0.42 if opening.rooms[1] == site.number else -0.42
            mid = opening.strip(inside - 0.01, inside + 0.01).centre
            put_rug(
                site,
                textiles.doormat(dice, taste),
                Spot(*mid, 0.0 if opening.along == "x" else 90.0),
            )


def furnish_storage(site: Site) -> None:
    """Racks, boxes and what has no other place."""
    dice, taste = site.dice, site.taste
    site.at_wall(shelves.metal_shelf(dice, taste), access=True)
    if dice.chance(0.5):
        site.at_wall(shelves.metal_shelf(dice, taste), access=True)
    for maker, chance in dice.shuffled(
        (
            (belongings.cardboard_boxes, 0.9),
            (electronics.vacuum_cleaner, 0.6),
            (belongings.ladder, 0.5),
            (belongings.toolbox, 0.5),
            (belongings.suitcase, 0.5),
            (household.broom, 0.5),
            (household.bucket, 0.4),
            (sport.bicycle, 0.2),
            (sport.skateboard, 0.15),
            (laundry.ironing_board, 0.25),
            (pets.bird_cage, 0.05),
        )
    ):
        if dice.chance(chance):
            site.at_wall(maker(dice, taste), where="corner" if dice.chance(0.6) else "any")


def furnish_balcony(site: Site) -> None:
    """A small table with chairs, planters, perhaps a bicycle."""
    dice, taste = site.dice, site.taste
    table = (
        site.at_wall(desks.folding_table(dice, taste), where="corner", gap=0.08)
        if dice.chance(0.7)
        else None
    )
    if table is not None:
        scatter(site, table, (plants.small_plant, tableware.cup, ornaments.candle), 2)
        chair = belongings.folding_chair(dice, taste)
        for turn in (90.0, -90.0, 0.0, 180.0):
            dx, dy = turned_point(0.0, 0.5, table.yaw_deg + turn)
            spot = Spot(table.x + dx, table.y + dy, table.yaw_deg + turn + 180.0)
            if site.fits(chair, spot):
                site.put(chair, spot)
    for maker, chance in dice.shuffled(
        (
            (plants.hedge_box, 0.7),
            (plants.leafy_plant, 0.5),
            (sport.bicycle, 0.25),
            (laundry.drying_rack, 0.25),
            (belongings.watering_can, 0.5),
            (plants.snake_plant, 0.3),
        )
    ):
        if dice.chance(chance):
            site.at_wall(
                maker(dice, taste), where="corner" if dice.chance(0.5) else "any", gap=0.05
            )
