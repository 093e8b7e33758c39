"""Where a robot can leave its floor: known stairs, and edges at which stairs down may begin."""

import math
from collections.abc import Callable, Mapping, Sequence

import cv2
import numpy as np
from jaxtyping import Bool, Float64, Int64

from hypernav.core.exploring.floors import Drop, KnownFloor, WayOut
from hypernav.search.mapping.elevation_map import SAME_STOREY_M, reach
from hypernav.search.mapping.inflation import distance_from
from hypernav.search.mapping.stairs.connectors import Connector
from hypernav.search.mapping.stairs.flights import BEGINS_M
from hypernav.search.memory.floor import Floor, SearchMemory
from hypernav.search.memory.memory import Memory
from hypernav.search.memory.thing import is_in_room

_MOST_STOREY_M = 4.5
"""Height between two floors, metres, above which there is another one between them."""

_PATCH_M = 0.2
"""Side of the patches that edges of the floor are made of, metres."""
_EDGE_PATCHES = 2
"""Least number of patches in an edge at which stairs may begin."""
_NEAR_M = 1.5
"""Distance from which the robot sees whether stairs begin at an edge, metres."""
BEFORE_M = 0.8
"""Distance from stairs, metres, within which a robot stands before them, not clear of them."""
_ALONG = math.radians(30.0)
"""Angle from the direction of stairs up to which it looks along them."""
_IN_SIGHT_M = 8.0
"""Distance from which images hardly show edges, metres."""


def stairs_to_new_floors(memory: Memory) -> list[WayOut]:
    """The stairs here that nobody has taken, towards floors that the robot knows no path to.

    Others most likely lead to the next floor up or down that it does know a path to: a second
    flight in the well of the stairs that it came by, say.
    """
    leading_on = _leading_on_from(memory, memory.number)
    return [_way_over(memory, number) for number in leading_on if memory.connectors[number].is_new]


def stairs_to_unseen(memory: Memory) -> list[WayOut]:
    """The stairs here to new stairs, or floors that no search has explored to their end.

    As everywhere here, only those on the path over the fewest stairs: a robot that always took the
    nearest ones might go to and fro.
    """
    return _ways_to(memory, lambda floor: not floor.was_explored)


def ways_out(memory: Memory) -> list[WayOut]:
    """The paths to what is unseen; where there are none, those to floors this search left early.

    Last come new stairs here that most likely lead to a floor that the robot knows.
    """
    return (
        stairs_to_unseen(memory)
        or _ways_to(memory, lambda floor: not floor.search.is_explored)
        or [_way_over(memory, number) for number in _new_from_here(memory)]
    )


def seen_from_elsewhere(memory: Memory) -> tuple[float, float] | None:
    """Where ``(x, y)`` on this floor the goal was seen from another, metres; None if nowhere."""
    here = (at for _, at, floor in _off_floors(memory) if floor == memory.number)
    return next(((x, y) for x, y, _ in here), None)


def forget_seen_from_elsewhere(memory: Memory, position: tuple[float, float]) -> None:
    """Forget that the goal was seen from another floor at a position on this one, metres."""
    for search, (x, y, _), floor in _off_floors(memory):
        if floor == memory.number and (x, y) == position:
            search.seen_off_floor, search.went_off_floor = None, True


def stairs_to_sighting(memory: Memory) -> list[WayOut]:
    """The stairs here towards a floor on which the goal was seen from another one.

    The robot has taken them before, or they are new and lead up or down as the goal lies.
    """
    known = {one.number: one for one in known_floors(memory)}
    for _, (_, _, z), floor in _off_floors(memory):
        if floor in known:
            return [known[floor].way[0]]
        if floor is None:
            stairs = _new_from_here(memory)
            new = [one for one in stairs if memory.connectors[one].goes_up == (z > 0.0)]
            if new:
                return [_way_over(memory, one) for one in new]
    return []


