"""Furnishing of dining rooms, and of a table with its chairs in any room."""

from hypernav.houses.assembly import PlacedModel
from hypernav.houses.furnishing.rugs_and_plants import place_plants, place_rug
from hypernav.houses.furnishing.set_dressing import scatter
from hypernav.houses.modelling.model import Model
from hypernav.houses.objects.decor import ornaments, plants, textiles
from hypernav.houses.objects.devices import lighting
from hypernav.houses.objects.furniture import cabinets, chairs, shelves, tables
from hypernav.houses.objects.kitchen_and_bathroom import tableware
from hypernav.houses.placement.model_pose import ModelPose, footprint, turned_point
from hypernav.houses.placement.room_layout import RoomLayout


def furnish_dining_room(layout: RoomLayout) -> None:
    """Furnish with a large table, a sideboard and what fits."""
    rng, palette = layout.rng, layout.palette
    piece = place_dining(layout, seats=rng.choice((4, 6, 6, 8)))
    if piece is not None:
        rug = textiles.rug(rng, palette)
        if rng.chance(0.4):
            place_rug(layout, rug, ModelPose(piece.x, piece.y, piece.yaw_deg))
        lamp = rng.choice((lighting.chandelier, lighting.pendant))(rng, palette)
        layout.place(lamp, ModelPose(piece.x, piece.y, 0.0, layout.height - 0.001))
    for maker in rng.shuffled((cabinets.cabinet, cabinets.display_cabinet, shelves.wine_rack))[:2]:
        base = layout.place_at_wall(maker(rng, palette), front=0.4, access=True)
        scatter(
            layout,
            base,
            (plants.flower_vase, ornaments.photo_frame, lighting.table_lamp, tableware.bowl),
            2,
        )
    place_plants(layout, rng.integer(1, 2))


def place_dining(layout: RoomLayout, seats: int) -> PlacedModel | None:
    """Place a dining table with its chairs, laid for a meal or with a vase."""
    rng, palette = layout.rng, layout.palette
    chair = chairs.dining_chair(rng, palette)
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
        dx, dy = turned_point(x, y, pose.yaw_deg)
        seat = ModelPose(pose.x + dx, pose.y + dy, pose.yaw_deg + yaw)
        if layout.fits(chair, seat, over=[carrier]):
            layout.place(chair, seat)
    _lay_table(layout, placed, seats)
    return placed


def _lay_table(layout: RoomLayout, table: PlacedModel, seats: int) -> None:
    rng = layout.rng
    scatter(layout, table, (plants.flower_vase, tableware.fruit_bowl, ornaments.candle), 1)
    if rng.chance(0.5):
        scatter(layout, table, [tableware.plate] * min(seats, 4) + [tableware.cup] * 2, 5)
    else:
        scatter(
            layout,
            table,
            (tableware.cup, ornaments.books, tableware.bottle, tableware.bowl),
            rng.integer(1, 3),
        )
