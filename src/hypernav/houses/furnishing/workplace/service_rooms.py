"""Furnishing of service rooms: pantry, restrooms, copy, storage and server rooms, corridors."""

from hypernav.houses.furnishing.dining_room import place_dining
from hypernav.houses.furnishing.kitchen import place_units
from hypernav.houses.furnishing.rugs_and_plants import place_plants
from hypernav.houses.furnishing.set_dressing import scatter, stand_some
from hypernav.houses.objects.belongings import household, luggage_and_tools
from hypernav.houses.objects.decor import plants, wall_decor
from hypernav.houses.objects.devices import electronics
from hypernav.houses.objects.furniture import cabinets, shelves, stools
from hypernav.houses.objects.kitchen_and_bathroom import sanitary, small_appliances
from hypernav.houses.objects.workplace import boards, machines, office_furniture
from hypernav.houses.placement.model_pose import SIDES
from hypernav.houses.placement.room_layout import RoomLayout


def furnish_pantry(layout: RoomLayout) -> None:
    """Furnish with kitchen units, a coffee machine, tables to eat at, machines."""
    rng, palette = layout.rng, layout.palette
    place_units(layout)
    base = next(
        (p for p in layout.placed if p.model.category == "kitchen cabinet" and not p.z), None
    )
    scatter(layout, base, (small_appliances.coffee_machine, small_appliances.microwave), 2)
    for _ in range(1 + (layout.inner.area > 22.0)):
        place_dining(layout, seats=rng.choice((2, 4, 4)))
    for maker, chance in rng.shuffled(
        (
            (machines.water_dispenser, 0.7),
            (machines.vending_machine, 0.4),
            (household.trash_can, 0.9),
            (shelves.wine_rack, 0.05),
        )
    ):
        if rng.chance(chance):
            layout.place_at_wall(maker(rng, palette), where="corner")
    if rng.chance(0.4):
        layout.hang_on_wall(boards.notice_board(rng, palette), sides=SIDES, z=1.0)
    if rng.chance(0.4):
        place_plants(layout, 1)


def furnish_restroom(layout: RoomLayout) -> None:
    """Furnish with toilets, basins with mirrors, soap and a bin."""
    rng, palette = layout.rng, layout.palette
    toilet, basin = sanitary.toilet(rng, palette), sanitary.bathroom_sink(rng, palette)
    pairs = 2 if layout.inner.area > 8.5 else 1
    for _ in range(pairs):
        layout.place_at_wall(toilet, front=0.55, access=True, where="corner")
    for _ in range(pairs):
        for _ in range(3):
            piece = layout.place_at_wall(basin, front=0.55, access=True)
            if piece is not None:
                layout.hang_on_wall(
                    wall_decor.mirror(rng, palette), sides=SIDES, z=1.15, near=piece
                )
                scatter(layout, piece, (household.soap_dispenser,), 1)
                break
    layout.hang_on_wall(wall_decor.toilet_paper(rng, palette), sides=SIDES, z=0.65)
    layout.place_at_wall(household.trash_can(rng, palette), where="corner")
    for maker, chance in ((household.toilet_brush, 0.6), (plants.leafy_plant, 0.2)):
        if rng.chance(chance):
            layout.place_at_wall(maker(rng, palette), where="corner")


def furnish_copy_room(layout: RoomLayout) -> None:
    """Furnish with a copier, a printer on a cabinet, paper, a shredder."""
    rng, palette = layout.rng, layout.palette
    for _ in range(3):
        if layout.place_at_wall(machines.copier(rng, palette), front=0.7, access=True) is not None:
            break
    base = layout.place_at_wall(cabinets.filing_cabinet(rng, palette), front=0.5, access=True)
    if base is not None:
        layout.place_on_top(base, electronics.printer(rng, palette), facing=0.0)
    for maker, chance in rng.shuffled(
        (
            (shelves.metal_shelf, 0.8),
            (machines.paper_shredder, 0.7),
            (household.trash_can, 0.7),
            (luggage_and_tools.cardboard_boxes, 0.6),
        )
    ):
        if rng.chance(chance):
            layout.place_at_wall(maker(rng, palette), where="corner")
    if rng.chance(0.5):
        layout.hang_on_wall(boards.notice_board(rng, palette), sides=SIDES, z=1.0)


def furnish_storage(layout: RoomLayout) -> None:
    """Furnish with racks along the walls, boxes, and what the cleaners need."""
    rng, palette = layout.rng, layout.palette
    rack = shelves.metal_shelf(rng, palette)
    for _ in range(max(int(layout.inner.area / 3.5), 1)):
        layout.place_at_wall(rack, front=0.5, access=True)
    stand_some(
        layout,
        rng.shuffled(
            (
                (luggage_and_tools.cardboard_boxes, 0.9),
                (office_furniture.locker, 0.4),
                (electronics.vacuum_cleaner, 0.6),
                (luggage_and_tools.ladder, 0.5),
                (luggage_and_tools.toolbox, 0.5),
                (household.broom, 0.6),
                (household.bucket, 0.6),
            )
        ),
        corner_chance=0.6,
    )


def furnish_server_room(layout: RoomLayout) -> None:
    """Furnish with racks of computers side by side."""
    rng, palette = layout.rng, layout.palette
    rack = machines.server_rack(rng, palette)
    for _ in range(max(int(layout.inner.area / 4.0), 2)):
        layout.place_at_wall(rack, front=0.7, access=True, where="corner")
    for maker, chance in (
        (luggage_and_tools.cardboard_boxes, 0.5),
        (luggage_and_tools.fire_extinguisher, 0.8),
        (stools.stool, 0.3),
    ):
        if rng.chance(chance):
            layout.place_at_wall(maker(rng, palette), where="corner")


def furnish_corridor(layout: RoomLayout) -> None:
    """Furnish a corridor with what leaves it open: boards, plants, extinguishers, a bench."""
    rng, palette = layout.rng, layout.palette
    long = max(layout.inner.width, layout.inner.depth)
    for _ in range(1 + int(long / 15.0)):
        layout.place_at_wall(luggage_and_tools.fire_extinguisher(rng, palette))
    for maker, chance in rng.shuffled(
        (
            (machines.water_dispenser, 0.35),
            (machines.copier, 0.15),
            (stools.bench_seat, 0.3),
            (plants.snake_plant, 0.5),
            (plants.leafy_plant, 0.4),
            (office_furniture.locker, 0.2),
            (machines.vending_machine, 0.12),
            (household.trash_can, 0.3),
        )
    ):
        if rng.chance(chance):
            layout.place_at_wall(maker(rng, palette), access=True)
    for maker, chance in ((boards.notice_board, 0.6), (wall_decor.clock, 0.4)):
        if rng.chance(chance):
            model = maker(rng, palette)
            layout.hang_on_wall(model, sides=SIDES, z=round(1.5 - model.height / 2, 3))