def _off_floors(
    memory: Memory,
) -> list[tuple[SearchMemory, tuple[float, float, float], int | None]]:
    """Where the goal was seen on another floor, and the number of that floor, None if not known.

    It is the next floor up or down with a room that reaches as far as the goal, or farther: a line
    of sight tells how far at least the goal lies up or down.

    Returns:
        For each floor from which it was seen, what was learned there, the position ``(x, y, z)``,
        heights from that floor, metres, and the number.
    """
    seen = [(floor, floor.search.seen_off_floor) for floor in memory.floors]
    return [
        (floor.search, position, _next_floor(memory, floor.z, position[2]))
        for floor, position in seen
        if position is not None
    ]


def _next_floor(memory: Memory, from_z: float, height_m: float) -> int | None:
    """Number of the next floor from a height on that has what lies so far above or below it."""
    sign = math.copysign(1.0, height_m)
    reaching = [
        (sign * (one.z - from_z), number)
        for number, one in enumerate(memory.floors)
        if sign * (one.z - from_z) > 0.0
        and (is_in_room(from_z + height_m - one.z) or sign * (from_z + height_m - one.z) < 0.0)
    ]
    return min(reaching)[1] if reaching else None


def known_floors(memory: Memory) -> list[KnownFloor]:
    """The other floors that stairs which the robot has taken lead to, the fewest stairs first."""
    return [
        _known_floor(memory, floor, route)
        for floor, route in routes_from_here(memory).items()
        if route
    ]


def routes_from_here(memory: Memory) -> dict[int, tuple[int, ...]]:
    """The `routes` over the stairs that the present search has not given up."""
    open_ones = {
        number: memory.connectors[number]
        for floor in range(len(memory.floors))
        for number in _open_from(memory, floor)
    }
    return routes(memory.number, open_ones)


def routes(start: int, stairs: Mapping[int, Connector]) -> dict[int, tuple[int, ...]]:
    """Numbers of the stairs to take to each floor that they lead to, the fewest stairs first.

    Args:
        start: Number of the floor to begin on; it is the first, with no stairs to take.
        stairs: The stairs that may be taken, by number.
    """
    found: dict[int, tuple[int, ...]] = {start: ()}
    queue = [start]
    for floor in queue:
        for number, one in stairs.items():
            other = one.other_floor
            if one.floor == floor and other is not None and other not in found:
                found[other] = (*found[floor], number)
                queue.append(other)
    return found


def stairs_underfoot(memory: Memory, position: tuple[float, float]) -> int | None:
    """Number of the stairs that a robot off its floor must be on; None if it knows of none there.

    Args:
        memory: What it knows, its height included.
        position: Where it is ``(x, y)``, metres.
    """
    here = [
        (math.dist(memory.connectors[k].end, position), k)
        for k in _open_from(memory, memory.number)
        if memory.connectors[k].goes_up == (memory.footing.z > memory.footing.ground_z)
    ]
    away_m, number = min(here, default=(math.inf, None))
    return number if away_m <= BEGINS_M else None


def _known_floor(memory: Memory, number: int, route: tuple[int, ...]) -> KnownFloor:
    floor, last = memory.floors[number], memory.connectors[route[-1]]
    back = [
        one.approach
        for one in memory.connectors
        if (one.floor, one.other_floor) == (number, last.floor)
    ]
    return KnownFloor(
        number,
        floor.z - memory.floor.z,
        floor.map.grid,
        floor.trajectory,
        floor.search.visits,
        floor.sightings.things,
        stairs=[_way_over(memory, k) for k in _leading_on_from(memory, number)],
        way=tuple(_way_over(memory, k) for k in route),
        arrival=min(back, key=lambda one: math.dist(one, last.beyond), default=last.beyond),
        notes=floor.search.notes,
        was_explored=floor.was_explored or floor.search.is_explored,
    )


