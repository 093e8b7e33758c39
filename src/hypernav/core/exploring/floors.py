"""What explorers are told of a building: things seen, stairs, and the floors that they lead to."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from hypernav.core.geometry.boxes import Detection
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.observation import Observation

_SAME_THING_M = 1.0
MOST_SIGHTINGS = 200
"""Number of things of one floor."""


@dataclass(frozen=True)
class SeenThing:
    """A thing on the map.

    Attributes:
        label: Name that the detector gave it.
        position: Position ``(x, y)`` in the ``map`` frame, metres.
    """

    label: str
    position: tuple[float, float]


@dataclass(frozen=True)
class Sightings:
    """Things that a detector has named, other than the goal.

    Attributes:
        things: Things in the order of their first sighting.
        named: Numbers of the things named by a detector that numbers them.
    """

    things: tuple[SeenThing, ...] = ()
    named: frozenset[int] = frozenset()

    def with_detections(
        self, observation: Observation, detections: Iterable[Detection]
    ) -> "Sightings":
        """Add the objects detected beside the goal in an image; those without depth are skipped."""
        things = [
            SeenThing(one.label, position)
            for one in detections
            if not one.is_goal and (position := _position(one, observation)) is not None
        ]
        return replace(self, things=_joined(self.things, things))

    def with_named(self, things: Mapping[int, SeenThing]) -> "Sightings":
        """Add things that have numbers."""
        return Sightings(_joined(self.things, things.values()), self.named.union(things))


def _joined(known: tuple[SeenThing, ...], things: Iterable[SeenThing]) -> tuple[SeenThing, ...]:
    """Known and new things; a new thing near a known one of the same name is the same."""
    for new in things:
        is_known = any(
            one.label == new.label and math.dist(one.position, new.position) < _SAME_THING_M
            for one in known
        )
        if not is_known and len(known) < MOST_SIGHTINGS:
            known = (*known, new)
    return known


def _position(detection: Detection, observation: Observation) -> tuple[float, float] | None:
    """Position of the object in a box, by the median depth of the box's middle."""
    height, width = observation.depth.shape
    box = detection.box.clipped(width, height)
    dx, dy = (box.x_max - box.x_min) / 4.0, (box.y_max - box.y_min) / 4.0
    rows = slice(round(box.y_min + dy), round(box.y_max - dy) + 1)
    columns = slice(round(box.x_min + dx), round(box.x_max - dx) + 1)
    depths = observation.depth[rows, columns]
    depths = depths[is_measured(depths)]
    if not depths.size:
        return None
    row, column = int(box.y_min + box.y_max) // 2, int(box.x_min + box.x_max) // 2
    point = observation.camera.unproject_pixels(
        np.array([row]), np.array([column]), float(np.median(depths))
    )
    x, y, _ = observation.camera_to_map.apply(point.reshape(-1, 3))[0]
    return float(x), float(y)


@dataclass(frozen=True)
class WayOut:
    """Stairs or a ramp from the robot's floor towards floors where something may be unseen.

    Attributes:
        connector: Number of the connector in the memory.
        x: Position before it along the x axis, ``map`` frame, metres.
        y: Position before it along the y axis, ``map`` frame, metres.
        words: Name for models and people, such as "stairs up".
        axis: Direction in which they lead away from there, ``map`` frame, radians.
        to: Number of the floor that they lead to; None if nobody knows.
    """

    connector: int
    x: float
    y: float
    words: str
    axis: float = 0.0
    to: int | None = None

    @property
    def xy(self) -> tuple[float, float]:
        """The position, metres."""
        return (self.x, self.y)


@dataclass(frozen=True)
class Drop:
    """A place where the floor ends, as at the head of stairs.

    Attributes:
        x: Position along the x axis, ``map`` frame, metres.
        y: Position along the y axis, ``map`` frame, metres.
        axis: Direction in which stairs seemed to lead down there, ``map`` frame, radians; None if
            no image has shown any.
    """

    x: float
    y: float
    axis: float | None = None

    @property
    def xy(self) -> tuple[float, float]:
        """The position, metres."""
        return (self.x, self.y)


@dataclass(frozen=True, eq=False)
class KnownFloor:
    """Another floor that the robot knows, and knows a path to.

    Attributes:
        number: Its number, in the order in which the robot came to know floors.
        above_m: Its height above the floor that the robot is on, metres; below it less than 0.
        grid: Map of it.
        trajectory: Positions ``(x, y)`` of the robot on it, ``map`` frame, metres.
        visits: Destinations on it that were reached or given up, as in `ExplorationView`.
        things: Things that were seen on it, other than the goal.
        stairs: Stairs on it that the robot may take; as in `ExplorationView.ways_out`, new ones
            only towards floors that it knows no path to.
        way: Stairs that lead to it, in the order in which the robot takes them, one a floor.
        arrival: Position ``(x, y)`` on it where the path ends, ``map`` frame, metres.
        notes: What explorers keep from choice to choice there, as in `ExplorationView`.
        was_explored: Whether a search, this one or an earlier one, left nothing to explore on it.
    """

    number: int
    above_m: float
    grid: OccupancyGrid
    trajectory: Sequence[tuple[float, float]]
    visits: Sequence[tuple[float, float]]
    things: Sequence[SeenThing]
    stairs: Sequence[WayOut]
    way: tuple[WayOut, ...]
    arrival: tuple[float, float]
    notes: dict[str, Any] = field(default_factory=dict)
    was_explored: bool = False

    @property
    def words(self) -> str:
        """Name for models and people, such as "floor 2, 3.0 m higher"."""
        away = f"{abs(self.above_m):.1f} m {'higher' if self.above_m > 0.0 else 'lower'}"
        return f"floor {self.number + 1}, {away}"
