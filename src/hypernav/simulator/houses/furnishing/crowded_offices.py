"""Meeting rooms in which the straight path to the screen is blocked, but a path around is free.

A table with chairs all around fills the room. The screen hangs opposite the opening, behind them.
The gap at the near end of the table, next to the opening, is just too narrow for a robot, as are
those between the chairs; the aisle at its far end leads around to the screen.
"""

from hypernav.simulator.houses.furnishing.offices import OFFICE_FURNISHING, furnish_meeting_room
from hypernav.simulator.houses.furnishing.room_layout import YAW, ModelPose, RoomLayout, footprint
from hypernav.simulator.houses.furnishing.rooms import Furnishing
from hypernav.simulator.houses.modelling.model import Model
from hypernav.simulator.houses.objects.belongings import devices
from hypernav.simulator.houses.objects.furniture import office_equipment, seating
from hypernav.simulator.houses.plan.floor_plan import Opening
from hypernav.simulator.houses.plan.office_plans import MEETING_ROOMS, screen_side, wide_opening

_TUCK_M = 0.14
_BETWEEN_CHAIRS_M = 0.24
_LEAST_AISLE_M = 0.66
_SEATS = (10, 8, 6, 4)


class _Room:
    """A room by distances from the near end of the opening's wall, and from that wall.

    Attributes:
        long: Extent along the wall with the opening, metres.
        deep: Extent from that wall to the one with the screen, metres.
    """

    def __init__(self, layout: RoomLayout, opening: Opening) -> None:
        i = layout.inner
        self.screen_side = screen_side(layout.room, opening)
        self._along_x = opening.along == "x"
        self.long, self.deep = (i.width, i.depth) if self._along_x else (i.depth, i.width)
        self._low = (i.x0, i.y0) if self._along_x else (i.y0, i.x0)
        middle = (opening.start + opening.end) / 2.0 - self._low[0]
        self._from_high_end = middle > self.long / 2.0
        self._from_high_wall = self.screen_side in ("south", "west")

    def pose(self, along: float, into: float, yaw_deg: float) -> ModelPose:
        """Pose at distances from the near end and from the opening's wall, metres.

        Args:
            along: Distance from the near end.
            into: Distance from the wall with the opening.
            yaw_deg: Yaw; 0 has its back to the wall with the opening, 180 to the screen's.
        """
        a = self._low[0] + (self.long - along if self._from_high_end else along)
        b = self._low[1] + (self.deep - into if self._from_high_wall else into)
        turned = YAW[self.screen_side] + 180.0 + yaw_deg
        return ModelPose(a, b, turned) if self._along_x else ModelPose(b, a, turned)

    def end_yaw(self, *, near: bool) -> float:
        """Yaw for `pose` of what has its back to the near or the far end."""
        low = near != self._from_high_end
        side = ("west" if low else "east") if self._along_x else ("south" if low else "north")
        return YAW[side] - YAW[self.screen_side] - 180.0


def _furnish(layout: RoomLayout) -> None:
    opening = wide_opening(layout.openings)
    if layout.room.kind not in MEETING_ROOMS or opening is None:
        OFFICE_FURNISHING.furnish(layout)
    elif not _fill(layout, _Room(layout, opening)):
        furnish_meeting_room(layout)


def _fill(layout: RoomLayout, room: _Room) -> bool:
    """Fill the room with a table, chairs and the screen; False if it is too small or too large."""
    rng, palette = layout.rng, layout.palette
    seat = seating.dining_chair(rng, palette)
    behind = seat.depth - _TUCK_M
    near_m, aisle_m = rng.uniform(0.24, 0.3), rng.uniform(0.46, 0.56)
    free_m = room.long - near_m - _LEAST_AISLE_M - 2 * behind
    made = [office_equipment.meeting_table(rng, palette, seats) for seats in _SEATS]
    fitting = [(int(free_m / one.width), one) for one in made if one.width <= free_m]
    if not fitting:
        return False
    count, table = max(fitting, key=lambda item: item[0] * item[1].width)
    block_m = table.depth + 2 * behind
    middle = room.deep - aisle_m - block_m / 2
    if middle - block_m / 2 < _LEAST_AISLE_M:
        return False
    start = near_m + behind
    poses = [(table, room.pose(start + (k + 0.5) * table.width, middle, 0.0)) for k in range(count)]
    poses += _chairs(room, seat, start, count * table.width, middle, table.depth / 2 + behind)
    screen = devices.wall_tv(rng, palette)
    hung = layout.pose_at_wall(
        screen, room.screen_side, _along_wall(room, near_m + behind + 0.7), 0.004, 1.1
    )
    if not all(layout.inner.holds(footprint(model, pose)) for model, pose in poses):
        return False
    for model, pose in [*poses, (screen, hung)]:
        # A table that nobody can reach is removed unless it has reserved floor, even a centimetre.
        layout.place(model, pose, front=0.01 if model is table else 0.0)
    return True


def _along_wall(room: _Room, along: float) -> float:
    pose = room.pose(along, 0.0, 0.0)
    return pose.x if room.screen_side in ("south", "north") else pose.y


def _chairs(
    room: _Room, seat: Model, start: float, long: float, middle: float, reach: float
) -> list[tuple[Model, ModelPose]]:
    """Chairs along both sides of a table and one at each end.

    Args:
        room: The room.
        seat: The chair.
        start: Near end of the table, metres.
        long: Length of the table, metres.
        middle: Distance of its middle from the opening's wall, metres.
        reach: Distance of the chairs' backs from that middle, metres.
    """
    each = max(int(long / (seat.width + _BETWEEN_CHAIRS_M)), 1)
    off = reach - seat.depth / 2
    placed = []
    for k in range(each):
        along = start + (k + 0.5) * long / each
        placed.append((seat, room.pose(along, middle - off, 0.0)))
        placed.append((seat, room.pose(along, middle + off, 180.0)))
    end = seat.depth / 2 - _TUCK_M
    placed.append((seat, room.pose(start - end, middle, room.end_yaw(near=True))))
    placed.append((seat, room.pose(start + long + end, middle, room.end_yaw(near=False))))
    return placed


CROWDED_FURNISHING = Furnishing(OFFICE_FURNISHING.required, _furnish, OFFICE_FURNISHING.dress)
"""Rules by which crowded offices are furnished."""
