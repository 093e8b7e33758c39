"""Stairs between storeys: straight, L-shaped with a corner landing, U-shaped with a half landing.

Some are ramps with a half landing instead. A stairwell is a room of the same place on every storey.
Its landing lies at the side of the hall; from there the stairs lead away. The floor above is left
out over the steps, so the rest of it is a gallery from which one sees the storey below.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

from hypernav.houses.plan.shapes import WALL_M, Place, Rail, Rect, Stairwell, Step
from hypernav.houses.random_stream import RandomStream

STAIR_KINDS = ("straight", "L", "U")
LEAST_RISER_M, MOST_RISER_M = 0.155, 0.195
"""Height of a step, metres."""

_HEAD_M = 1.3
"""Length of a landing at the head of stairs, metres."""
_RAMPS_SHARE = 0.12
_RAMP_SLOPE = 0.27
"""Rise of a ramp per metre: 15 degrees."""


@dataclass(frozen=True)
class StairShape:
    """Stairs away from the wall with the door: u is the distance from it, v runs along it.

    Attributes:
        kind: "straight", "L", "U" or "ramp".
        long: Extent of the stairwell along u between its walls, metres.
        wide: Extent along v, metres.
        wide_flight: Width of the steps, metres.
        landing: Extent of the landing at the door along u, metres.
        tread: Depth of a tread, metres. A flight of a ramp is one long tread.
        risers: Numbers of risers of the one or two flights; 2 for a flight of a ramp.
        pitch: Height of a storey from floor to floor, metres.
    """

    kind: str
    long: float
    wide: float
    wide_flight: float
    landing: float
    tread: float
    risers: tuple[int, ...]
    pitch: float

    @property
    def room_size(self) -> tuple[float, float]:
        """Extents of the room up to the centre lines of its walls: along u and along v, metres."""
        return self.long + WALL_M, self.wide + WALL_M


def sample_shape(rng: RandomStream, pitch: float) -> StairShape:
    """Random stairs for a height of storeys."""
    kind = rng.choice(STAIR_KINDS)
    least, most = math.ceil(pitch / MOST_RISER_M), math.floor(pitch / LEAST_RISER_M)
    risers = rng.integer(least, most)
    tread = rng.uniform(0.26, 0.29, 0.01)
    flight = rng.uniform(1.05, 1.25, 0.05)
    landing = rng.uniform(1.5, 1.8, 0.05)
    half = (risers + 1) // 2
    if rng.fork("ramp").chance(_RAMPS_SHARE):
        run = pitch / 2.0 / _RAMP_SLOPE
        long, wide = _up(landing + run + flight), _up(2 * flight + 0.1)
        return StairShape("ramp", long, wide, flight, landing, round(run, 3), (2, 2), pitch)
    if kind == "straight":
        long = landing + (risers - 1) * tread + _HEAD_M
        wide = flight + rng.uniform(1.2, 1.6, 0.05)
        parts = (risers,)
    elif kind == "L":
        long = landing + (half - 1) * tread + flight
        wide = flight + (risers - half - 1) * tread + _HEAD_M
        parts = (half, risers - half)
    else:
        if 2 * half * LEAST_RISER_M > pitch:
            half -= 1
        long = landing + (half - 1) * tread + flight
        wide = 2 * flight + rng.choice((0.1, 0.3, 0.8))
        parts = (half, half)
    return StairShape(kind, _up(long), _up(wide), flight, landing, round(tread, 3), parts, pitch)


def stairwell(shape: StairShape, room: int, place: Callable[[float, float], Place]) -> Stairwell:
    """The stairs of a shape in a room.

    Args:
        shape: The shape.
        room: Index of the room.
        place: Gives the position in the scene of a place ``(u, v)`` between the room's walls.
    """
    s, n = shape, sum(shape.risers)
    rise, w, a, first = s.pitch / n, s.wide_flight, s.landing, shape.risers[0]
    end = a + (first - 1) * s.tread
    steps = [
        (a + k * s.tread, 0.0, a + (k + 1) * s.tread, w, (k + 1) * rise) for k in range(first - 1)
    ]
    low, high = w - 0.03, w + 0.03
    rails = [((a, low), (end, low), (rise, first * rise))]
    foot = ((a - 0.03, 0.0), (a - 0.03, w))
    if s.kind == "straight":
        well = [(a, 0.0, end, w)]
        guards = [((a, high), (end, high))]
    elif s.kind == "L":
        head = w + (s.risers[1] - 1) * s.tread
        steps.append((end, 0.0, s.long, w, first * rise))
        steps += [
            (end, w + k * s.tread, s.long, w + (k + 1) * s.tread, (first + k + 1) * rise)
            for k in range(s.risers[1] - 1)
        ]
        rails.append(((end + 0.03, w), (end + 0.03, head), ((first + 1) * rise, n * rise)))
        well = [(a, 0.0, s.long, w), (end, w, s.long, head)]
        guards = [((a, high), (end - 0.03, high)), ((end - 0.03, high), (end - 0.03, head))]
    else:
        back = s.wide - w
        steps.append((end, 0.0, s.long, s.wide, first * rise))
        steps += [
            (end - (k + 1) * s.tread, back, end - k * s.tread, s.wide, (first + k + 1) * rise)
            for k in range(s.risers[1] - 1)
        ]
        rails.append(((end, back + 0.03), (a, back + 0.03), ((first + 1) * rise, n * rise)))
        rails.append(((end + 0.03, low), (end + 0.03, back + 0.03), (first * rise, first * rise)))
        well = [(a, 0.0, s.long, s.wide)]
        guards = [((a - 0.03, w), (a - 0.03, back))]
    slopes = [0.0] * len(steps)
    if s.kind == "ramp":
        middle = s.pitch / 2.0
        steps = [(*steps[0][:4], 0.0), steps[1], (*steps[2][:4], s.pitch)]
        slopes = [middle, 0.0, -middle]
        rails[:2] = [(*rails[0][:2], (0.0, middle)), (*rails[1][:2], (middle, s.pitch))]

    def rect(u0: float, v0: float, u1: float, v1: float) -> Rect:
        (x0, y0), (x1, y1) = place(u0, v0), place(u1, v1)
        corners = (min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1))
        return Rect(*(round(c, 4) for c in corners))

    def step(u0: float, v0: float, u1: float, v1: float, z: float, rise: float) -> Step:
        if place(u1, v1)[0] < place(u0, v0)[0]:
            z, rise = z + rise, -rise
        return Step(rect(u0, v0, u1, v1), round(z, 4), round(rise, 4))

    def rail(start: Place, end: Place, z: tuple[float, float] = (0.0, 0.0)) -> Rail:
        return Rail(place(*start), place(*end), z)

    return Stairwell(
        s.kind,
        room,
        tuple(step(*one, rise) for one, rise in zip(steps, slopes, strict=True)),
        tuple(rail(*one) for one in rails),
        tuple(rail(*one) for one in guards),
        rail(*foot),
        tuple(rect(*one) for one in well),
    )


def _up(metres: float) -> float:
    """Next length on the raster of walls, 5 cm, less a wall's thickness."""
    return round(math.ceil((metres + WALL_M) / 0.05 - 1e-6) * 0.05 - WALL_M, 4)
