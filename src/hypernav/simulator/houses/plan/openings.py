"""Doors and passages between rooms, windows and front doors, by the rules of residential design.

Paths may lead through halls, living rooms and dining rooms; through kitchens only to rooms that
belong to them; through bedrooms only to their own bathroom; never through bathrooms, storage rooms
or laundries. At least one bathroom can be reached without crossing a bedroom.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from hypernav.simulator.houses.plan.floor_plan import OUTER_M, WALL_M, Opening, Rect, Room
from hypernav.simulator.houses.random_stream import RandomStream

CASING_M = 0.1
"""Least distance of a door from the corner of a room, metres."""

DOOR_TOP_M = 2.05
PASSAGE_TOP_M = 2.25
APPROACH_M = 0.9
LEAF_M = 0.04

# Score of entering the second kind of room from the first; missing pairs are never connected.
_LINKS: dict[str, dict[str, float]] = {
    "hall": {
        "living room": 9,
        "kitchen": 7,
        "dining room": 6,
        "bedroom": 9,
        "bathroom": 9,
        "office": 9,
        "laundry": 8,
        "storage": 8,
        "hall": 9,
    },
    "living room": {
        "hall": 9,
        "dining room": 9,
        "kitchen": 8,
        "bedroom": 5,
        "office": 6,
        "bathroom": 4,
        "storage": 4,
        "laundry": 2,
    },
    "dining room": {
        "kitchen": 9,
        "hall": 6,
        "living room": 9,
        "bedroom": 3,
        "office": 4,
        "bathroom": 2,
        "storage": 4,
        "laundry": 3,
    },
    "kitchen": {"dining room": 8, "laundry": 8, "storage": 7, "living room": 7, "hall": 5},
    "bedroom": {"bathroom": 3, "storage": 2},
}


@dataclass(frozen=True)
class SharedWall:
    """Wall that two rooms share, between the inner faces of the walls at its ends."""

    low: int
    high: int
    along: str
    at: float
    start: float
    end: float

    def opening(
        self,
        kind: str,
        start: float,
        wide: float,
        top: float,
        *,
        leaf_room: int = -1,
        hinge_low: bool = True,
    ) -> Opening:
        """Opening in this wall from the floor up, ``wide`` metres from ``start`` on."""
        rooms, end = (self.low, self.high), round(start + wide, 3)
        return Opening(kind, self.along, self.at, start, end, 0.0, top, rooms, leaf_room, hinge_low)


def shared_walls(rooms: Sequence[Room]) -> list[SharedWall]:
    """All walls that two rooms share; ``low`` is the room on the side of smaller coordinates."""
    result = []
    for i, a in enumerate(rooms):
        for j, b in enumerate(rooms):
            if i == j or a.is_outside or b.is_outside:
                continue
            p, q = a.cell, b.cell
            for along, at, other, lo, hi in (
                ("y", p.x1, q.x0, max(p.y0, q.y0), min(p.y1, q.y1)),
                ("x", p.y1, q.y0, max(p.x0, q.x0), min(p.x1, q.x1)),
            ):
                if abs(at - other) < 1e-6 and hi - lo > WALL_M:
                    result.append(SharedWall(i, j, along, at, lo + WALL_M / 2, hi - WALL_M / 2))
    return result


def door_width(kind: str) -> float:
    """Clear width of a door into a kind of room, metres."""
    return {"bathroom": 0.85, "storage": 0.85, "laundry": 0.85}.get(kind, 0.9)


def find_connections(rooms: Sequence[Room]) -> list[tuple[int, int, SharedWall]] | None:
    """Connections ``(from, to, wall)`` by which every room is reached by the rules.

    Returns:
        None if no choice of doors satisfies the rules.
    """
    doorways: dict[tuple[int, int], SharedWall] = {}
    for wall in shared_walls(rooms):
        for a, b in ((wall.low, wall.high), (wall.high, wall.low)):
            if wall.end - wall.start >= door_width(rooms[b].kind) + 2 * CASING_M + 0.04:
                doorways[(a, b)] = wall
    root = next((k for k, r in enumerate(rooms) if r.kind == "hall"), 0)
    if rooms[root].kind not in _LINKS:
        return None
    reached, links = [root], []
    left = [k for k in range(len(rooms)) if k != root and not rooms[k].is_outside]
    while left:
        best, choice = 0.0, None
        for a in reached:
            for b in left:
                score = (
                    _LINKS.get(rooms[a].kind, {}).get(rooms[b].kind, 0.0)
                    if (a, b) in doorways
                    else 0.0
                )
                if score > best:
                    best, choice = score, (a, b)
        if choice is None:
            return None
        links.append((*choice, doorways[choice]))
        reached.append(choice[1])
        left.remove(choice[1])
    if not _rules_hold(rooms, links):
        return None
    return links + _extra_links(rooms, links, doorways)


def _rules_hold(rooms: Sequence[Room], links: list[tuple[int, int, SharedWall]]) -> bool:
    parents = {b: a for a, b, _ in links}
    baths = [k for k, r in enumerate(rooms) if r.kind == "bathroom"]
    if baths and all(rooms[parents[k]].kind == "bedroom" for k in baths):
        return False
    ensuites: dict[int, int] = {}
    for k in baths:
        ensuites[parents[k]] = ensuites.get(parents[k], 0) + (rooms[parents[k]].kind == "bedroom")
    kitchen = next((k for k, r in enumerate(rooms) if r.kind == "kitchen"), None)
    dining = next((k for k, r in enumerate(rooms) if r.kind == "dining room"), None)
    if kitchen is not None and dining is not None:
        near = any({kitchen, dining} == {b.low, b.high} for b in shared_walls(rooms))
        both_public = {rooms[parents.get(k, 0)].kind for k in (kitchen, dining)} <= {
            "living room",
            "hall",
            "dining room",
            "kitchen",
        }
        if not near and not both_public:
            return False
    return all(count <= 1 for count in ensuites.values())


def _extra_links(
    rooms: Sequence[Room],
    links: list[tuple[int, int, SharedWall]],
    doorways: dict[tuple[int, int], SharedWall],
) -> list[tuple[int, int, SharedWall]]:
    """Further connections between public rooms that lie side by side, as in open plans."""
    linked = {frozenset((a, b)) for a, b, _ in links}
    public = ("living room", "dining room", "kitchen")
    extra = []
    for (a, b), wall in doorways.items():
        if (
            a < b
            and rooms[a].kind in public
            and rooms[b].kind in public
            and frozenset((a, b)) not in linked
        ):
            extra.append((a, b, wall))
    return extra


def sample_doors(rng: RandomStream, rooms: Sequence[Room]) -> list[Opening] | None:
    """Random doors and passages for all connections; None if the rules allow none."""
    links = find_connections(rooms)
    if links is None:
        return None
    openings: list[Opening] = []
    for a, b, wall in links:
        opening = _fitted(rng, rooms, a, b, wall, openings)
        if opening is None:
            return None
        openings.append(opening)
    return openings


def _fitted(
    rng: RandomStream,
    rooms: Sequence[Room],
    a: int,
    b: int,
    wall: SharedWall,
    others: Sequence[Opening],
) -> Opening | None:
    """Door on the shared wall whose leaf and approach are free of other doors."""
    kinds = {rooms[a].kind, rooms[b].kind}
    length = wall.end - wall.start
    public = kinds <= {"living room", "dining room", "kitchen"}
    if public and length > 1.9 and rng.chance(0.8):
        wide = min(rng.uniform(1.2, 2.4, 0.05), length - 0.5)
        start = round(wall.start + (length - wide) * rng.uniform(0.35, 0.65), 3)
        return wall.opening("passage", start, wide, PASSAGE_TOP_M)
    wide = door_width(rooms[b].kind)
    private = b if rooms[b].kind not in ("living room", "dining room", "kitchen", "hall") else -1
    with_leaf = private >= 0 and rng.chance(0.75)
    return hang_door(rng, rooms, wall, wide, private if with_leaf else -1, others)


def hang_door(
    rng: RandomStream,
    rooms: Sequence[Room],
    wall: SharedWall,
    wide: float,
    leaf_room: int,
    others: Sequence[Opening],
) -> Opening | None:
    """Door at a random position of a shared wall whose leaf and approach are free of other doors.

    Args:
        rng: Source of randomness.
        rooms: All rooms.
        wall: Wall to put it in.
        wide: Clear width, metres.
        leaf_room: Index of the room that its leaf should open into; -1 for a frame only.
        others: Existing doors.
    """
    length = wall.end - wall.start
    for attempt in range(12):
        room_left = length - wide - 2 * CASING_M
        where = rng.choice((0.0, 1.0)) if attempt < 8 and rng.chance(0.8) else rng.unit()
        start = round(wall.start + CASING_M + room_left * where, 3)
        leaf = leaf_room if attempt < 9 else -1
        kind = "door" if leaf >= 0 else "doorway"
        door = wall.opening(kind, start, wide, DOOR_TOP_M, leaf_room=leaf, hinge_low=where < 0.5)
        if not any(collide(door, other) for other in others) and _leaf_fits(door, rooms):
            return door
    return None


def leaf_rect(door: Opening) -> Rect | None:
    """Rectangle of the open leaf: at right angles to its wall, just outside of the opening."""
    if door.leaf_room < 0:
        return None
    upper = door.leaf_room == door.rooms[1]
    near, far = WALL_M / 2 + 0.017, WALL_M / 2 + 0.017 + door.width - 0.01
    low, high = (near, far) if upper else (-far, -near)
    a = door.start - LEAF_M + 0.005 if door.hinge_low else door.end - 0.005
    if door.along == "x":
        return Rect(a, door.at + low, a + LEAF_M, door.at + high)
    return Rect(door.at + low, a, door.at + high, a + LEAF_M)


def approach(door: Opening, *, margin: float = 0.0, deep: float = APPROACH_M) -> Rect:
    """Floor on both sides of a door that must stay free."""
    return door.strip(-deep, deep, margin)


def collide(a: Opening, b: Opening) -> bool:
    """Whether two doors or their open leaves collide."""
    la, lb = leaf_rect(a), leaf_rect(b)
    if la is not None and la.overlaps(approach(b, deep=1.0), 0.02):
        return True
    if lb is not None and lb.overlaps(approach(a, deep=1.0), 0.02):
        return True
    if la is not None and lb is not None and la.overlaps(lb, 0.05):
        return True
    return (
        a.along == b.along
        and abs(a.at - b.at) < 1e-6
        and a.start < b.end + 0.25
        and b.start < a.end + 0.25
    )


def _leaf_fits(door: Opening, rooms: Sequence[Room]) -> bool:
    leaf = leaf_rect(door)
    return leaf is None or rooms[door.leaf_room].inner.grown(-0.004).holds(leaf)


class OuterWall(NamedTuple):
    """Segment of a room's wall that faces outside, between corners of the cell or of neighbours.

    Attributes:
        along: Axis that it runs along, "x" or "y".
        at: Coordinate of its centre line.
        start: Lower end along the wall.
        end: Upper end along the wall.
        side: -1 if the outside is on the side of smaller coordinates, else 1.
    """

    along: str
    at: float
    start: float
    end: float
    side: int

    def opening(
        self,
        kind: str,
        room: int,
        start: float,
        wide: float,
        bottom: float,
        top: float,
        outside: int = -1,
    ) -> Opening:
        """Opening in this wall of a room, ``wide`` metres from ``start`` on."""
        rooms = (outside, room) if self.side < 0 else (room, outside)
        end = round(start + wide, 3)
        return Opening(kind, self.along, self.at, start, end, bottom, top, rooms)


def outer_walls(rooms: Sequence[Room], number: int) -> list[OuterWall]:
    """Segments of a room's walls that face outside."""
    c = rooms[number].cell
    result = []
    for along, at, start, end, side in (
        ("x", c.y0, c.x0, c.x1, -1),
        ("x", c.y1, c.x0, c.x1, 1),
        ("y", c.x0, c.y0, c.y1, -1),
        ("y", c.x1, c.y0, c.y1, 1),
    ):
        free = [(start, end)]
        for k, other in enumerate(rooms):
            if k == number or other.is_outside:
                continue
            o = other.cell
            facing = (o.y1 if side < 0 else o.y0) if along == "x" else (o.x1 if side < 0 else o.x0)
            if abs(facing - at) > 1e-6:
                continue
            lo, hi = (o.x0, o.x1) if along == "x" else (o.y0, o.y1)
            free = [
                piece
                for a, b in free
                for piece in ((a, min(b, lo)), (max(a, hi), b))
                if piece[1] - piece[0] > 0.01
            ]
        result += [OuterWall(along, at, a, b, side) for a, b in free]
    return result


