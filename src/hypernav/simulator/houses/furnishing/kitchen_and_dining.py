"""Furnishing of kitchens with rows of fitted units, and of dining tables with their chairs."""

from hypernav.simulator.houses.assembly import PlacedModel
from hypernav.simulator.houses.furnishing.room_layout import (
    SIDES,
    ModelPose,
    RoomLayout,
    beside,
    footprint,
)
from hypernav.simulator.houses.furnishing.set_dressing import (
    place_plants,
    place_rug,
    scatter,
    stand_some,
)
from hypernav.simulator.houses.modelling.model import Model
from hypernav.simulator.houses.objects.belongings import (
    decor,
    devices,
    household,
    kitchenware,
    plants,
)
from hypernav.simulator.houses.objects.furniture import kitchen_units, seating, storage, tables

_SHORTEST_ROW_M = 2.2
_ON_COUNTER = (
    kitchenware.microwave,
    kitchenware.toaster,
    kitchenware.kettle,
    kitchenware.coffee_machine,
    kitchenware.blender,
    kitchenware.knife_block,
    kitchenware.fruit_bowl,
    kitchenware.bottle,
    kitchenware.cutting_board,
    kitchenware.paper_towels,
    plants.small_plant,
    kitchenware.cup,
)


def furnish_dining_room(layout: RoomLayout) -> None:
    """Furnish with a large table, a sideboard and what fits."""
    rng, palette = layout.rng, layout.palette
    piece = place_dining(layout, seats=rng.choice((4, 6, 6, 8)))
    if piece is not None:
        rug = decor.rug(rng, palette)
        if rng.chance(0.4):
            place_rug(layout, rug, ModelPose(piece.x, piece.y, piece.yaw_deg))
        lamp = rng.choice((devices.chandelier, devices.pendant))(rng, palette)
        layout.place(lamp, ModelPose(piece.x, piece.y, 0.0, layout.height - 0.001))
    for maker in rng.shuffled((storage.cabinet, storage.display_cabinet, storage.wine_rack))[:2]:
        base = layout.place_at_wall(maker(rng, palette), front=0.4, access=True)
        small = (plants.flower_vase, decor.photo_frame, devices.table_lamp, kitchenware.bowl)
        scatter(layout, base, small, 2)
    place_plants(layout, rng.integer(1, 2))


def place_dining(layout: RoomLayout, seats: int) -> PlacedModel | None:
    """Place a dining table with its chairs, laid for a meal or with a vase."""
    rng, palette = layout.rng, layout.palette
    chair = seating.dining_chair(rng, palette)
    sizes = [s for s in (8, 6, 4, 2) if s <= seats]
    for count in sizes:
        table = tables.dining_table(rng, palette, count)
        poses = [
            (x, y, yaw)
            for x, y in _centres(layout)
            for yaw in ((0.0, 90.0) if rng.chance(0.5) else (90.0, 0.0))
        ]
        for around in (0.75, 0.4):
            for x, y, yaw in poses:
                pose = ModelPose(x, y, yaw)
                if layout.is_free(footprint(table, pose).grown(around)) and layout.fits(
                    table, pose
                ):
                    return _set_table(layout, table, chair, pose, count)
    return None


def _centres(layout: RoomLayout) -> list[tuple[float, float]]:
    i = layout.inner
    cx, cy = i.centre
    points = [(cx, cy)]
    nx, ny = max(int(i.width / 0.4), 2), max(int(i.depth / 0.4), 2)
    grid = [
        (round(i.x0 + i.width * a / nx, 3), round(i.y0 + i.depth * b / ny, 3))
        for a in range(1, nx)
        for b in range(1, ny)
    ]
    if layout.room.kind != "dining room":
        points = []
    return points + layout.rng.shuffled(grid)[:36]


def _set_table(
    layout: RoomLayout, table: Model, chair: Model, pose: ModelPose, seats: int
) -> PlacedModel:
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
    placed = layout.place(table, pose)
    carrier = layout.obstacle_of(placed)
    for x, y, yaw in seatings:
        seat = beside(pose, x, y, yaw)
        layout.place_if_fits(chair, seat, over=[carrier])
    _lay_table(layout, placed, seats)
    return placed


