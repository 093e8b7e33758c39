"""A two-storey house out of boxes, as a scan of it would be annotated."""

import itertools
import math
from dataclasses import dataclass, field

Corner = tuple[float, float, float]

STOREY_M = 2.8
STEPS = 16
TREAD_M, RISE_M = 0.28, STOREY_M / STEPS
STAIRS_X, STAIRS_Y = 3.5, (0.0, 1.1)
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
class House:
    """A building and its floors.

    Attributes:
        things: All boxes; those of the shell first.
    """

    things: tuple[Thing, ...] = field(default_factory=tuple)

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
        if floor > 1.0 and STAIRS_X - 0.3 < x < 8.3 and y < STAIRS_Y[1] + 0.3:
            return False  # the stairwell
        return all(
            thing.gap_m(x, y) >= 0.25
            for thing in self.things
            if thing.low[2] < floor + 1.5 and thing.high[2] > floor + 0.05
        )


def two_storeys() -> House:
    """Chair, bed and plant below; a sofa, two televisions and a vase with an odd name above."""
    up = STOREY_M
    shell = [
        Thing("floor", (-0.1, -0.1, -0.1), (WIDTH_M + 0.1, DEPTH_M + 0.1, 0.0)),
        # The upper floor leaves out the stairwell.
        Thing("floor", (-0.1, 1.1, up - 0.1), (WIDTH_M + 0.1, DEPTH_M + 0.1, up), 1),
        Thing("floor", (-0.1, -0.1, up - 0.1), (STAIRS_X, 1.1, up), 1),
        Thing("floor", (7.98, -0.1, up - 0.1), (WIDTH_M + 0.1, 1.1, up), 1),
        Thing("ceiling", (-0.1, -0.1, 5.4), (WIDTH_M + 0.1, DEPTH_M + 0.1, 5.5), 1),
        Thing("wall", (-0.1, -0.1, 0.0), (WIDTH_M + 0.1, 0.0, 5.4)),
        Thing("wall", (-0.1, DEPTH_M, 0.0), (WIDTH_M + 0.1, DEPTH_M + 0.1, 5.4)),
        Thing("wall", (-0.1, 0.0, 0.0), (0.0, DEPTH_M, 5.4)),
        Thing("wall", (WIDTH_M, 0.0, 0.0), (WIDTH_M + 0.1, DEPTH_M, 5.4)),
        *(
            Thing(
                "stairs",
                (STAIRS_X + step * TREAD_M, STAIRS_Y[0], 0.0),
                (STAIRS_X + (step + 1) * TREAD_M - 0.001, STAIRS_Y[1], (step + 1) * RISE_M),
            )
            for step in range(STEPS)
        ),
    ]
    furniture = [
        Thing("chair", (1.0, 2.6, 0.0), (1.5, 3.1, 0.9), 0, "chair"),
        Thing("bed", (6.6, 4.2, 0.0), (8.6, 5.9, 0.5), 0, "bed"),
        Thing("potted plant", (0.2, 5.3, 0.0), (0.6, 5.7, 1.1), 0, "plant"),
        Thing('vase, "old", blue', (4.0, 4.0, 0.0), (4.3, 4.3, 0.6), 0),
        Thing("couch", (3.0, 4.9, up), (5.0, 5.8, up + 0.8), 1, "sofa"),
        Thing("tv", (8.6, 3.0, up), (8.9, 4.2, up + 1.2), 1, "tv_monitor"),
        Thing("television", (0.1, 3.0, up), (0.4, 4.2, up + 1.2), 2, "tv_monitor"),
    ]
    return House((*shell, *furniture))
