"""What a search has seen so far besides the goal."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from hypernav.core.geometry.boxes import Detection
from hypernav.core.geometry.depth import is_measured
from hypernav.core.observation import Observation

_SAME_THING_M = 1.0
_MOST_THINGS = 200


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
        if not is_known and len(known) < _MOST_THINGS:
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
