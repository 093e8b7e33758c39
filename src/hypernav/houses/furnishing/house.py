"""Furnishing of all rooms of a house, one after the other."""

from collections.abc import Sequence

from hypernav.houses.assembly import PlacedModel
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
from hypernav.houses.materials import Palette, vary
from hypernav.houses.objects.devices import lighting
from hypernav.houses.placement.room_layout import RoomLayout
from hypernav.houses.placement.visibility import remove_hidden
from hypernav.houses.plan.shapes import FloorPlan
from hypernav.houses.random_stream import RandomStream

_PICTURE_COUNTS = {
    "living room": 3,
    "bedroom": 2,
    "hall": 2,
    "dining room": 2,
    "office": 2,
    "kitchen": 1,
}


_REQUIRED: dict[str, tuple[tuple[str, ...], ...]] = {
    "living room": (("sofa",), ("tv",), ("coffee table",)),
    "kitchen": (("refrigerator",), ("oven",), ("sink",)),
    "bathroom": (("toilet",), ("sink",), ("bathtub", "shower")),
    "bedroom": (("bed",), ("wardrobe", "dresser")),
    "dining room": (("dining table",), ("chair",)),
    "office": (("desk",), ("chair",)),
    "laundry": (("washing machine",),),
}
"""Categories that a kind of room must hold: at least one of each group."""

_ATTEMPTS = 12


def furnish_rooms(plan: FloorPlan, palette: Palette, rng: RandomStream) -> list[PlacedModel]:
    """Random furniture and other objects of all rooms."""
    kinds = [room.kind for room in plan.rooms]
    pieces: list[PlacedModel] = []
    for number, room in enumerate(plan.rooms):
        own = rng.fork("room", number)
        layout = _best_layout(plan, number, own, vary(palette, own.fork("taste")), kinds)
        if not room.is_outside:
            _add_set_dressing(layout)
        remove_hidden(layout)
        pieces += layout.placed
    return pieces


def _best_layout(
    plan: FloorPlan, number: int, rng: RandomStream, palette: Palette, kinds: Sequence[str]
) -> RoomLayout:
    """Layout of a room with all required objects, or the best of several attempts."""
    kind = plan.rooms[number].kind
    required = _REQUIRED.get(kind, ())
    if (kind == "living room" and _dines_here(kinds, plan)) or (
        kind == "kitchen" and "dining room" not in kinds and _kitchen_is_large(plan)
    ):
        required = (*required, ("dining table",), ("chair",))
    best: tuple[int, RoomLayout] | None = None
    for attempt in range(_ATTEMPTS):
        layout = RoomLayout(plan, number, rng.fork("attempt", attempt), palette)
        _furnish(layout, kinds)
        there = {p.model.category for p in layout.placed}
        score = sum(any(name in there for name in group) for group in required)
        if best is None or score > best[0]:
            best = (score, layout)
        if score == len(required):
            break
    assert best is not None
    return best[1]


def _furnish(layout: RoomLayout, kinds: Sequence[str]) -> None:
    kind = layout.room.kind
    rng = layout.rng
    has_dining, has_kitchen = "dining room" in kinds, "kitchen" in kinds
    kitchen_table = not has_dining and has_kitchen and _kitchen_is_large(layout.plan)
    if kind == "living room":
        if not has_kitchen:
            kitchen.place_units(layout)
        living_room.furnish_living_room(layout, with_dining=_dines_here(kinds, layout.plan))
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


def _dines_here(kinds: Sequence[str], plan: FloorPlan) -> bool:
    """Whether the dining table belongs in the living room."""
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
