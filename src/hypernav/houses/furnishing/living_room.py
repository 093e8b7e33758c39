"""Furnishing of living rooms."""

from hypernav.houses.furnishing.dining_room import place_dining
from hypernav.houses.furnishing.rugs_and_plants import place_plants
from hypernav.houses.furnishing.seating_group import place_seating_group
from hypernav.houses.furnishing.set_dressing import scatter
from hypernav.houses.objects.belongings import household, leisure, pets, toys
from hypernav.houses.objects.decor import ornaments, plants
from hypernav.houses.objects.devices import electronics, lighting
from hypernav.houses.objects.furniture import cabinets, chairs, shelves, sofas, stools
from hypernav.houses.placement.room_layout import RoomLayout


def furnish_living_room(layout: RoomLayout, *, with_dining: bool) -> None:
    """Furnish with a seating group around a television, then with what fits."""
    rng, palette = layout.rng, layout.palette
    place_seating_group(layout)
    if with_dining:
        place_dining(layout, seats=rng.choice((4, 4, 6)))
    for maker, chance in rng.shuffled(
        (
            (shelves.bookshelf, 0.7),
            (cabinets.cabinet, 0.35),
            (cabinets.display_cabinet, 0.25),
            (leisure.piano, 0.25),
            (leisure.fireplace, 0.3),
            (cabinets.dresser, 0.1),
        )
    ):
        if rng.chance(chance):
            piece = layout.place_at_wall(maker(rng, palette), front=0.45, access=True)
            scatter(
                layout,
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
    for maker, chance in rng.shuffled(
        (
            (lighting.floor_lamp, 0.7),
            (sofas.bean_bag, 0.2),
            (chairs.rocking_chair, 0.15),
            (stools.ottoman, 0.3),
            (leisure.guitar, 0.2),
            (electronics.fan, 0.2),
            (pets.cat_tree, 0.12),
            (pets.pet_bed, 0.15),
            (electronics.speaker, 0.3),
            (household.basket, 0.2),
            (pets.fish_tank, 0.12),
            (toys.toy_box, 0.1),
        )
    ):
        if rng.chance(chance):
            layout.place_at_wall(maker(rng, palette), where="corner")
    place_plants(layout, rng.integer(1, 3))