def _open_from(memory: Memory, floor: int) -> list[int]:
    """Numbers of the connectors of a floor that the robot may take."""
    search = memory.floors[floor].search
    closed = search.given_up | search.unreached
    return [
        number
        for number, one in enumerate(memory.connectors)
        if one.floor == floor and one.is_usable and number not in closed
    ]


def _new_from_here(memory: Memory) -> list[int]:
    """Numbers of the connectors of this floor of which nobody knows where they lead."""
    here = _open_from(memory, memory.number)
    return [number for number in here if memory.connectors[number].is_new]


def _leading_on_from(memory: Memory, floor: int) -> list[int]:
    """Those that the robot may take, without new ones that most likely lead to a known floor."""
    return [
        number
        for number in _open_from(memory, floor)
        if not (one := memory.connectors[number]).is_new
        or not knows_next_floor(memory, memory.floors[floor], goes_up=one.goes_up)
    ]


def knows_next_floor(memory: Memory, floor: Floor, *, goes_up: bool) -> bool:
    """Whether the robot knows a path to a floor one storey above or below this one."""
    sign = 1.0 if goes_up else -1.0
    away_m = [sign * (memory.floors[one].z - floor.z) for one in routes_from_here(memory)]
    return any(SAME_STOREY_M <= one <= _MOST_STOREY_M for one in away_m)


def _way_over(memory: Memory, number: int) -> WayOut:
    one = memory.connectors[number]
    return WayOut(number, *one.approach, words=one.words, axis=one.axis, to=one.other_floor)


def _ways_to(memory: Memory, is_wanted: Callable[[Floor], bool]) -> list[WayOut]:
    """The stairs here on the path over the fewest stairs to new stairs, or to a floor like that."""
    counts = {
        number: _stairs_to(memory, number, is_wanted)
        for number in _leading_on_from(memory, memory.number)
    }
    fewest = min(counts.values(), default=math.inf)
    return [
        _way_over(memory, number) for number, count in counts.items() if count == fewest < math.inf
    ]


def _stairs_to(memory: Memory, first: int, is_wanted: Callable[[Floor], bool]) -> float:
    """Number of stairs, `first` and the new ones included, on that way; inf if there is none."""
    known = {memory.number}
    queue = [(first, 1)]
    for number, count in queue:
        other = memory.connectors[number].other_floor
        if other is None or (other not in known and is_wanted(memory.floors[other])):
            return count
        if other not in known:
            known.add(other)
            queue += [(further, count + 1) for further in _leading_on_from(memory, other)]
    return math.inf


def drops_to_look_at(memory: Memory) -> list[Drop]:
    """Where the floor of a climbing robot ends, as it does at the head of stairs.

    From afar images show that floor is missing, but not whether stairs lead down there. What the
    robot has looked at from near is left out, and so are edges at stairs that it knows, up or down,
    and those behind a railing. Stairs down that were seen too seldom to rely on are looked at, too,
    from before them. There are none where it knows a path to the next floor down: most of them are
    the well of these stairs.

    Returns:
        Such stairs, and for each edge the position on it that is nearest to where the robot has
        been.
    """
    if knows_next_floor(memory, memory.floor, goes_up=False):
        return []
    known = [one for one in memory.connectors if one.floor == memory.number]
    stairs = [one for one in known if one.is_doubtful and not one.goes_up]
    touches = _are_in_reach(memory, np.array([one.approach for one in stairs]).reshape(-1, 2))
    edges = [
        Drop(x, y)
        for x, y in _new_edges(memory)
        if all(math.dist((x, y), one.end) > _NEAR_M for one in known)
    ]
    new = [
        Drop(*one.end, one.axis)
        for one, is_in_reach in zip(stairs, touches, strict=True)
        if is_in_reach and not _was_looked_down(memory, one)
    ]
    return new + edges


