"""Furnishing of homes: which rooms get what, and of bathrooms, halls and other small rooms."""

from hypernav.simulator.houses.assembly import PlacedModel
from hypernav.simulator.houses.furnishing import (
    bedroom_and_study,
    kitchen_and_dining,
    living_room,
    set_dressing,
)
from hypernav.simulator.houses.furnishing.room_layout import ModelPose, RoomLayout, beside
from hypernav.simulator.houses.furnishing.rooms import Furnishing, RequiredGroups
from hypernav.simulator.houses.furnishing.set_dressing import place_rug, scatter, stand_some
from hypernav.simulator.houses.objects.belongings import (
    decor,
    devices,
    household,
    kitchenware,
    leisure,
    luggage_and_tools,
    plants,
    sports,
)
from hypernav.simulator.houses.objects.furniture import sanitary, seating, storage, tables
from hypernav.simulator.houses.plan.floor_plan import FloorPlan

_PICTURE_COUNTS = {
    "living room": 3,
    "bedroom": 2,
    "hall": 2,
    "dining room": 2,
    "office": 2,
    "kitchen": 1,
}

_REQUIRED: dict[str, RequiredGroups] = {
    "living room": (("sofa",), ("tv",), ("coffee table",)),
    "kitchen": (("refrigerator",), ("oven",), ("sink",)),
    "bathroom": (("toilet",), ("sink",), ("bathtub", "shower")),
    "bedroom": (("bed",), ("wardrobe", "dresser")),
    "dining room": (("dining table",), ("chair",)),
    "office": (("desk",), ("chair",)),
    "laundry": (("washing machine",),),
}
"""Categories that a kind of room must hold: at least one of each group."""


def furnish_bathroom(layout: RoomLayout, *, with_washer: bool) -> None:
    """Furnish with a toilet, a basin with mirror, a tub or shower, and towels.

    Args:
        layout: Layout of the room.
        with_washer: Whether the room gets a washing machine.
    """
    rng, palette = layout.rng, layout.palette
    big = layout.inner.area > 4.4
    tub = (
        layout.place_at_wall(sanitary.bathtub(rng, palette), where="corner", gap=0.012)
        if big and rng.chance(0.6)
        else None
    )
    if tub is None:
        layout.place_at_wall(sanitary.shower(rng, palette), where="corner", front=0.5, access=True)
    toilet = layout.place_at_wall(
        sanitary.toilet(rng, palette), front=0.55, access=True, where=rng.choice(("any", "corner"))
    )
    basin = None
    for _ in range(3):
        basin = layout.place_at_wall(sanitary.bathroom_sink(rng, palette), front=0.55, access=True)
        if basin is not None:
            break
    if tub is not None:
        _curtain(layout, tub)
    if basin is not None:
        mirror = decor.mirror(rng, palette)
        layout.hang_on_wall(mirror, z=1.15, near=basin)
        scatter(layout, basin, (household.soap_dispenser, household.toothbrush_cup), 2)
    if toilet is not None:
        small = (plants.small_plant, decor.candle, decor.folded_towels)
        scatter(layout, toilet, small, 1 if rng.chance(0.4) else 0)
    if with_washer:
        washer = layout.place_at_wall(
            household.washing_machine(rng, palette), front=0.55, access=True, where="corner"
        )
        scatter(layout, washer, (household.detergent, decor.folded_towels), 1)
    layout.hang_on_wall(decor.towel_rack(rng, palette), z=0.82)
    layout.hang_on_wall(decor.toilet_paper(rng, palette), z=0.65)
    things = (
        (household.trash_can, 0.6),
        (household.toilet_brush, 0.6),
        (household.laundry_basket, 0.35),
        (household.scale, 0.3),
        (storage.cabinet, 0.15),
        (plants.leafy_plant, 0.25),
    )
    stand_some(layout, things, corner_chance=0.6)
    mat = decor.bath_mat(rng, palette)
    host = tub or basin
    if host is not None:
        pose = beside(host, 0.0, host.model.depth / 2 + 0.3)
        if not layout.is_taken(mat, pose) and layout.fits(mat, pose, in_clear_zone=True):
            layout.place(mat, pose, flat=True)


