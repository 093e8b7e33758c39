"""Surroundings of a sofa: cushions, a coffee table, armchairs, side tables, a rug."""

from hypernav.houses.assembly import PlacedModel
from hypernav.houses.furnishing.rugs_and_plants import place_rug
from hypernav.houses.furnishing.set_dressing import scatter
from hypernav.houses.modelling.model import Model
from hypernav.houses.objects.decor import ornaments, plants, textiles
from hypernav.houses.objects.devices import electronics, lighting
from hypernav.houses.objects.furniture import sofas, stools, tables
from hypernav.houses.objects.kitchen_and_bathroom import tableware
from hypernav.houses.placement.model_pose import ModelPose, turned_point
from hypernav.houses.placement.room_layout import RoomLayout


def place_cushions(layout: RoomLayout, couch: PlacedModel) -> None:
    """Place up to two cushions in the corners of a sofa."""
    model = couch.model
    if model.width < 1.2 or layout.rng.chance(0.25):
        return
    back = model.low[1] + 0.47
    for s in (-1.0, 1.0):
        if layout.rng.chance(0.7):
            cushion = textiles.sofa_cushion(layout.rng, layout.palette)
            x, y = turned_point(s * (model.width / 2 - 0.47), back, couch.yaw_deg)
            layout.place(
                cushion, ModelPose(couch.x + x, couch.y + y, couch.yaw_deg, 0.475), on_top=True
            )


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
        dx, dy = turned_point(shift, off, couch.yaw_deg)
        pose = ModelPose(couch.x + dx, couch.y + dy, couch.yaw_deg)
        over = [layout.obstacle_of(couch)] if chaise else []
        if layout.fits(table, pose, over=over, in_clear_zone=True) and not (
            chaise and _hits_chaise(table, shift, off, model)
        ):
            piece = layout.place(table, pose)
            scatter(
                layout,
                piece,
                (
                    ornaments.books,
                    plants.flower_vase,
                    plants.small_plant,
                    tableware.bowl,
                    tableware.cup,
                    ornaments.remote,
                    ornaments.candle,
                    ornaments.magazine,
                ),
                rng.integer(1, 3),
            )
    if rng.chance(0.75):
        rug = textiles.rug(rng, palette)
        dx, dy = turned_point(0.0, front + 0.5, couch.yaw_deg)
        place_rug(layout, rug, ModelPose(couch.x + dx, couch.y + dy, couch.yaw_deg))
    for s in rng.shuffled((-1.0, 1.0)):
        if rng.chance(0.6):
            seat = rng.weighted(((sofas.armchair, 4.0), (stools.ottoman, 0.5)))(rng, palette)
            dx, dy = turned_point(s * (model.width / 2 + 0.25), front + 0.55, couch.yaw_deg)
            pose = ModelPose(couch.x + dx, couch.y + dy, couch.yaw_deg + s * 90.0)
            if layout.fits(seat, pose, access=False):
                layout.place(seat, pose)
    for s in rng.shuffled((-1.0, 1.0)):
        side_table = tables.side_table(rng, palette)
        back = -model.depth / 2 + side_table.depth / 2 + 0.02
        dx, dy = turned_point(
            s * (model.width / 2 + side_table.width / 2 + 0.04), back, couch.yaw_deg
        )
        pose = ModelPose(couch.x + dx, couch.y + dy, couch.yaw_deg)
        if rng.chance(0.5) and layout.fits(side_table, pose):
            piece = layout.place(side_table, pose)
            scatter(layout, piece, (lighting.table_lamp,), 1)
            scatter(layout, piece, (ornaments.books, tableware.cup, electronics.phone), 1)


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
