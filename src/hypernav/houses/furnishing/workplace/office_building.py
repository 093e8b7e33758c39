"""Furnishing of offices: which rooms get what."""

from collections.abc import Callable

from hypernav.houses.furnishing.ceilings import dress_public_room
from hypernav.houses.furnishing.rooms import Furnishing, RequiredGroups
from hypernav.houses.furnishing.workplace import meeting_rooms, service_rooms, work_rooms
from hypernav.houses.placement.room_layout import RoomLayout
from hypernav.houses.plan.shapes import FloorPlan

FURNISHERS: dict[str, Callable[[RoomLayout], None]] = {
    "office": work_rooms.furnish_cell_office,
    "open office": work_rooms.furnish_open_office,
    "meeting room": meeting_rooms.furnish_meeting_room,
    "conference room": meeting_rooms.furnish_meeting_room,
    "lounge": meeting_rooms.furnish_lounge,
    "reception": meeting_rooms.furnish_reception,
    "pantry": service_rooms.furnish_pantry,
    "restroom": service_rooms.furnish_restroom,
    "copy room": service_rooms.furnish_copy_room,
    "storage": service_rooms.furnish_storage,
    "server room": service_rooms.furnish_server_room,
    "corridor": service_rooms.furnish_corridor,
}
"""Function that furnishes each kind of room."""

REQUIRED: dict[str, RequiredGroups] = {
    "office": (("desk",), ("chair",)),
    "open office": (("desk",), ("chair",)),
    "meeting room": (("meeting table",), ("chair",)),
    "conference room": (("meeting table",), ("chair",)),
    "lounge": (("sofa", "armchair"),),
    "reception": (("reception desk",),),
    "pantry": (("refrigerator",), ("sink",)),
    "restroom": (("toilet",), ("sink",)),
    "copy room": (("copier",),),
    "storage": (("storage rack",),),
    "server room": (("server rack",),),
}
"""Categories that each kind of room must hold: at least one of each group."""

_PICTURES = {"office": 1, "meeting room": 1, "reception": 1, "lounge": 2, "corridor": 2}


def _required(plan: FloorPlan, number: int) -> RequiredGroups:
    return REQUIRED.get(plan.rooms[number].kind, ())


def _furnish(layout: RoomLayout) -> None:
    FURNISHERS[layout.room.kind](layout)


def _dress(layout: RoomLayout) -> None:
    dress_public_room(layout, _PICTURES.get(layout.room.kind, 0))


OFFICE_FURNISHING = Furnishing(_required, _furnish, _dress)
"""Rules by which offices are furnished."""
