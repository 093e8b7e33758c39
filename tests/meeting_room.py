"""A meeting room whose screen is seen through an opening that does not lead to it."""

from box_scenes import Box, room_boxes, scene_of
from hypernav.simulator.worlds.simulation import SimulatedWorld
from small_worlds import colourless_world, small_config

_SEAT_M, _BETWEEN_M = 0.45, 0.24


def meeting_room(*, board_m: float, aisle_m: float) -> SimulatedWorld:
    """The room as a world; see `meeting_room_boxes`."""
    config, boxes = small_config(), meeting_room_boxes(board_m=board_m, aisle_m=aisle_m)
    return colourless_world(scene_of(*boxes, name="meeting room"), config)


def meeting_room_boxes(*, board_m: float, aisle_m: float, beside_m: float = 0.28) -> list[Box]:
    """A corridor, y 0 to 2, the meeting room, x 0 to 7, and an empty room, x 7 to 12.

    The opening lies at the room's west end; a table with chairs on all sides fills the room. The
    screen hangs on the north wall, near the west end, above a sideboard. The aisle before it is
    reached around the east end of the table.

    Args:
        board_m: Depth of the sideboard.
        aisle_m: Width of the aisle between sideboard and chairs.
        beside_m: Width of the gap between the west wall and the chairs.
    """
    deep = 4.6
    boxes: list[Box] = [
        *room_boxes(12.0, 2.0 + deep),
        (None, (1.7, 1.95, 0.0), (8.5, 2.05, 2.5)),
        (None, (10.0, 1.95, 0.0), (12.0, 2.05, 2.5)),
        (None, (6.95, 2.0, 0.0), (7.05, 2.0 + deep, 2.5)),
        ("tv", (1.0, 1.95 + deep, 1.1), (2.2, 2.0 + deep, 1.8)),
        ("sideboard", (0.02, 2.0 + deep - board_m, 0.0), (3.0, 2.0 + deep, 0.8)),
    ]
    top = 2.0 + deep - board_m - aisle_m
    west, low = beside_m, top - 1.9
    boxes.append(("table", (west + 0.35, low + 0.35, 0.7), (5.3, top - 0.35, 0.75)))
    boxes.append(("table leg", (1.0, low + 0.8, 0.0), (4.8, top - 0.8, 0.7)))
    x = west + 0.5
    while x + _SEAT_M < 5.3:
        boxes.append(("chair", (x, low, 0.0), (x + _SEAT_M, low + _SEAT_M, 0.9)))
        boxes.append(("chair", (x, top - _SEAT_M, 0.0), (x + _SEAT_M, top, 0.9)))
        x += _SEAT_M + _BETWEEN_M
    middle = (low + top) / 2.0
    for left in (west, 5.2):
        boxes.append(("chair", (left, middle - 0.22, 0.0), (left + _SEAT_M, middle + 0.22, 0.9)))
    return boxes
