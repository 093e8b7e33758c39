"""Placement of rugs and large plants."""

from hypernav.houses.assembly import PlacedModel
from hypernav.houses.modelling.model import Model
from hypernav.houses.objects.decor import plants
from hypernav.houses.placement.model_pose import ModelPose, footprint
from hypernav.houses.placement.room_layout import RoomLayout


def place_rug(layout: RoomLayout, rug: Model, pose: ModelPose) -> PlacedModel | None:
    """Place a rug, also under furniture, if it lies within the room and on no other rug."""
    rect = footprint(rug, pose)
    if not layout.inner.grown(-0.02).holds(rect):
        return None
    if any(
        rect.overlaps(footprint(p.model, ModelPose(p.x, p.y, p.yaw_deg)))
        for p in layout.placed
        if p.model.category == "rug"
    ):
        return None
    return layout.place(rug, pose, flat=True)


def place_plants(layout: RoomLayout, count: int) -> None:
    """Place large plants in corners and along walls."""
    for _ in range(count):
        maker = layout.rng.choice(
            (
                plants.snake_plant,
                plants.monstera,
                plants.indoor_tree,
                plants.leafy_plant,
                plants.leafy_plant,
            )
        )
        layout.place_at_wall(
            maker(layout.rng, layout.palette), where="corner" if layout.rng.chance(0.7) else "any"
        )
