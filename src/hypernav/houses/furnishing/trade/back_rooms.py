"""Furnishing of stock rooms, fitting rooms and arcades."""

from hypernav.houses.furnishing.rugs_and_plants import place_plants
from hypernav.houses.furnishing.set_dressing import stand_some
from hypernav.houses.furnishing.trade.aisles import line_walls, place_aisles
from hypernav.houses.furnishing.trade.sales_halls import place_tables
from hypernav.houses.objects.belongings import household, luggage_and_tools
from hypernav.houses.objects.decor import plants, wall_decor
from hypernav.houses.objects.furniture import shelves, stools
from hypernav.houses.objects.shop import shelving
from hypernav.houses.objects.workplace import machines
from hypernav.houses.placement.model_pose import SIDES
from hypernav.houses.placement.room_layout import RoomLayout


def furnish_stock_room(layout: RoomLayout) -> None:
    """Furnish with racks along the walls and in rows, boxes, a ladder."""
    rng, palette = layout.rng, layout.palette
    line_walls(
        layout, [shelves.metal_shelf(rng, palette) for _ in range(3)], rng.shuffled(SIDES)[:2]
    )
    zone = layout.inner.grown(-1.4)
    if min(zone.width, zone.depth) > 0.8:
        place_aisles(layout, [shelving.pallet_rack(rng, palette)], zone, 1.5)
    stand_some(
        layout,
        rng.shuffled(
            (
                (luggage_and_tools.cardboard_boxes, 1.0),
                (luggage_and_tools.cardboard_boxes, 0.6),
                (luggage_and_tools.ladder, 0.6),
                (luggage_and_tools.toolbox, 0.4),
                (household.broom, 0.6),
                (household.bucket, 0.5),
            )
        ),
        corner_chance=0.6,
    )


def furnish_fitting_room(layout: RoomLayout) -> None:
    """Furnish with a mirror, hooks and a stool."""
    rng, palette = layout.rng, layout.palette
    layout.hang_on_wall(wall_decor.mirror(rng, palette), sides=SIDES, z=0.8)
    layout.hang_on_wall(wall_decor.wall_hooks(rng, palette), sides=SIDES, z=1.4)
    layout.place_at_wall(stools.stool(rng, palette), where="corner")


def furnish_arcade(layout: RoomLayout) -> None:
    """Furnish with benches and plants in the middle, machines and bins at the sides."""
    rng, palette = layout.rng, layout.palette
    long = max(layout.inner.width, layout.inner.depth)
    middle = [stools.bench_seat(rng, palette), plants.indoor_tree(rng, palette)]
    place_tables(layout, middle, 1 + int(long / 6.0))
    for maker, most in (
        (machines.vending_machine, 2),
        (household.trash_can, 3),
        (luggage_and_tools.fire_extinguisher, 2),
        (plants.leafy_plant, 2),
    ):
        for _ in range(rng.integer(1, most)):
            layout.place_at_wall(maker(rng, palette))
    place_plants(layout, 1)
