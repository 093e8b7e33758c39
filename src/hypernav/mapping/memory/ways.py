"""Ways over stairs from floor to floor, as far as a memory knows them."""

import math
from collections.abc import Callable, Mapping

from hypernav.core.exploring.floors import KnownFloor, WayOut
from hypernav.mapping.memory.connectors import Connector
from hypernav.mapping.memory.floor import Floor, SearchMemory
from hypernav.mapping.memory.memory import Memory
from hypernav.mapping.memory.thing import is_in_room

_UNDERFOOT_M = 1.5
"""Greatest distance of a robot on the first steps of stairs from where they seem to end, metres."""
_LEAST_STOREY_M = 1.6
_MOST_STOREY_M = 4.5
"""Heights between floors, metres, that have no other floor between them."""


def ways_to_new_floors(memory: Memory) -> list[WayOut]:
    """The stairs here that nobody has taken, towards floors that the robot knows no way to.

    Others most likely lead to the next floor up or down that it does know a way to: a second
    flight in the well of the stairs that it came by, say.
    """
    leading_on = _leading_on_from(memory, memory.number)
    return [_way_over(memory, number) for number in leading_on if memory.connectors[number].is_new]


def ways_to_unseen(memory: Memory) -> list[WayOut]:
    """The stairs here to new stairs, or floors that no search has explored to their end.

    As everywhere here, only those on the way over the fewest stairs: a robot that always took the
    nearest ones might go to and fro.
    """
    return _ways_to(memory, lambda floor: not floor.was_explored)


def ways_out(memory: Memory) -> list[WayOut]:
    """The ways to what is unseen; where there are none, those to floors this search left early.

    Last come new stairs here that most likely lead to a floor that the robot knows.
    """
    return (
        ways_to_unseen(memory)
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


def ways_to_sighting(memory: Memory) -> list[WayOut]:
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
    return number if away_m <= _UNDERFOOT_M else None


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
    """Whether the robot knows a way to a floor one storey above or below this one."""
    sign = 1.0 if goes_up else -1.0
    away_m = [sign * (memory.floors[one].z - floor.z) for one in routes_from_here(memory)]
    return any(_LEAST_STOREY_M <= one <= _MOST_STOREY_M for one in away_m)


def _way_over(memory: Memory, number: int) -> WayOut:
    one = memory.connectors[number]
    return WayOut(number, *one.approach, words=one.words, axis=one.axis, to=one.other_floor)


def _ways_to(memory: Memory, is_wanted: Callable[[Floor], bool]) -> list[WayOut]:
    """The stairs here on the way over the fewest stairs to new stairs, or to a floor like that."""
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
