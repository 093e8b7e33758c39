"""All rooms of a house, furnished one after the other."""

from collections.abc import Sequence

from hypernav.houses.assembly import Placed
from hypernav.houses.dice import Dice
from hypernav.houses.furnish import bathroom, bedroom, dining, dressing, kitchen, living, other
from hypernav.houses.furnish.sight import remove_unseen
from hypernav.houses.furnish.site import Site
from hypernav.houses.furniture.devices import lighting
from hypernav.houses.palette import Taste, vary
from hypernav.houses.plan.shapes import FloorPlan

_PICTURES = {"living room": 3, "bedroom": 2, "hall": 2, "dining room": 2, "office": 2, "kitchen": 1}


_NEEDED: dict[str, tuple[tuple[str, ...], ...]] = {
    "living room": (("sofa",), ("tv",), ("coffee table",)),
    "kitchen": (("refrigerator",), ("oven",), ("sink",)),
    "bathroom": (("toilet",), ("sink",), ("bathtub", "shower")),
    "bedroom": (("bed",), ("wardrobe", "dresser")),
    "dining room": (("dining table",), ("chair",)),
    "office": (("desk",), ("chair",)),
    "laundry": (("washing machine",),),
}
"""What a room is not that room without: one of each group."""

_ATTEMPTS = 12


def furnish_rooms(plan: FloorPlan, taste: Taste, dice: Dice) -> list[Placed]:
    """Everything that stands, lies and hangs in the rooms."""
    kinds = [room.kind for room in plan.rooms]
    pieces: list[Placed] = []
    for number, room in enumerate(plan.rooms):
        own = dice.fork("room", number)
        site = _best_site(plan, number, own, vary(taste, own.fork("taste")), kinds)
        if not room.is_outside:
            _dress(site)
        remove_unseen(site)
        pieces += site.placed
    return pieces


def _best_site(
    plan: FloorPlan, number: int, dice: Dice, taste: Taste, kinds: Sequence[str]
) -> Site:
    """A room furnished anew until nothing that it needs is missing, or the best of a few tries."""
    kind = plan.rooms[number].kind
    needed = _NEEDED.get(kind, ())
    if (kind == "living room" and _dines_here(kinds, plan)) or (
        kind == "kitchen" and "dining room" not in kinds and _kitchen_is_large(plan)
    ):
        needed = (*needed, ("dining table",), ("chair",))
    best: tuple[int, Site] | None = None
    for attempt in range(_ATTEMPTS):
        site = Site(plan, number, dice.fork("attempt", attempt), taste)
        _furnish(site, kinds)
        there = {p.model.category for p in site.placed}
        score = sum(any(name in there for name in group) for group in needed)
        if best is None or score > best[0]:
            best = (score, site)
        if score == len(needed):
            break
    assert best is not None
    return best[1]


def _furnish(site: Site, kinds: Sequence[str]) -> None:
    kind = site.room.kind
    dice = site.dice
    has_dining, has_kitchen = "dining room" in kinds, "kitchen" in kinds
    kitchen_table = not has_dining and has_kitchen and _kitchen_is_large(site.plan)
    if kind == "living room":
        if not has_kitchen:
            kitchen.place_units(site)
        living.furnish_living(site, with_dining=_dines_here(kinds, site.plan))
    elif kind == "dining room":
        dining.furnish_dining(site)
    elif kind == "kitchen":
        kitchen.furnish_kitchen(site, table=kitchen_table)
    elif kind == "bedroom":
        bedroom.furnish_bedroom(site, first=site.room.name in ("bedroom", "bedroom 1"))
    elif kind == "bathroom":
        bathroom.furnish_bathroom(site, with_washer="laundry" not in kinds and dice.chance(0.6))
    elif kind == "office":
        bedroom.furnish_office(site)
    elif kind == "laundry":
        kitchen.furnish_laundry(site)
    elif kind == "hall":
        other.furnish_hall(site)
    elif kind == "storage":
        other.furnish_storage(site)
    elif kind == "balcony":
        other.furnish_balcony(site)


def _dines_here(kinds: Sequence[str], plan: FloorPlan) -> bool:
    """Whether the dining table belongs into the living room."""
    return "dining room" not in kinds and ("kitchen" not in kinds or not _kitchen_is_large(plan))


def _kitchen_is_large(plan: FloorPlan) -> bool:
    room = next(r for r in plan.rooms if r.kind == "kitchen")
    return min(room.inner.width, room.inner.depth) > 2.75 and room.inner.area > 11.0


def _dress(site: Site) -> None:
    kind = site.room.kind
    dressing.put_radiators(site)
    if kind not in ("kitchen", "bathroom", "laundry", "storage"):
        dressing.hang_curtains(site)
    dressing.hang_pictures(site, _PICTURES.get(kind, 0))
    if kind == "dining room":
        return
    long, short = max(site.inner.width, site.inner.depth), min(site.inner.width, site.inner.depth)
    if long > 2.4 * short:
        i = site.inner
        for share in (0.25, 0.75):
            xy = (
                (i.x0 + i.width * share, i.centre[1])
                if i.width > i.depth
                else (i.centre[0], i.y0 + i.depth * share)
            )
            dressing.hang_lamp(site, lighting.ceiling_lamp, xy)
        return
    maker = (
        lighting.chandelier
        if kind == "living room" and site.dice.chance(0.3)
        else lighting.ceiling_lamp
    )
    dressing.hang_lamp(site, maker)
