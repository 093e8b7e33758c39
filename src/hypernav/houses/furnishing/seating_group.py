"""Seating group: a television at one wall, a sofa opposite."""

from hypernav.houses.furnishing.set_dressing import scatter
from hypernav.houses.furnishing.sofa_surroundings import furnish_around_sofa, place_cushions
from hypernav.houses.modelling.model import Model
from hypernav.houses.objects.decor import ornaments, plants
from hypernav.houses.objects.devices import electronics, screens
from hypernav.houses.objects.furniture import cabinets, sofas
from hypernav.houses.placement.model_pose import SIDES, ModelPose
from hypernav.houses.placement.room_layout import RoomLayout

_ALONG = {"south": (0.0, 1.0), "north": (0.0, -1.0), "west": (1.0, 0.0), "east": (-1.0, 0.0)}


def place_seating_group(layout: RoomLayout) -> None:
    """Place a television at one wall, a sofa opposite, a coffee table and a rug between."""
    rng, palette = layout.rng, layout.palette
    couch = rng.weighted(((sofas.sofa, 5.0), (sofas.l_shaped_sofa, 3.0), (sofas.futon, 0.7)))(
        rng, palette
    )
    stand, television, wall_mounted = _television(layout)
    for sofa_model in (couch, sofas.sofa(rng, palette), sofas.armchair(rng, palette)):
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
    layout.hang_on_wall(screens.wall_tv(rng, palette), sides=SIDES, z=1.0)


def _television(layout: RoomLayout) -> tuple[Model, Model, bool]:
    stand = cabinets.tv_stand(layout.rng, layout.palette)
    if layout.rng.chance(0.3):
        return stand, screens.wall_tv(layout.rng, layout.palette), True
    return stand, screens.tv(layout.rng, layout.palette), False


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
        if layout.fits(television, pose, in_clear_zone=True):
            layout.place(television, pose)
            scatter(
                layout,
                carrier,
                (
                    plants.small_plant,
                    ornaments.books,
                    electronics.speaker_small,
                    electronics.game_console,
                ),
                2,
            )
            return
        television = screens.tv(layout.rng, layout.palette)
    layout.place_on_top(carrier, television, facing=0.0, where=(0.5, 0.4))
    scatter(
        layout,
        carrier,
        (plants.small_plant, ornaments.books, ornaments.candle, electronics.game_console),
        1,
    )
