"""Furnishing of bathrooms."""

from hypernav.houses.assembly import PlacedModel
from hypernav.houses.furnishing.set_dressing import scatter, stand_some
from hypernav.houses.objects.belongings import household
from hypernav.houses.objects.decor import ornaments, plants, textiles, wall_decor
from hypernav.houses.objects.furniture import cabinets
from hypernav.houses.objects.kitchen_and_bathroom import bathing, laundry, sanitary
from hypernav.houses.placement.model_pose import SIDES, ModelPose, turned_point
from hypernav.houses.placement.room_layout import RoomLayout


def furnish_bathroom(layout: RoomLayout, *, with_washer: bool) -> None:
    """Furnish with a toilet, a basin with mirror, a tub or shower, and towels.

    Args:
        layout: Layout of the room.
        with_washer: Whether the room gets a washing machine.
    """
    rng, palette = layout.rng, layout.palette
    big = layout.inner.area > 4.4
    tub = (
        layout.place_at_wall(bathing.bathtub(rng, palette), where="corner", gap=0.012)
        if big and rng.chance(0.6)
        else None
    )
    if tub is None:
        layout.place_at_wall(bathing.shower(rng, palette), where="corner", front=0.5, access=True)
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
        mirror = wall_decor.mirror(rng, palette)
        layout.hang_on_wall(mirror, sides=SIDES, z=1.15, near=basin)
        scatter(layout, basin, (household.soap_dispenser, household.toothbrush_cup), 2)
    if toilet is not None:
        scatter(
            layout,
            toilet,
            (plants.small_plant, ornaments.candle, textiles.folded_towels),
            1 if rng.chance(0.4) else 0,
        )
    if with_washer:
        washer = layout.place_at_wall(
            laundry.washing_machine(rng, palette), front=0.55, access=True, where="corner"
        )
        scatter(layout, washer, (household.detergent, textiles.folded_towels), 1)
    layout.hang_on_wall(wall_decor.towel_rack(rng, palette), sides=SIDES, z=0.82)
    layout.hang_on_wall(wall_decor.toilet_paper(rng, palette), sides=SIDES, z=0.65)
    stand_some(
        layout,
        (
            (household.trash_can, 0.6),
            (household.toilet_brush, 0.6),
            (laundry.laundry_basket, 0.35),
            (household.scale, 0.3),
            (cabinets.cabinet, 0.15),
            (plants.leafy_plant, 0.25),
        ),
        corner_chance=0.6,
    )
    mat = textiles.bath_mat(rng, palette)
    host = tub or basin
    if host is not None:
        dx, dy = turned_point(0.0, host.model.depth / 2 + 0.3, host.yaw_deg)
        pose = ModelPose(host.x + dx, host.y + dy, host.yaw_deg)
        if not layout.is_taken(mat, pose) and layout.fits(mat, pose, in_clear_zone=True):
            layout.place(mat, pose, flat=True)


def _curtain(layout: RoomLayout, tub: PlacedModel) -> None:
    model = wall_decor.shower_curtain(layout.rng, layout.palette, round(tub.model.width - 0.04, 3))
    dx, dy = turned_point(0.0, tub.model.depth / 2 + 0.06, tub.yaw_deg)
    pose = ModelPose(tub.x + dx, tub.y + dy, tub.yaw_deg, 0.25)
    if not layout.is_taken(model, pose) and layout.fits(
        model, pose, in_clear_zone=True, tight=True
    ):
        layout.place(model, pose)
