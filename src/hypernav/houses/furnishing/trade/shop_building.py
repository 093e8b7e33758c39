"""Furnishing of shops and libraries: which rooms get what."""

from collections.abc import Callable

from hypernav.houses.furnishing.ceilings import dress_public_room
from hypernav.houses.furnishing.rooms import Furnishing, RequiredGroups
from hypernav.houses.furnishing.trade import back_rooms, library_rooms, sales_halls
from hypernav.houses.furnishing.trade.aisles import has_till
from hypernav.houses.furnishing.workplace.office_building import FURNISHERS, REQUIRED
from hypernav.houses.placement.room_layout import RoomLayout
from hypernav.houses.plan.shapes import FloorPlan

_FURNISHERS: dict[str, Callable[[RoomLayout], None]] = {
    "supermarket": sales_halls.furnish_supermarket,
    "hardware store": sales_halls.furnish_hardware_store,
    "clothes shop": sales_halls.furnish_clothes_shop,
    "bookshop": sales_halls.furnish_bookshop,
    "library": library_rooms.furnish_library,
    "reading room": library_rooms.furnish_reading_room,
    "study room": library_rooms.furnish_study_room,
    "stock room": back_rooms.furnish_stock_room,
    "fitting room": back_rooms.furnish_fitting_room,
    "arcade": back_rooms.furnish_arcade,
    "staff room": FURNISHERS["pantry"],
    **{kind: FURNISHERS[kind] for kind in ("office", "restroom", "corridor")},
}

_SHOPS = ("supermarket", "hardware store", "clothes shop", "bookshop")
_TILLS = ("checkout counter", "sales counter")
_REQUIRED: dict[str, RequiredGroups] = {
    "supermarket": (("grocery shelf",),),
    "hardware store": (("storage rack",),),
    "clothes shop": (("clothes rack",),),
    "bookshop": (("bookshelf",),),
    "library": (("bookshelf",), ("reception desk",), ("chair",)),
    "reading room": (("meeting table",), ("chair",)),
    "study room": (("meeting table",), ("chair",)),
    "staff room": REQUIRED["pantry"],
    **{kind: REQUIRED[kind] for kind in ("office", "restroom")},
}


def _required(plan: FloorPlan, number: int) -> RequiredGroups:
    required = _REQUIRED.get(plan.rooms[number].kind, ())
    return (
        (*required, _TILLS)
        if plan.rooms[number].kind in _SHOPS and has_till(plan, number)
        else required
    )


def _furnish(layout: RoomLayout) -> None:
    _FURNISHERS[layout.room.kind](layout)


def _dress(layout: RoomLayout) -> None:
    dress_public_room(layout, 2 if layout.room.kind in ("library", "bookshop", "corridor") else 0)


SHOP_FURNISHING = Furnishing(_required, _furnish, _dress)
"""Rules by which shops and libraries are furnished."""
