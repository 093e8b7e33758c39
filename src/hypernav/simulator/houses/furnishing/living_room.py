"""Furnishing of living rooms: a television at one wall, a sofa opposite, and what is around it."""

from hypernav.simulator.houses.assembly import PlacedModel
from hypernav.simulator.houses.furnishing.kitchen_and_dining import place_dining
from hypernav.simulator.houses.furnishing.room_layout import SIDES, ModelPose, RoomLayout, beside
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
    leisure,
    plants,
)
from hypernav.simulator.houses.objects.furniture import seating, storage, tables

_ALONG = {"south": (0.0, 1.0), "north": (0.0, -1.0), "west": (1.0, 0.0), "east": (-1.0, 0.0)}


def place_cushions(layout: RoomLayout, couch: PlacedModel) -> None:
    """Place up to two cushions in the corners of a sofa."""
    model = couch.model
    if model.width < 1.2 or layout.rng.chance(0.25):
        return
    back = model.low[1] + 0.47
    for s in (-1.0, 1.0):
        if layout.rng.chance(0.7):
            cushion = decor.sofa_cushion(layout.rng, layout.palette)
            pose = beside(couch, s * (model.width / 2 - 0.47), back, z=0.475)
            layout.place(cushion, pose, on_top=True)


def furnish_around_sofa(layout: RoomLayout, couch: PlacedModel) -> None:
    """Place a coffee table before a sofa, a rug under it, armchairs and side tables beside it."""
    rng, palette = layout.rng, layout.palette
    model = couch.model
    chaise = "L-shaped" in model.attributes
    front = model.depth / 2
    if rng.chance(0.85):
        table = tables.coffee_table(rng, palette)
        off = front + 0.38 + table.depth / 2 if not chaise else front - 0.25 + table.depth / 2
        shift = 0.0
        if chaise:
            seat_x = _chaise_side(model)
            shift = -seat_x * (0.32 + table.width * 0.1)
        pose = beside(couch, shift, off)
        over = [layout.obstacle_of(couch)] if chaise else []
        if layout.fits(table, pose, over=over, in_clear_zone=True) and not (
            chaise and _hits_chaise(table, shift, off, model)
        ):
            piece = layout.place(table, pose)
            small = (
                decor.books,
                plants.flower_vase,
                plants.small_plant,
                kitchenware.bowl,
                kitchenware.cup,
                decor.remote,
                decor.candle,
                decor.magazine,
            )
            scatter(layout, piece, small, rng.integer(1, 3))
    if rng.chance(0.75):
        rug = decor.rug(rng, palette)
        place_rug(layout, rug, beside(couch, 0.0, front + 0.5))
    for s in rng.shuffled((-1.0, 1.0)):
        if rng.chance(0.6):
            seat = rng.weighted(((seating.armchair, 4.0), (seating.ottoman, 0.5)))(rng, palette)
            pose = beside(couch, s * (model.width / 2 + 0.25), front + 0.55, s * 90.0)
            layout.place_if_fits(seat, pose)
    for s in rng.shuffled((-1.0, 1.0)):
        side_table = tables.side_table(rng, palette)
        back = -model.depth / 2 + side_table.depth / 2 + 0.02
        pose = beside(couch, s * (model.width / 2 + side_table.width / 2 + 0.04), back)
        if rng.chance(0.5) and layout.fits(side_table, pose):
            piece = layout.place(side_table, pose)
            scatter(layout, piece, (devices.table_lamp,), 1)
            scatter(layout, piece, (decor.books, kitchenware.cup, devices.phone), 1)


def _chaise_side(model: Model) -> float:
    """Side of an L-shaped sofa's chaise: -1 for smaller x, 1 for larger x of its model."""
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


def place_seating_group(layout: RoomLayout) -> None:
    """Place a television at one wall, a sofa opposite, a coffee table and a rug between."""
    rng, palette = layout.rng, layout.palette
    couch = rng.weighted(((seating.sofa, 5.0), (seating.l_shaped_sofa, 3.0), (seating.futon, 0.7)))(
        rng, palette
    )
    stand, television, wall_mounted = _television(layout)
    for sofa_model in (couch, seating.sofa(rng, palette), seating.armchair(rng, palette)):
        for side in sorted(
            rng.shuffled(SIDES), key=lambda s: len(layout.wall_openings(s)) * 0.5 + rng.unit()
        ):
            if _try_group(layout, side, sofa_model, stand, television, wall_mounted):
                return
    piece = layout.place_at_wall(couch, access=True, where="middle")
    if piece is not None:
        place_cushions(layout, piece)
    for _ in range(4):
        base = layout.place_at_wall(stand, front=0.6, access=True)
        if base is None:
            break
        if layout.place_on_top(base, television, facing=0.0, where=(0.5, 0.4)) is not None:
            return
        layout.remove(base)
    layout.hang_on_wall(devices.wall_tv(rng, palette), z=1.0)


