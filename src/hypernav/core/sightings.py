"""What a search has seen so far besides the goal."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import UInt8

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


class Sightings:
    """Things that a detector has named, and the latest image; local perception tells the explorer.

    Attributes:
        everything: Whether whatever a detector can name is kept, not only what it reports beside
            the goal.
        things: Things in the order of their first sighting; the goal is none of them, unless the
            detector names everything.
        named: Numbers of the things that a detector which tells them apart has named.
        image: Latest camera image, RGB; None before the first.
    """

    def __init__(self, *, everything: bool = False) -> None:
        """Begin with nothing."""
        self.everything = everything
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        self.things: tuple[SeenThing, ...] = ()
        self.named: set[int] = set()
        self.image: UInt8[np.ndarray, "height width 3"] | None = None

    def note(self, observation: Observation, detections: Iterable[Detection]) -> None:
        """Remember an image and what was detected in it; things without depth are left out."""
        self.image = observation.rgb
        for one in detections:
            position = None if one.is_goal else _position(one, observation)
            if position is not None and len(self.things) < _MOST_THINGS:
                self._add(SeenThing(one.label, position))

    def note_named(self, things: Mapping[int, SeenThing]) -> None:
        """Remember things by their numbers."""
        self.named.update(things)
        for thing in things.values():
            if len(self.things) < _MOST_THINGS:
                self._add(thing)

    def _add(self, new: SeenThing) -> None:
        at = np.array(new.position)
        for thing in self.things:
            if thing.label == new.label and np.hypot(*(at - thing.position)) < _SAME_THING_M:
                return
        self.things = (*self.things, new)


def _position(detection: Detection, observation: Observation) -> tuple[float, float] | None:
    """Position of what fills the middle of a box, by its median depth."""
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