def _lay_table(layout: RoomLayout, table: PlacedModel, seats: int) -> None:
    rng = layout.rng
    scatter(layout, table, (plants.flower_vase, kitchenware.fruit_bowl, decor.candle), 1)
    if rng.chance(0.5):
        scatter(layout, table, [kitchenware.plate] * min(seats, 4) + [kitchenware.cup] * 2, 5)
    else:
        small = (kitchenware.cup, decor.books, kitchenware.bottle, kitchenware.bowl)
        scatter(layout, table, small, rng.integer(1, 3))


def furnish_kitchen(layout: RoomLayout, *, table: bool) -> None:
    """Furnish with units and appliances, perhaps a table or an island, a bin, a plant.

    Args:
        layout: Layout of the room.
        table: Whether the room gets a dining table.
    """
    rng = layout.rng
    place_units(layout)
    if table and min(layout.inner.width, layout.inner.depth) > 2.4:
        place_dining(layout, seats=rng.choice((2, 4)))
    elif min(layout.inner.width, layout.inner.depth) > 3.2 and rng.chance(0.7):
        _island(layout)
    things = (
        (household.trash_can, 0.8),
        (storage.wine_rack, 0.25),
        (seating.stool, 0.2),
        (household.broom, 0.15),
    )
    stand_some(layout, rng.shuffled(things), where="corner")
    if rng.chance(0.5):
        place_plants(layout, 1)


def _island(layout: RoomLayout) -> None:
    rng, palette = layout.rng, layout.palette
    model = tables.kitchen_island(rng, palette)
    x, y = layout.inner.centre
    for yaw in rng.shuffled((0.0, 90.0, 180.0, -90.0)):
        pose = ModelPose(x, y, yaw)
        if layout.fits(model, pose, access=True):
            piece = layout.place(model, pose)
            scatter(
                layout, piece, (kitchenware.fruit_bowl, plants.flower_vase, kitchenware.bottle), 2
            )
            return


def place_units(layout: RoomLayout) -> bool:
    """Place fitted units along the wall with most space; False if no wall has enough."""
    best: tuple[float, str, float, float] | None = None
    for side in layout.rng.shuffled(SIDES):
        for start, end in _runs(layout, side):
            length = min(end - start, 4.3)
            score = length + 0.3 * layout.rng.unit()
            if length >= _SHORTEST_ROW_M and (best is None or score > best[0]):
                best = (score, side, start, end)
    if best is None:
        return False
    _, side, start, end = best
    _fill_row(layout, side, start, end)
    if layout.room.kind == "kitchen" and layout.inner.area > 11.0:
        _second_row(layout, side)
    return True


def _second_row(layout: RoomLayout, first: str) -> None:
    """Place more cabinets along another wall."""
    rng, palette = layout.rng, layout.palette
    for side in rng.shuffled([s for s in SIDES if s != first]):
        for start, end in _runs(layout, side):
            if end - start < 1.3:
                continue
            top = kitchen_units.worktop(rng, palette)
            widths = [0.8] * min(int((end - start - 0.02) / 0.802), 3)
            models = [kitchen_units.kitchen_cabinet(rng, palette, w, top) for w in widths]
            for model, pose in _row(layout, side, models, start, end, low=rng.chance(0.5)):
                piece = layout.place(model, pose)
                _above(layout, side, piece, None)
                _on_counter(layout, piece)
            _reserve_front(layout, side, start, end)
            return


def _runs(layout: RoomLayout, side: str) -> list[tuple[float, float]]:
    """Segments of a wall where a worktop can stand."""
    start, end, _ = layout.wall_line(side)
    probe = kitchen_probe()
    step = 0.05
    runs: list[tuple[float, float]] = []
    t, begin = start + probe.width / 2 + 0.005, None
    while t <= end - probe.width / 2:
        free = layout.fits(
            probe, layout.pose_at_wall(probe, side, round(t, 3)), front=0.9, floor=False
        )
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
    """Model without parts, of a unit's depth and height, to test for free space."""
    return Model((), "probe", low=(-0.05, -0.3, 0.0), high=(0.05, 0.3, 0.94))