def _new_edges(memory: Memory) -> list[tuple[float, float]]:
    """For each edge that the robot has not looked at, the position nearest to where it has been."""
    edges = memory.floor.map.edges_to_drops()
    edges = np.unique(np.floor(edges[_are_in_reach(memory, edges)] / _PATCH_M), axis=0)
    patches = edges[~_seen_from_near(memory, _PATCH_M * (edges + 0.5))]
    if len(patches) < _EDGE_PATCHES:
        return []
    been_m = _distances_m(patches, memory.floor.trajectory)
    nearest = [patches[edge[been_m[edge].argmin()]] for edge in _edges(patches)]
    return [(float(_PATCH_M * (x + 0.5)), float(_PATCH_M * (y + 0.5))) for x, y in nearest]


def _was_looked_down(memory: Memory, stairs: Connector) -> bool:
    """Whether the robot has stood before stairs in this search and looked along them."""
    return any(
        one.distance_to(*stairs.end) <= BEFORE_M
        and math.cos(one.yaw - stairs.axis) >= math.cos(_ALONG)
        for one in memory.search.views
    )


def _seen_from_near(memory: Memory, places: Float64[np.ndarray, "n 2"]) -> Bool[np.ndarray, " n"]:
    """Whether the robot has looked at each of some places, or been near it in an earlier search."""
    been, views = np.array(memory.floor.trajectory).reshape(-1, 2), memory.search.views
    to_x, to_y = (places[:, axis, None] - been[:, axis] for axis in (0, 1))
    looked = np.asarray(np.hypot(to_x, to_y) <= _NEAR_M)
    first = len(been) - len(views)
    off = np.arctan2(to_y, to_x)[:, first:] - [one.yaw for one in views]
    half = math.radians(memory.embodiment.camera.hfov_deg) / 2.0
    looked[:, first:] &= np.cos(off) >= math.cos(half)
    return np.asarray(looked.any(axis=1))


def _are_in_reach(memory: Memory, places: Float64[np.ndarray, "n 2"]) -> Bool[np.ndarray, " n"]:
    """Whether the robot's body could touch each of some places ``(x, y)``, metres."""
    floor, radius_m = memory.floor, memory.embodiment.body.radius_m
    touches = np.zeros(len(places), dtype=bool)
    if len(places) == 0 or not floor.trajectory:
        return touches
    grid = floor.map.grid
    away = distance_from(reach(grid, floor.trajectory[-1], radius_m))
    cells = grid.cells_of(places)
    inside = grid.contains(cells)
    touches[inside] = away[tuple(cells[inside].T)] <= radius_m / grid.resolution_m + 1.0
    return touches


def _distances_m(
    patches: Float64[np.ndarray, "n 2"], positions: Sequence[tuple[float, float]]
) -> Float64[np.ndarray, "n"]:
    """Distance of each patch from the nearest of the positions in sight of any, metres."""
    margin = math.ceil(_IN_SIGHT_M / _PATCH_M)
    first = patches.min(axis=0) - margin
    shape = (patches.max(axis=0) - first).astype(np.int64) + margin + 1
    at = np.floor(np.array(positions).reshape(-1, 2) / _PATCH_M) - first
    at = at[((at >= 0) & (at < shape)).all(axis=1)].astype(np.int64)
    there = np.zeros(shape, dtype=bool)
    there[tuple(at.T)] = True
    away_m = _PATCH_M * distance_from(there)
    return away_m[tuple((patches - first).astype(np.int64).T)].astype(np.float64)


def _edges(patches: Float64[np.ndarray, "n 2"]) -> list[Int64[np.ndarray, "_"]]:
    """Numbers of the patches of each connected edge that may be as long as stairs are wide."""
    if len(patches) == 0:
        return []
    at = (patches - patches.min(axis=0)).astype(np.int64)
    there = np.zeros(at.max(axis=0) + 1, dtype=np.uint8)
    there[tuple(at.T)] = 1
    edge_of = cv2.connectedComponents(there, connectivity=8)[1][tuple(at.T)]
    edges = [np.flatnonzero(edge_of == k) for k in np.unique(edge_of)]
    return [edge for edge in edges if len(edge) >= _EDGE_PATCHES]