def sample_balcony(
    rng: RandomStream, rooms: tuple[Room, ...], openings: Sequence[Opening]
) -> tuple[tuple[Room, ...], Opening | None]:
    """Rooms with a random balcony at the living room or a bedroom, and the balcony's door."""
    hosts = [k for k, r in enumerate(rooms) if r.kind == "living room"]
    hosts += [k for k, r in enumerate(rooms) if r.kind == "bedroom"]
    for host in hosts:
        for wall in rng.shuffled(outer_walls(rooms, host)):
            along, at, start, end, side = wall
            if end - start < 2.6:
                continue
            long = min(end - start, rng.uniform(2.6, 4.2, 0.05))
            first = round(start + (end - start - long) * rng.choice((0.0, 0.5, 1.0)), 3)
            deep = rng.uniform(1.55, 1.9, 0.05)
            near, far = sorted(
                (at + side * (OUTER_M - WALL_M / 2), at + side * (OUTER_M - WALL_M / 2 + deep))
            )
            cell = (
                Rect(first, near, first + long, far)
                if along == "x"
                else Rect(near, first, far, first + long)
            )
            if any(cell.grown(0.3).overlaps(r.cell) and k != host for k, r in enumerate(rooms)):
                continue
            door_start = round(first + (long - 1.0) * rng.uniform(0.3, 0.7), 3)
            door = wall.opening("glass door", host, door_start, 0.95, 0.0, 2.1, len(rooms))
            front_doors = [o for o in openings if o.kind == "entrance"]
            if not is_free(door, openings) or any(
                cell.grown(0.2).overlaps(approach(o)) for o in front_doors
            ):
                continue
            return (*rooms, Room("balcony", "balcony", cell)), door
    return rooms, None


