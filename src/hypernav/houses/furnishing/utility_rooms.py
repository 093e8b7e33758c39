"""Furnishing of halls, laundries, storage rooms and balconies."""

from hypernav.houses.furnishing.rugs_and_plants import place_rug
from hypernav.houses.furnishing.set_dressing import scatter, stand_some
from hypernav.houses.objects.belongings import household, luggage_and_tools, pets, sports
from hypernav.houses.objects.decor import ornaments, plants, textiles, wall_decor
from hypernav.houses.objects.devices import electronics, lighting
from hypernav.houses.objects.furniture import desks, shelves, stools
from hypernav.houses.objects.kitchen_and_bathroom import laundry, tableware
from hypernav.houses.placement.model_pose import SIDES, ModelPose, turned_point
from hypernav.houses.placement.room_layout import RoomLayout


def furnish_hall(layout: RoomLayout) -> None:
    """Furnish with shoes, coats, a console table with a mirror, a runner, as far as they fit."""
    rng, palette = layout.rng, layout.palette
    base = (
        layout.place_at_wall(desks.console_table(rng, palette), access=True)
        if rng.chance(0.6)
        else None
    )
    if base is not None:
        scatter(
            layout,
            base,
            (
                plants.flower_vase,
                tableware.bowl,
                lighting.table_lamp,
                ornaments.photo_frame,
                luggage_and_tools.handbag,
            ),
            2,
        )
        layout.hang_on_wall(wall_decor.mirror(rng, palette), sides=SIDES, z=1.15, near=base)
    stand_some(
        layout,
        rng.shuffled(
            (
                (shelves.shoe_rack, 0.6),
                (shelves.coat_rack, 0.45),
                (luggage_and_tools.umbrella, 0.6),
                (stools.bench_seat, 0.2),
                (luggage_and_tools.shoes, 0.4),
                (plants.snake_plant, 0.25),
                (luggage_and_tools.suitcase, 0.12),
                (luggage_and_tools.fire_extinguisher, 0.08),
                (luggage_and_tools.backpack, 0.2),
                (sports.skateboard, 0.08),
                (sports.football, 0.08),
            )
        ),
        corner_chance=0.5,
    )
    if rng.chance(0.5):
        layout.hang_on_wall(wall_decor.wall_hooks(rng, palette), sides=SIDES, z=1.3)
    if rng.chance(0.5):
        x, y = layout.inner.centre
        place_rug(
            layout,
            textiles.runner(rng, palette),
            ModelPose(x, y, 0.0 if layout.inner.width > layout.inner.depth else 90.0),
        )
    for opening in layout.openings:
        if opening.kind == "entrance":
            inside = 0.42 if opening.rooms[1] == layout.number else -0.42
            mid = opening.strip(inside - 0.01, inside + 0.01).centre
            place_rug(
                layout,
                textiles.doormat(rng, palette),
                ModelPose(*mid, 0.0 if opening.along == "x" else 90.0),
            )


def furnish_laundry(layout: RoomLayout) -> None:
    """Furnish with a washing machine, a dryer, racks and baskets."""
    rng, palette = layout.rng, layout.palette
    washer = layout.place_at_wall(
        laundry.washing_machine(rng, palette), front=0.7, access=True, where="corner"
    )
    scatter(layout, washer, (household.detergent,), 1)
    dryer = layout.place_at_wall(
        laundry.clothes_dryer(rng, palette), front=0.7, access=True, where="corner"
    )
    scatter(layout, dryer, (household.detergent, household.basket), 1)
    stand_some(
        layout,
        (
            (laundry.laundry_basket, 0.9),
            (laundry.ironing_board, 0.5),
            (laundry.drying_rack, 0.5),
            (shelves.metal_shelf, 0.4),
            (household.bucket, 0.5),
            (household.broom, 0.5),
            (electronics.vacuum_cleaner, 0.3),
        ),
        corner_chance=0.5,
    )


def furnish_storage(layout: RoomLayout) -> None:
    """Furnish with racks, boxes and household equipment."""
    rng, palette = layout.rng, layout.palette
    layout.place_at_wall(shelves.metal_shelf(rng, palette), access=True)
    if rng.chance(0.5):
        layout.place_at_wall(shelves.metal_shelf(rng, palette), access=True)
    stand_some(
        layout,
        rng.shuffled(
            (
                (luggage_and_tools.cardboard_boxes, 0.9),
                (electronics.vacuum_cleaner, 0.6),
                (luggage_and_tools.ladder, 0.5),
                (luggage_and_tools.toolbox, 0.5),
                (luggage_and_tools.suitcase, 0.5),
                (household.broom, 0.5),
                (household.bucket, 0.4),
                (sports.bicycle, 0.2),
                (sports.skateboard, 0.15),
                (laundry.ironing_board, 0.25),
                (pets.bird_cage, 0.05),
            )
        ),
        corner_chance=0.6,
    )


def furnish_balcony(layout: RoomLayout) -> None:
    """Furnish with a small table with chairs, planters, perhaps a bicycle."""
    rng, palette = layout.rng, layout.palette
    table = (
        layout.place_at_wall(desks.folding_table(rng, palette), where="corner", gap=0.08)
        if rng.chance(0.7)
        else None
    )
    if table is not None:
        scatter(layout, table, (plants.small_plant, tableware.cup, ornaments.candle), 2)
        chair = luggage_and_tools.folding_chair(rng, palette)
        for turn in (90.0, -90.0, 0.0, 180.0):
            dx, dy = turned_point(0.0, 0.5, table.yaw_deg + turn)
            pose = ModelPose(table.x + dx, table.y + dy, table.yaw_deg + turn + 180.0)
            if layout.fits(chair, pose):
                layout.place(chair, pose)
    for maker, chance in rng.shuffled(
        (
            (plants.hedge_box, 0.7),
            (plants.leafy_plant, 0.5),
            (sports.bicycle, 0.25),
            (laundry.drying_rack, 0.25),
            (luggage_and_tools.watering_can, 0.5),
            (plants.snake_plant, 0.3),
        )
    ):
        if rng.chance(chance):
            layout.place_at_wall(
                maker(rng, palette), where="corner" if rng.chance(0.5) else "any", gap=0.05
            )
