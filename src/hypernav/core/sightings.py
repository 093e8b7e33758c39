"""What a search has seen so far besides the goal."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64, UInt8

from hypernav.core.geometry.boxes import Detection
from hypernav.core.geometry.depth import is_measured
from hypernav.core.observation import Observation

_SAME_THING_M = 1.0
_MOST_THINGS = 200
_WALL_HEIGHTS_M = (2.1, 2.4)
"""Heights above the floor at which there are walls and lintels, but neither furniture nor ceilings;
ours."""
_WALL_CELL_M = 0.1
_STRIDE = 8


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
        tells_rooms: Whether all is kept that tells rooms: the walls, and whatever a detector can
            name, not only what it reports beside the goal.
        things: Things in the order of their first sighting; the goal is none of them, unless the
            detector names everything.
        named: Numbers of the things that a detector which tells them apart has named.
        image: Latest camera image, RGB; None before the first.
    """

    def __init__(self, *, tells_rooms: bool = False) -> None:
        """Begin with nothing."""
        self.tells_rooms = tells_rooms
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        self.things: tuple[SeenThing, ...] = ()
        self.named: set[int] = set()
        self.image: UInt8[np.ndarray, "height width 3"] | None = None
        self._walls: set[tuple[int, int]] = set()

    @property
    def walls(self) -> Float64[np.ndarray, "n 2"]:
        """Positions ``(x, y)`` of walls and lintels, ``map`` frame, metres."""
        cells = np.array(list(self._walls), dtype=np.float64).reshape(-1, 2)
        return (cells + 0.5) * _WALL_CELL_M

    def note(self, observation: Observation, detections: Iterable[Detection]) -> None:
        """Remember an image and what was detected in it; things without depth are left out."""
        self.image = observation.rgb
        for one in detections:
            position = None if one.is_goal else _position(one, observation)
            if position is not None and len(self.things) < _MOST_THINGS:
                self._add(SeenThing(one.label, position))
        if self.tells_rooms:
            self._walls.update(map(tuple, _wall_cells(observation).tolist()))

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


def _wall_cells(observation: Observation) -> Int64[np.ndarray, "n 2"]:
    """Cells, numbered along x and y, where an image's upper half shows something so high."""
    depth = observation.depth[: observation.depth.shape[0] // 2 : _STRIDE, ::_STRIDE]
    rows, columns = np.nonzero(is_measured(depth))
    optical = observation.camera.unproject_pixels(
        rows * _STRIDE, columns * _STRIDE, depth[rows, columns]
    )
    points = observation.camera_to_map.apply(optical)
    low, high = _WALL_HEIGHTS_M
    high_up = points[(points[:, 2] > low) & (points[:, 2] < high), :2]
    return np.unique(np.floor(high_up / _WALL_CELL_M).astype(np.int64), axis=0)


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
