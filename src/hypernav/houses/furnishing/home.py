"""Furnishing of homes: which rooms get what."""

from hypernav.houses.furnishing import (
    bathroom,
    bedroom,
    dining_room,
    kitchen,
    living_room,
    office,
    set_dressing,
    utility_rooms,
)
from hypernav.houses.furnishing.rooms import Furnishing, RequiredGroups
from hypernav.houses.objects.devices import lighting
from hypernav.houses.placement.room_layout import RoomLayout
from hypernav.houses.plan.shapes import FloorPlan

_PICTURE_COUNTS = {
    "living room": 3,
    "bedroom": 2,
    "hall": 2,
    "dining room": 2,
    "office": 2,
    "kitchen": 1,
}


_REQUIRED: dict[str, RequiredGroups] = {
    "living room": (("sofa",), ("tv",), ("coffee table",)),
    "kitchen": (("refrigerator",), ("oven",), ("sink",)),
    "bathroom": (("toilet",), ("sink",), ("bathtub", "shower")),
    "bedroom": (("bed",), ("wardrobe", "dresser")),
    "dining room": (("dining table",), ("chair",)),
    "office": (("desk",), ("chair",)),
    "laundry": (("washing machine",),),
}
"""Categories that a kind of room must hold: at least one of each group."""


def _required(plan: FloorPlan, number: int) -> RequiredGroups:
    kind = plan.rooms[number].kind
    kinds = [room.kind for room in plan.rooms]
    required = _REQUIRED.get(kind, ())
    if (kind == "living room" and _dines_here(plan)) or (
        kind == "kitchen" and "dining room" not in kinds and _kitchen_is_large(plan)
    ):
        required = (*required, ("dining table",), ("chair",))
    return required


def _furnish(layout: RoomLayout) -> None:
    kind = layout.room.kind
    kinds = [room.kind for room in layout.plan.rooms]
    rng = layout.rng
    has_dining, has_kitchen = "dining room" in kinds, "kitchen" in kinds
    kitchen_table = not has_dining and has_kitchen and _kitchen_is_large(layout.plan)
    if kind == "living room":
        if not has_kitchen:
            kitchen.place_units(layout)
        living_room.furnish_living_room(layout, with_dining=_dines_here(layout.plan))
    elif kind == "dining room":
        dining_room.furnish_dining_room(layout)
    elif kind == "kitchen":
        kitchen.furnish_kitchen(layout, table=kitchen_table)
    elif kind == "bedroom":
        bedroom.furnish_bedroom(layout, first=layout.room.name in ("bedroom", "bedroom 1"))
    elif kind == "bathroom":
        bathroom.furnish_bathroom(layout, with_washer="laundry" not in kinds and rng.chance(0.6))
    elif kind == "office":
        office.furnish_office(layout)
    elif kind == "laundry":
        utility_rooms.furnish_laundry(layout)
    elif kind == "hall":
        utility_rooms.furnish_hall(layout)
    elif kind == "storage":
        utility_rooms.furnish_storage(layout)
    elif kind == "balcony":
        utility_rooms.furnish_balcony(layout)


def _dines_here(plan: FloorPlan) -> bool:
    """Whether the dining table belongs in the living room."""
    kinds = [room.kind for room in plan.rooms]
    return "dining room" not in kinds and ("kitchen" not in kinds or not _kitchen_is_large(plan))


def _kitchen_is_large(plan: FloorPlan) -> bool:
    room = next(r for r in plan.rooms if r.kind == "kitchen")
    return min(room.inner.width, room.inner.depth) > 2.75 and room.inner.area > 11.0


def _add_set_dressing(layout: RoomLayout) -> None:
    kind = layout.room.kind
    set_dressing.place_radiators(layout)
    if kind not in ("kitchen", "bathroom", "laundry", "storage"):
        set_dressing.hang_curtains(layout)
    set_dressing.hang_pictures(layout, _PICTURE_COUNTS.get(kind, 0))
    if kind == "dining room":
        return
    long, short = (
        max(layout.inner.width, layout.inner.depth),
        min(layout.inner.width, layout.inner.depth),
    )
    if long > 2.4 * short:
        i = layout.inner
        for share in (0.25, 0.75):
            xy = (
                (i.x0 + i.width * share, i.centre[1])
                if i.width > i.depth
                else (i.centre[0], i.y0 + i.depth * share)
            )
            set_dressing.hang_lamp(layout, lighting.ceiling_lamp, xy)
        return
    maker = (
        lighting.chandelier
        if kind == "living room" and layout.rng.chance(0.3)
        else lighting.ceiling_lamp
    )
    set_dressing.hang_lamp(layout, maker)


HOME_FURNISHING = Furnishing(_required, _furnish, _add_set_dressing)
"""Rules by which homes are furnished."""