def _curtain(layout: RoomLayout, tub: PlacedModel) -> None:
    model = decor.shower_curtain(layout.rng, layout.palette, round(tub.model.width - 0.04, 3))
    pose = beside(tub, 0.0, tub.model.depth / 2 + 0.06, z=0.25)
    if not layout.is_taken(model, pose):
        layout.place_if_fits(model, pose, in_clear_zone=True, tight=True)


def furnish_hall(layout: RoomLayout) -> None:
    """Furnish with shoes, coats, a console table with a mirror, a runner, as far as they fit."""
    rng, palette = layout.rng, layout.palette
    base = (
        layout.place_at_wall(tables.console_table(rng, palette), access=True)
        if rng.chance(0.6)
        else None
    )
    if base is not None:
        small = (
            plants.flower_vase,
            kitchenware.bowl,
            devices.table_lamp,
            decor.photo_frame,
            luggage_and_tools.handbag,
        )
        scatter(layout, base, small, 2)
        layout.hang_on_wall(decor.mirror(rng, palette), z=1.15, near=base)
    things = (
        (storage.shoe_rack, 0.6),
        (storage.coat_rack, 0.45),
        (luggage_and_tools.umbrella, 0.6),
        (seating.bench_seat, 0.2),
        (luggage_and_tools.shoes, 0.4),
        (plants.snake_plant, 0.25),
        (luggage_and_tools.suitcase, 0.12),
        (luggage_and_tools.fire_extinguisher, 0.08),
        (luggage_and_tools.backpack, 0.2),
        (sports.skateboard, 0.08),
        (sports.football, 0.08),
    )
    stand_some(layout, rng.shuffled(things), corner_chance=0.5)
    if rng.chance(0.5):
        layout.hang_on_wall(decor.wall_hooks(rng, palette), z=1.3)
    if rng.chance(0.5):
        x, y = layout.inner.centre
        place_rug(
            layout,
            decor.runner(rng, palette),
            ModelPose(x, y, 0.0 if layout.inner.width > layout.inner.depth else 90.0),
        )
    for opening in layout.openings:
        if opening.kind == "entrance":
            inside = 0.42 if opening.rooms[1] == layout.number else -0.42
            mid = opening.strip(inside - 0.01, inside + 0.01).centre
            place_rug(
                layout,
                decor.doormat(rng, palette),
                ModelPose(*mid, 0.0 if opening.along == "x" else 90.0),
            )


def furnish_laundry(layout: RoomLayout) -> None:
    """Furnish with a washing machine, a dryer, racks and baskets."""
    rng, palette = layout.rng, layout.palette
    washer = layout.place_at_wall(
        household.washing_machine(rng, palette), front=0.7, access=True, where="corner"
    )
    scatter(layout, washer, (household.detergent,), 1)
    dryer = layout.place_at_wall(
        household.clothes_dryer(rng, palette), front=0.7, access=True, where="corner"
    )
    scatter(layout, dryer, (household.detergent, household.basket), 1)
    things = (
        (household.laundry_basket, 0.9),
        (household.ironing_board, 0.5),
        (household.drying_rack, 0.5),
        (storage.metal_shelf, 0.4),
        (household.bucket, 0.5),
        (household.broom, 0.5),
        (devices.vacuum_cleaner, 0.3),
    )
    stand_some(layout, things, corner_chance=0.5)


def furnish_storage(layout: RoomLayout) -> None:
    """Furnish with racks, boxes and household equipment."""
    rng, palette = layout.rng, layout.palette
    layout.place_at_wall(storage.metal_shelf(rng, palette), access=True)
    if rng.chance(0.5):
        layout.place_at_wall(storage.metal_shelf(rng, palette), access=True)
    things = (
        (luggage_and_tools.cardboard_boxes, 0.9),
        (devices.vacuum_cleaner, 0.6),
        (luggage_and_tools.ladder, 0.5),
        (luggage_and_tools.toolbox, 0.5),
        (luggage_and_tools.suitcase, 0.5),
        (household.broom, 0.5),
        (household.bucket, 0.4),
        (sports.bicycle, 0.2),
        (sports.skateboard, 0.15),
        (household.ironing_board, 0.25),
        (leisure.bird_cage, 0.05),
    )
    stand_some(layout, rng.shuffled(things), corner_chance=0.6)


