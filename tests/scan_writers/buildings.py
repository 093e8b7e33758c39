"""Houses of two and three storeys out of boxes, as scans of them would be annotated."""

import itertools
import math
from dataclasses import dataclass, field

Corner = tuple[float, float, float]

STOREY_M = 2.8
STEPS = 16
TREAD_M, RISE_M = 0.28, STOREY_M / STEPS
WIDTH_M, DEPTH_M = 9.0, 6.0


@dataclass(frozen=True)
class Thing:
    """A box with its annotation; z up, metres.

    Attributes:
        category: Raw category of the annotation.
        low: Lowest corner.
        high: Highest corner.
        region: Room number.
        task: Category of the episodes that look for it; empty if none does.
    """

    category: str
    low: Corner
    high: Corner
    region: int = 0
    task: str = ""

    def gap_m(self, x: float, y: float) -> float:
        """Horizontal distance of a point to the box."""
        along = [
            max(low - at, 0.0, at - high)
            for low, high, at in zip(self.low, self.high, (x, y), strict=False)
        ]
        return math.hypot(*along)


@dataclass(frozen=True)
class Flight:
    """Straight stairs along x, at the front or the back wall.

    Attributes:
        storey: Storey that it leads up from, from 0.
        foot_x: Where it begins, metres.
        along: 1 if it goes up towards greater x, -1 towards smaller.
        y: Its sides, metres.
    """

    storey: int
    foot_x: float
    along: int
    y: tuple[float, float]

    @property
    def x(self) -> tuple[float, float]:
        """Its ends, the smaller x first, metres."""
        head_x = self.foot_x + self.along * STEPS * TREAD_M
        return min(self.foot_x, head_x), max(self.foot_x, head_x)


@dataclass(frozen=True)
class House:
    """A building and its floors.

    Attributes:
        things: All boxes; those of the shell first.
        flights: Its stairs, one from each storey but the last to the next.
    """

    things: tuple[Thing, ...] = field(default_factory=tuple)
    flights: tuple[Flight, ...] = field(default_factory=tuple)

    def view_points(self, thing: Thing) -> list[Corner]:
        """Free points on a thing's floor, 0.1 m apart and 0.25 to 1.0 m from it."""
        floor = thing.low[2]
        near = [
            (column / 10.0, row / 10.0, floor)
            for column, row in itertools.product(range(3, 88), range(3, 58))
            if 0.25 <= thing.gap_m(column / 10.0, row / 10.0) <= 1.0
        ]
        return [point for point in near if self.is_free(*point)]

    def is_free(self, x: float, y: float, floor: float) -> bool:
        """Whether a robot of 0.18 m radius, and some more, stands here on a storey's floor."""
        for flight in self.flights:
            (left, right), (front, back) = flight.x, flight.y
            is_beside = left - 0.3 < x < right + 0.3 and front - 0.3 < y < back + 0.3
            if is_beside and round(floor / STOREY_M) == flight.storey + 1:
                return False  # the stairwell
        return all(
            thing.gap_m(x, y) >= 0.25
            for thing in self.things
            if thing.low[2] < floor + 1.5 and thing.high[2] > floor + 0.05
        )


def two_storeys() -> House:
    """Chair, bed and plant below; a sofa, two televisions and a vase with an odd name above."""
    up = STOREY_M
    flights = (Flight(0, 3.5, 1, (0.0, 1.1)),)
    furniture = [
        Thing("chair", (1.0, 2.6, 0.0), (1.5, 3.1, 0.9), 0, "chair"),
        Thing("bed", (6.6, 4.2, 0.0), (8.6, 5.9, 0.5), 0, "bed"),
        Thing("potted plant", (0.2, 5.3, 0.0), (0.6, 5.7, 1.1), 0, "plant"),
        Thing('vase, "old", blue', (4.0, 4.0, 0.0), (4.3, 4.3, 0.6), 0),
        Thing("couch", (3.0, 4.9, up), (5.0, 5.8, up + 0.8), 1, "sofa"),
        Thing("tv", (8.6, 3.0, up), (8.9, 4.2, up + 1.2), 1, "tv_monitor"),
        Thing("television", (0.1, 3.0, up), (0.4, 4.2, up + 1.2), 2, "tv_monitor"),
    ]
    return House((*_shell(flights), *furniture), flights)


def three_storeys() -> House:
    """A chair on the lowest floor, a television between, and a bed on the highest."""
    flights = (Flight(0, 3.5, 1, (0.0, 1.1)), Flight(1, 5.5, -1, (DEPTH_M - 1.1, DEPTH_M)))
    middle, top = STOREY_M, 2 * STOREY_M
    furniture = [
        Thing("chair", (0.6, 5.0, 0.0), (1.1, 5.5, 0.9), 0, "chair"),
        Thing("tv", (8.6, 3.0, middle), (8.9, 4.2, middle + 1.2), 1, "tv_monitor"),
        Thing("bed", (6.6, 0.1, top), (8.6, 1.8, top + 0.5), 2, "bed"),
    ]
    return House((*_shell(flights), *furniture), flights)


def _shell(flights: tuple[Flight, ...]) -> list[Thing]:
    """Floors, ceiling, walls and stairs."""
    top = (len(flights) + 1) * STOREY_M - 0.2
    wide, deep = WIDTH_M + 0.1, DEPTH_M + 0.1
    return [
        Thing("floor", (-0.1, -0.1, -0.1), (wide, deep, 0.0)),
        *(piece for flight in flights for piece in _floor_around(flight)),
        Thing("ceiling", (-0.1, -0.1, top), (wide, deep, top + 0.1), len(flights)),
        Thing("wall", (-0.1, -0.1, 0.0), (wide, 0.0, top)),
        Thing("wall", (-0.1, DEPTH_M, 0.0), (wide, deep, top)),
        Thing("wall", (-0.1, 0.0, 0.0), (0.0, DEPTH_M, top)),
        Thing("wall", (WIDTH_M, 0.0, 0.0), (wide, DEPTH_M, top)),
        *(tread for flight in flights for tread in _treads(flight)),
    ]


def _floor_around(flight: Flight) -> list[Thing]:
    """The floor that a flight leads up to, without the stairwell."""
    number, z = flight.storey + 1, (flight.storey + 1) * STOREY_M
    (left, right), (front, back) = flight.x, flight.y
    is_in_front = front == 0.0
    beside = (back, DEPTH_M + 0.1) if is_in_front else (-0.1, front)
    along = (-0.1, back) if is_in_front else (front, DEPTH_M + 0.1)
    return [
        Thing("floor", (x[0], y[0], z - 0.1), (x[1], y[1], z), number)
        for x, y in (
            ((-0.1, WIDTH_M + 0.1), beside),
            ((-0.1, left), along),
            ((right, WIDTH_M + 0.1), along),
        )
    ]


def _treads(flight: Flight) -> list[Thing]:
    """The steps of a flight, the lowest first."""
    z, treads = flight.storey * STOREY_M, []
    for step in range(STEPS):
        ends = [flight.foot_x + flight.along * k * TREAD_M for k in (step, step + 1)]
        low, high = (min(ends), flight.y[0], z), (max(ends) - 0.001, flight.y[1])
        treads.append(Thing("stairs", low, (*high, z + (step + 1) * RISE_M), flight.storey))
    return treads