def _television(layout: RoomLayout) -> tuple[Model, Model, bool]:
    stand = storage.tv_stand(layout.rng, layout.palette)
    if layout.rng.chance(0.3):
        return stand, devices.wall_tv(layout.rng, layout.palette), True
    return stand, devices.tv(layout.rng, layout.palette), False


def _try_group(
    layout: RoomLayout, side: str, couch: Model, stand: Model, television: Model, wall_mounted: bool
) -> bool:
    rng = layout.rng
    start, end, _ = layout.wall_line(side)
    across = layout.inner.depth if side in ("south", "north") else layout.inner.width
    half = max(stand.width, couch.width) / 2 + 0.05
    if end - start < 2 * half or across < 3.0:
        return False
    count = max(int((end - half - (start + half)) / 0.25), 1)
    spread = [start + half + (end - start - 2 * half) * k / count for k in range(count + 1)]
    for t in rng.shuffled(spread):
        t = round(t, 3)
        base = layout.pose_at_wall(stand, side, t)
        if not layout.fits(stand, base, front=0.5, access=True) or not _screen_fits(
            layout, side, t, base, stand, television
        ):
            continue
        far = across - couch.depth / 2 - 0.03
        near = stand.depth + 1.9 + couch.depth / 2
        distances = (
            [far] if across < 5.2 else [round(min(near + rng.uniform(0.2, 0.8), far), 3), far]
        )
        for distance in distances:
            if distance < near - 0.25:
                continue
            pose = _facing_pose(layout, side, t, distance)
            if not layout.fits(couch, pose, access=True):
                continue
            layout.place(stand, base, front=0.5, access=True)
            piece = layout.place(couch, pose, access=False)
            _mount(layout, side, t, base, television, wall_mounted)
            place_cushions(layout, piece)
            furnish_around_sofa(layout, piece)
            return True
    return False


def _screen_fits(
    layout: RoomLayout, side: str, t: float, base: ModelPose, stand: Model, television: Model
) -> bool:
    """Whether a television on its stand, or on the wall above, would cover no window."""
    mounted = layout.pose_at_wall(television, side, t, 0.004, 0.95)
    standing = ModelPose(base.x, base.y, base.yaw_deg, stand.height)
    return layout.fits(television, mounted, in_clear_zone=True) or layout.fits(
        television, standing, in_clear_zone=True
    )


def _facing_pose(layout: RoomLayout, side: str, t: float, distance: float) -> ModelPose:
    """Pose at a distance from a wall that faces it."""
    _, _, plane = layout.wall_line(side)
    dx, dy = _ALONG[side]
    yaw = {"south": 180.0, "north": 0.0, "west": 90.0, "east": -90.0}[side]
    if side in ("south", "north"):
        return ModelPose(t, plane + dy * distance, yaw)
    return ModelPose(plane + dx * distance, t, yaw)


def _mount(
    layout: RoomLayout, side: str, t: float, base: ModelPose, television: Model, wall_mounted: bool
) -> None:
    carrier = next(p for p in layout.placed if p.x == base.x and p.y == base.y)
    if wall_mounted:
        pose = layout.pose_at_wall(television, side, t, 0.004, 0.95)
        if layout.place_if_fits(television, pose, in_clear_zone=True) is not None:
            small = (plants.small_plant, decor.books, devices.speaker_small, devices.game_console)
            scatter(layout, carrier, small, 2)
            return
        television = devices.tv(layout.rng, layout.palette)
    layout.place_on_top(carrier, television, facing=0.0, where=(0.5, 0.4))
    small = (plants.small_plant, decor.books, decor.candle, devices.game_console)
    scatter(layout, carrier, small, 1)


def furnish_living_room(layout: RoomLayout, *, with_dining: bool) -> None:
    """Furnish with a seating group around a television, then with what fits."""
    rng, palette = layout.rng, layout.palette
    place_seating_group(layout)
    if with_dining:
        place_dining(layout, seats=rng.choice((4, 4, 6)))
    things = (
        (storage.bookshelf, 0.7),
        (storage.cabinet, 0.35),
        (storage.display_cabinet, 0.25),
        (leisure.piano, 0.25),
        (leisure.fireplace, 0.3),
        (storage.dresser, 0.1),
    )
    for maker, chance in rng.shuffled(things):
        if rng.chance(chance):
            piece = layout.place_at_wall(maker(rng, palette), front=0.45, access=True)
            small = (plants.flower_vase, decor.photo_frame, decor.candle, decor.globe, decor.clock)
            scatter(layout, piece, small, 2)
    things = (
        (devices.floor_lamp, 0.7),
        (seating.bean_bag, 0.2),
        (seating.rocking_chair, 0.15),
        (seating.ottoman, 0.3),
        (leisure.guitar, 0.2),
        (devices.fan, 0.2),
        (leisure.cat_tree, 0.12),
        (leisure.pet_bed, 0.15),
        (devices.speaker, 0.3),
        (household.basket, 0.2),
        (leisure.fish_tank, 0.12),
        (leisure.toy_box, 0.1),
    )
    stand_some(layout, rng.shuffled(things), where="corner")
    place_plants(layout, rng.integer(1, 3))