def sample_entrance(
    rng: RandomStream,
    rooms: Sequence[Room],
    openings: Sequence[Opening],
    kinds: Sequence[str] = ("hall", "living room", "dining room", "kitchen"),
) -> Opening | None:
    """Closed front door in an outer wall of a room of the first kind that has space for it."""
    for kind in kinds:
        for number, room in enumerate(rooms):
            if room.kind != kind:
                continue
            for wall in rng.shuffled(outer_walls(rooms, number)):
                if wall.end - wall.start < 1.0 + 2 * WALL_M + 0.1:
                    continue
                low, high = wall.start + WALL_M / 2 + 0.06, wall.end - WALL_M / 2 - 1.01
                for where in (0.5, 0.0, 1.0, 0.25, 0.75):
                    first = round(low + (high - low) * where, 3)
                    door = wall.opening("entrance", number, first, 0.95, 0.0, DOOR_TOP_M)
                    if is_free(door, openings):
                        return door
    return None


def sample_windows(
    rng: RandomStream, rooms: Sequence[Room], openings: Sequence[Opening], height: float
) -> list[Opening]:
    """Random windows for all rooms with outer walls."""
    windows: list[Opening] = []
    for number, room in enumerate(rooms):
        if room.is_outside or room.kind in ("hall", "storage"):
            continue
        placed = 0
        most = {"living room": 3, "bathroom": 1, "laundry": 1}.get(room.kind, 2)
        for wall in outer_walls(rooms, number):
            start, end = wall.start, wall.end
            if placed >= most or end - start < 1.0:
                continue
            if room.kind in ("bathroom", "laundry"):
                wide, bottom, top = 0.6, 1.35, 2.05
                if rng.chance(0.4):
                    continue
            else:
                wide = min(rng.uniform(1.1, 1.9, 0.05), end - start - 0.7)
                bottom, top = (1.15 if room.kind == "kitchen" else 0.9), min(2.15, height - 0.3)
            if wide < 0.5:
                continue
            count = 2 if end - start > 4.6 and room.kind != "bathroom" and placed + 2 <= most else 1
            for k in range(count):
                middle = start + (end - start) * (k + 0.5) / count
                first = round(middle - wide / 2, 3)
                window = wall.opening("window", number, first, wide, bottom, top)
                if is_free(window, (*openings, *windows)):
                    windows.append(window)
                    placed += 1
    return windows


def is_free(new: Opening, others: Sequence[Opening]) -> bool:
    """Whether an opening in an outer wall collides with no other one."""
    for other in others:
        same_wall = new.along == other.along and abs(new.at - other.at) < 0.3
        if same_wall and new.start < other.end + 0.15 and other.start < new.end + 0.15:
            return False
        leaf = leaf_rect(other)
        if (
            new.kind == "window"
            and leaf is not None
            and leaf.overlaps(new.strip(-0.25, 0.25, 0.08), 0.02)
        ):
            return False
        if new.kind == "entrance" and leaf is not None and leaf.overlaps(approach(new), 0.05):
            return False
    return True