def furnish_balcony(layout: RoomLayout) -> None:
    """Furnish with a small table with chairs, planters, perhaps a bicycle."""
    rng, palette = layout.rng, layout.palette
    table = (
        layout.place_at_wall(tables.folding_table(rng, palette), where="corner", gap=0.08)
        if rng.chance(0.7)
        else None
    )
    if table is not None:
        scatter(layout, table, (plants.small_plant, kitchenware.cup, decor.candle), 2)
        chair = luggage_and_tools.folding_chair(rng, palette)
        for turn in (90.0, -90.0, 0.0, 180.0):
            side = ModelPose(table.x, table.y, table.yaw_deg + turn)
            layout.place_if_fits(chair, beside(side, 0.0, 0.5, 180.0))
    things = (
        (plants.hedge_box, 0.7),
        (plants.leafy_plant, 0.5),
        (sports.bicycle, 0.25),
        (household.drying_rack, 0.25),
        (luggage_and_tools.watering_can, 0.5),
        (plants.snake_plant, 0.3),
    )
    stand_some(layout, rng.shuffled(things), corner_chance=0.5, gap=0.05)


def _required(plan: FloorPlan, number: int) -> RequiredGroups:
    kind = plan.rooms[number].kind
    kinds = [room.kind for room in plan.rooms]
    required = _REQUIRED.get(kind, ())
    if (kind == "living room" and _dines_here(plan)) or (
        kind == "kitchen" and "dining room" not in kinds and _kitchen_is_large(plan)
    ):
        required = (*required, ("dining table",), ("chair",))
    return required


def _furnish(layout: RoomLayout) -> None:
    kind = layout.room.kind
    kinds = [room.kind for room in layout.plan.rooms]
    rng = layout.rng
    has_dining, has_kitchen = "dining room" in kinds, "kitchen" in kinds
    kitchen_table = not has_dining and has_kitchen and _kitchen_is_large(layout.plan)
    if kind == "living room":
        if not has_kitchen:
            kitchen_and_dining.place_units(layout)
        living_room.furnish_living_room(layout, with_dining=_dines_here(layout.plan))
    elif kind == "dining room":
        kitchen_and_dining.furnish_dining_room(layout)
    elif kind == "kitchen":
        kitchen_and_dining.furnish_kitchen(layout, table=kitchen_table)
    elif kind == "bedroom":
        bedroom_and_study.furnish_bedroom(
            layout, first=layout.room.name in ("bedroom", "bedroom 1")
        )
    elif kind == "bathroom":
        furnish_bathroom(layout, with_washer="laundry" not in kinds and rng.chance(0.6))
    elif kind == "office":
        bedroom_and_study.furnish_office(layout)
    elif kind == "laundry":
        furnish_laundry(layout)
    elif kind == "hall":
        furnish_hall(layout)
    elif kind == "storage":
        furnish_storage(layout)
    elif kind == "balcony":
        furnish_balcony(layout)


def _dines_here(plan: FloorPlan) -> bool:
    """Whether the dining table belongs in the living room."""
    kinds = [room.kind for room in plan.rooms]
    return "dining room" not in kinds and ("kitchen" not in kinds or not _kitchen_is_large(plan))


def _kitchen_is_large(plan: FloorPlan) -> bool:
    room = next(r for r in plan.rooms if r.kind == "kitchen")
    return min(room.inner.width, room.inner.depth) > 2.75 and room.inner.area > 11.0


def _add_set_dressing(layout: RoomLayout) -> None:
    kind = layout.room.kind
    set_dressing.place_radiators(layout)
    if kind not in ("kitchen", "bathroom", "laundry", "storage"):
        set_dressing.hang_curtains(layout)
    set_dressing.hang_pictures(layout, _PICTURE_COUNTS.get(kind, 0))
    if kind == "dining room":
        return
    long, short = (
        max(layout.inner.width, layout.inner.depth),
        min(layout.inner.width, layout.inner.depth),
    )
    if long > 2.4 * short:
        i = layout.inner
        for share in (0.25, 0.75):
            xy = (
                (i.x0 + i.width * share, i.centre[1])
                if i.width > i.depth
                else (i.centre[0], i.y0 + i.depth * share)
            )
            set_dressing.hang_lamp(layout, devices.ceiling_lamp, xy)
        return
    maker = (
        devices.chandelier
        if kind == "living room" and layout.rng.chance(0.3)
        else devices.ceiling_lamp
    )
    set_dressing.hang_lamp(layout, maker)


HOME_FURNISHING = Furnishing(_required, _furnish, _add_set_dressing)
"""Rules by which homes are furnished."""
