"""What every room gets in the end: curtains, lamps, pictures, rugs and things on surfaces."""

from collections.abc import Callable, Sequence

from hypernav.houses.assembly import PlacedModel
from hypernav.houses.materials import Palette
from hypernav.houses.modelling.model import Model
from hypernav.houses.objects.decor import wall_decor
from hypernav.houses.placement.model_pose import SIDES, ModelPose
from hypernav.houses.placement.room_layout import RoomLayout
from hypernav.houses.random_stream import RandomStream

Maker = Callable[[RandomStream, Palette], Model]


def hang_curtains(layout: RoomLayout) -> None:
    """Curtains at the windows, where furniture leaves room for them."""
    for side in SIDES:
        for opening in layout.wall_openings(side):
            if opening.kind != "window" or opening.width < 0.9:
                continue
            high = min(opening.top + 0.14, layout.height - 0.05)
            model = wall_decor.curtain(layout.rng, layout.palette, opening.width, high - 0.03)
            pose = layout.pose_at_wall(model, side, (opening.start + opening.end) / 2, 0.03, 0.02)
            start, end, _ = layout.wall_line(side)
            along = pose.x if side in ("south", "north") else pose.y
            if along - model.width / 2 < start + 0.01 or along + model.width / 2 > end - 0.01:
                continue
            if not layout.is_taken(model, pose) and layout.keeps_floor_connected(model, pose):
                layout.place(model, pose)


def place_radiators(layout: RoomLayout) -> None:
    """A radiator under some windows."""
    for side in SIDES:
        for opening in layout.wall_openings(side):
            if opening.kind == "window" and opening.bottom > 0.85 and layout.rng.chance(0.35):
                model = wall_decor.radiator(layout.rng, layout.palette)
                pose = layout.pose_at_wall(model, side, (opening.start + opening.end) / 2, 0.03)
                if model.width < opening.width + 0.3 and layout.fits(model, pose):
                    layout.place(model, pose)


def hang_lamp(layout: RoomLayout, maker: Maker, xy: tuple[float, float] | None = None) -> None:
    """A lamp at the ceiling, in the middle if nothing else is said."""
    model = maker(layout.rng, layout.palette)
    x, y = xy or layout.inner.centre
    pose = ModelPose(x, y, 0.0, layout.height - 0.001)
    if not layout.is_taken(model, pose):
        layout.place(model, pose)


def hang_pictures(layout: RoomLayout, count: int) -> None:
    """Pictures, a clock or a mirror on free stretches of wall."""
    for _ in range(count):
        maker = layout.rng.weighted(
            ((wall_decor.framed_picture, 6.0), (wall_decor.clock, 1.0), (wall_decor.mirror, 1.0))
        )
        model = maker(layout.rng, layout.palette)
        layout.hang_on_wall(model, sides=SIDES, z=round(1.62 - model.height / 2, 3))


def scatter(
    layout: RoomLayout, base: PlacedModel | None, makers: Sequence[Maker], count: int
) -> list[PlacedModel]:
    """Small things on a surface, at most ``count``; a maker is used once."""
    if base is None:
        return []
    result = []
    for maker in layout.rng.shuffled(makers)[:count]:
        piece = layout.place_on_top(base, maker(layout.rng, layout.palette))
        if piece is not None:
            result.append(piece)
    return result
