"""Living rooms."""

from hypernav.houses.furnish.dining import place_dining
from hypernav.houses.furnish.dressing import scatter
from hypernav.houses.furnish.floor_things import place_plants
from hypernav.houses.furnish.seating import place_seating_group
from hypernav.houses.furnish.site import Site
from hypernav.houses.furniture.belongings import household, pastime, pets, toys
from hypernav.houses.furniture.decor import ornaments, plants
from hypernav.houses.furniture.devices import electronics, lighting
from hypernav.houses.furniture.seating_and_storage import cabinets, chairs, shelves, sofas, stools


def furnish_living(site: Site, *, with_dining: bool) -> None:
    """A seating group around a television, then what else fits."""
    dice, taste = site.dice, site.taste
    place_seating_group(site)
    if with_dining:
        place_dining(site, seats=dice.choice((4, 4, 6)))
    for maker, chance in dice.shuffled(
        (
            (shelves.bookshelf, 0.7),
            (cabinets.cabinet, 0.35),
            (cabinets.display_cabinet, 0.25),
            (pastime.piano, 0.25),
            (pastime.fireplace, 0.3),
            (cabinets.dresser, 0.1),
        )
    ):
        if dice.chance(chance):
            piece = site.at_wall(maker(dice, taste), front=0.45, access=True)
            scatter(
                site,
                piece,
                (
                    plants.flower_vase,
                    ornaments.photo_frame,
                    ornaments.candle,
                    ornaments.globe,
                    ornaments.clock,
                ),
                2,
            )
    for maker, chance in dice.shuffled(
        (
            (lighting.floor_lamp, 0.7),
            (sofas.bean_bag, 0.2),
            (chairs.rocking_chair, 0.15),
            (stools.ottoman, 0.3),
            (pastime.guitar, 0.2),
            (electronics.fan, 0.2),
            (pets.cat_tree, 0.12),
            (pets.pet_bed, 0.15),
            (electronics.speaker, 0.3),
            (household.basket, 0.2),
            (pets.fish_tank, 0.12),
            (toys.toy_box, 0.1),
        )
    ):
        if dice.chance(chance):
            site.at_wall(maker(dice, taste), where="corner")
    place_plants(site, dice.integer(1, 3))
