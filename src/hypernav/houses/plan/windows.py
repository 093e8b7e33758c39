"""Openings in the outer walls: windows, the entrance, the balcony's door."""

from collections.abc import Sequence

from hypernav.houses.plan.doors import approach, leaf_rect
from hypernav.houses.plan.shapes import OUTER_M, WALL_M, Opening, Rect, Room
from hypernav.houses.random_stream import RandomStream


def outer_walls(rooms: Sequence[Room], number: int) -> list[tuple[str, float, float, float, int]]:
    """Segments of a room's walls that face outside: ``(along, at, start, end, side)``.

    ``side`` is -1 if the outside is on the side of smaller coordinates, else 1. Start and end are
    the corners of the cell or of the neighbours.
    """
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
        result += [(along, at, a, b, side) for a, b in free]
    return result


def sample_balcony(
    rng: RandomStream, rooms: tuple[Room, ...], openings: Sequence[Opening]
) -> tuple[tuple[Room, ...], Opening | None]:
    """Rooms with a random balcony at the living room or a bedroom, and the balcony's door."""
    hosts = [k for k, r in enumerate(rooms) if r.kind == "living room"]
    hosts += [k for k, r in enumerate(rooms) if r.kind == "bedroom"]
    for host in hosts:
        for along, at, start, end, side in rng.shuffled(outer_walls(rooms, host)):
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
            ids = (len(rooms), host) if side < 0 else (host, len(rooms))
            door = Opening(
                "glass door", along, at, door_start, round(door_start + 0.95, 3), 0.0, 2.1, ids
            )
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
            for along, at, start, end, side in rng.shuffled(outer_walls(rooms, number)):
                if end - start < 1.0 + 2 * WALL_M + 0.1:
                    continue
                low, high = start + WALL_M / 2 + 0.06, end - WALL_M / 2 - 1.01
                for where in (0.5, 0.0, 1.0, 0.25, 0.75):
                    first = round(low + (high - low) * where, 3)
                    ids = (-1, number) if side < 0 else (number, -1)
                    door = Opening(
                        "entrance", along, at, first, round(first + 0.95, 3), 0.0, 2.05, ids
                    )
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
        for along, at, start, end, side in outer_walls(rooms, number):
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
                ids = (-1, number) if side < 0 else (number, -1)
                window = Opening(
                    "window", along, at, first, round(first + wide, 3), bottom, top, ids
                )
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
