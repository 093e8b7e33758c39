"""Lamps in rows under the ceilings of public buildings, and pictures on their walls."""

from hypernav.houses.furnishing.set_dressing import hang_pictures
from hypernav.houses.objects.workplace import machines
from hypernav.houses.placement.model_pose import ModelPose
from hypernav.houses.placement.room_layout import RoomLayout

_LAMP_EVERY_M = 3.6


def hang_lamps_in_rows(layout: RoomLayout) -> None:
    """Hang equal lamps at even distances."""
    i = layout.inner
    model = machines.light_panel(layout.rng, layout.palette)
    yaw = 0.0 if i.width >= i.depth else 90.0
    columns, rows = (max(round(side / _LAMP_EVERY_M), 1) for side in (i.width, i.depth))
    for row in range(rows):
        for column in range(columns):
            x = round(i.x0 + i.width * (column + 0.5) / columns, 3)
            y = round(i.y0 + i.depth * (row + 0.5) / rows, 3)
            pose = ModelPose(x, y, yaw, layout.height - 0.001)
            if not layout.is_taken(model, pose):
                layout.place(model, pose)


def dress_public_room(layout: RoomLayout, pictures: int) -> None:
    """Hang lamps and pictures."""
    hang_lamps_in_rows(layout)
    hang_pictures(layout, pictures)