def _fill_row(layout: RoomLayout, side: str, start: float, end: float) -> None:
    """Place a fridge at one end, then sink, oven, dishwasher and cabinets, wall units above."""
    rng, palette = layout.rng, layout.palette
    top = kitchen_units.worktop(rng, palette)
    fridge = kitchen_units.refrigerator(rng, palette)
    units = [kitchen_units.kitchen_sink(rng, palette, top), kitchen_units.oven(rng, palette)]
    left = end - start - fridge.width - 0.8 - 0.6 - 0.08
    if left > 0.62 and rng.chance(0.7):
        units.append(kitchen_units.dishwasher(rng, palette))
        left -= 0.6
    for _ in range(3):
        if left > 0.42:
            wide = min(rng.choice((0.4, 0.5, 0.6, 0.8)), round(left - 0.02, 2))
            units.append(kitchen_units.kitchen_cabinet(rng, palette, wide, top))
            left -= wide
    best: list[tuple[Model, ModelPose]] = []
    for attempt in range(10):
        order = rng.shuffled(units)
        row = _row(
            layout,
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
    for model, pose in best:
        piece = layout.place(model, pose)
        _above(layout, side, piece, fridge)
        _on_counter(layout, piece)
    _reserve_front(layout, side, start, end)
    if all(model is not fridge for model, _ in best):
        layout.place_at_wall(fridge, front=0.7, access=True, where="corner")


def _row(
    layout: RoomLayout, side: str, models: list[Model], start: float, end: float, *, low: bool
) -> list[tuple[Model, ModelPose]]:
    """Units of a row that fit, with their poses, from one end of the segment on."""
    total = sum(m.width for m in models) + 0.002 * len(models)
    at = start + 0.01 if low else max(end - total - 0.01, start + 0.01)
    result = []
    for model in models:
        pose = layout.pose_at_wall(model, side, at + model.width / 2)
        at += model.width + 0.002
        if at < end + 0.01 and layout.fits(model, pose, tight=True):
            result.append((model, pose))
    return result


def _reserve_front(layout: RoomLayout, side: str, start: float, end: float) -> None:
    probe = Model(
        (), "probe", low=(-(end - start) / 2, -0.3, 0.0), high=((end - start) / 2, 0.3, 0.9)
    )
    pose = layout.pose_at_wall(probe, side, (start + end) / 2)
    layout.reserve(layout.front_zone(probe, pose, 0.85))


def _above(layout: RoomLayout, side: str, piece: PlacedModel, fridge: Model | None) -> None:
    rng, palette = layout.rng, layout.palette
    if piece.model is fridge:
        return
    along = piece.x if side in ("south", "north") else piece.y
    if piece.model.category == "oven":
        hood = kitchen_units.range_hood(rng, palette)
        pose = layout.pose_at_wall(hood, side, along, 0.004, 1.6)
        layout.place_if_fits(hood, pose, in_clear_zone=True, tight=True)
        return
    unit = kitchen_units.wall_cabinet(rng, palette, round(piece.model.width - 0.004, 3))
    pose = layout.pose_at_wall(unit, side, along, 0.004, 1.45)
    if rng.chance(0.9):
        layout.place_if_fits(unit, pose, in_clear_zone=True, tight=True)


def _on_counter(layout: RoomLayout, piece: PlacedModel) -> None:
    if piece.model.category == "oven":
        if layout.rng.chance(0.7):
            layout.place_on_top(piece, kitchenware.pot(layout.rng, layout.palette))
        return
    if piece.model.category in ("kitchen cabinet", "dishwasher"):
        used = {p.model.category for p in layout.placed}
        makers = [m for m in _ON_COUNTER if m.__name__.replace("_", " ") not in used]
        scatter(layout, piece, makers, layout.rng.integer(1, 3))
