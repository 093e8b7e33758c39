"""Where a robot that doesn't know its start stands in its memory, by the images of one turn.

What the turn shows is drawn as a map of its own. It is laid over every remembered floor in all
headings and positions (correlative scan matching, Olson 2009), and the best places are shifted to
where they fit best. Buildings look alike in several places: the best one counts only if it fits
well and no other one fits nearly as well.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import cv2
import numpy as np
from jaxtyping import Bool, Float32, Float64

from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2, Transform, wrap_angle
from hypernav.core.observation import Observation
from hypernav.search.mapping.top_down_map import TopDownMap
from hypernav.search.memory.floor import counted_from
from hypernav.search.memory.memory import Memory
from hypernav.search.memory.start.start_check import NEAR_M

_HEADINGS = 72
_COARSE = 4
"""Cells of the map side by side in one cell of the first comparison."""
_CANDIDATES = 24
"""Number of places on a floor that are compared in detail."""
_POINTS = 300
"""Number of points of each kind, about, by which a place is shifted."""
_SHIFTS = ((0.1, 3.0), (0.05, 1.5), (0.025, 0.75), (0.0125, 0.375))
"""Metres and degrees by which a place is shifted, in turn."""
_AROUND = np.array(list(product((1.0, 0.0, -1.0), repeat=3)))
"""Shifts to all neighbours of a place, and none, in steps."""
_CONTRADICTS_M = 0.3
"""Distance from all remembered obstacles from which a seen one, on remembered free floor, speaks
against a place."""
_SEEN_THROUGH = 0.25
"""Weight of a remembered obstacle where free floor is seen."""
_LONE = 3.0
"""Weight of an obstacle seen on known ground where none is remembered, beside one that agrees."""
_APART_M, _APART_RAD = 0.5, math.radians(15.0)
"""Distance and turn between two poses from which they are different places."""
_LEAST_EVIDENCE = 0.5
_MOST_RIVAL = 0.7
"""Limits of a sure place, set in six training houses (docs/results/memory.md)."""

_Points = Float64[np.ndarray, "_ 2"]
_Field = Float32[np.ndarray, "_ _"]
_Place = tuple[float, float, float]
"""Position of the robot in the map, metres, and turn of its own frame, radians."""
_Places = Float64[np.ndarray, "places 3"]


@dataclass(frozen=True)
class Relocalization:
    """The likeliest place of a robot in its memory.

    Attributes:
        floor: Number of the floor.
        own: Pose in the ``map`` frame of the memory at which the robot's own frame begins.
        own_z: Height there, metres.
        evidence: What speaks for it: 1 if all obstacles in sight are remembered, 0 if as much
            speaks against it or nothing is known there.
        rival: What speaks for the best other place, as a share of `evidence`.
    """

    floor: int
    own: Pose2
    own_z: float
    evidence: float
    rival: float

    @property
    def own_to_map(self) -> Transform:
        """The transform from the robot's own frame to the memory's ``map`` frame."""
        return self.own.to_transform(self.own_z)

    @property
    def doubt(self) -> str:
        """The reason why this may be the wrong place, for people; empty if it is sure."""
        if self.evidence < _LEAST_EVIDENCE:
            return "no remembered place looks like what the robot sees"
        if self.rival > _MOST_RIVAL:
            return "two remembered places look like what the robot sees"
        return ""


def relocalized(memory: Memory, frames: Sequence[Observation]) -> Relocalization | None:
    """The likeliest place of a robot in its memory.

    Args:
        memory: The memory; it is not changed.
        frames: Frames of a turn on the spot, in an upright frame of the robot's own.

    Returns:
        None if the robot sees no obstacle, or none is remembered.
    """
    own_z = memory.height_of(frames[0])
    around = TopDownMap(memory.mapping, memory.embodiment)
    for frame in frames:
        around.integrate(counted_from(own_z, frame))
    here = np.array(frames[0].robot.xy)
    seen = _Kinds.of(around).points(here)
    found = list[tuple[float, _Place, int]]()
    for number, floor in enumerate(memory.floors):
        known = _Kinds.of(floor.map)
        if seen.count and known.has_obstacles:
            fields = _Fields(known, seen.reach_m)
            for place in _candidates(fields, seen):
                best = _shifted(fields, seen.thinned(), place)
                found.append((fields.evidence(seen, best), best, number))
    if not found:
        return None
    evidence, place, number = max(found)
    others = (one[0] for one in found if one[2] != number or _apart(one[1], place))
    x, y = (np.array(place[:2]) - _turned(here[None], place[2])[0]).tolist()
    return Relocalization(
        floor=number,
        own=Pose2(x, y, wrap_angle(place[2])),
        own_z=memory.floors[number].z - own_z,
        evidence=evidence,
        rival=max([0.0, *others]) / max(evidence, 1e-6),
    )


@dataclass(frozen=True, eq=False)
class _Seen:
    """What the robot sees, as points ``(x, y)`` from where it stands, in its own frame, metres.

    Attributes:
        tall: Obstacles as high as the camera.
        low: Other obstacles.
        free: Free floor.
        weights: Number of points that one of each kind stands for.
    """

    tall: _Points
    low: _Points
    free: _Points
    weights: tuple[float, ...] = (1.0, 1.0, 1.0)

    @property
    def kinds(self) -> tuple[_Points, _Points, _Points]:
        """The points, by kind."""
        return (self.tall, self.low, self.free)

    @property
    def count(self) -> float:
        """Number of obstacles."""
        return self.weights[0] * len(self.tall) + self.weights[1] * len(self.low)

    @property
    def reach_m(self) -> float:
        """Distance of the farthest point."""
        return max(float(np.linalg.norm(one, axis=1).max(initial=0.0)) for one in self.kinds)

    def thinned(self) -> "_Seen":
        """Every n-th point."""
        steps = tuple(max(len(one) // _POINTS, 1) for one in self.kinds)
        tall, low, free = (one[::step] for one, step in zip(self.kinds, steps, strict=True))
        return _Seen(tall, low, free, tuple(map(float, steps)))


@dataclass(frozen=True, eq=False)
class _Kinds:
    """The cells of a map, by kind; `_Seen` says which."""

    grid: OccupancyGrid
    tall: Bool[np.ndarray, "rows columns"]
    low: Bool[np.ndarray, "rows columns"]

    @staticmethod
    def of(map_: TopDownMap) -> "_Kinds":
        """The cells of a map."""
        grid = map_.grid
        rows, columns = grid.cells.shape
        corners = grid.centres_of(np.array([[0, 0], [rows - 1, columns - 1]]))
        tall = map_.eye_level(corners).occupied
        return _Kinds(grid, tall, grid.occupied & ~tall)

    @property
    def has_obstacles(self) -> bool:
        """Whether there is any obstacle."""
        return bool(self.tall.any() or self.low.any())

    def points(self, here: Float64[np.ndarray, "2"]) -> _Seen:
        """The middles of the cells, from a position ``(x, y)``, metres."""
        masks = (self.tall, self.low, self.grid.free)
        tall, low, free = (self.grid.centres_of(np.argwhere(mask)) - here for mask in masks)
        return _Seen(tall, low, free)


class _Fields:
    """A remembered floor, as what a point of each kind says there for the place: at most 1."""

    def __init__(self, floor: _Kinds, reach_m: float) -> None:
        """Prepare a floor for points up to so far from the robot, metres."""
        grid = floor.grid
        margin = math.ceil(reach_m / grid.resolution_m) + 2 * _COARSE
        self.size_m = grid.resolution_m
        self.origin = np.array(grid.origin) - margin * self.size_m
        cells, tall, low = (np.pad(one, margin) for one in (grid.cells, floor.tall, floor.low))
        away_m = self._away_m(tall | low)
        contradicts = (cells == Cell.FREE) & (away_m > _CONTRADICTS_M)
        inside = self._away_m(cells != Cell.OCCUPIED) > self.size_m  # edges may be a cell off
        self.by_kind: tuple[_Field, _Field, _Field] = (
            _agreement(self._away_m(tall)) - contradicts,
            _agreement(away_m) - contradicts,
            np.float32(-_SEEN_THROUGH) * inside,
        )
        explored = (cells != Cell.UNKNOWN).view(np.uint8)
        self.known: _Field = cv2.dilate(explored, np.ones((5, 5), np.uint8)).astype(np.float32)

    def _away_m(self, mask: Bool[np.ndarray, "_ _"]) -> _Field:
        """Distance of every cell from the nearest one of a mask, metres."""
        if not mask.any():
            return np.full(mask.shape, np.inf, np.float32)
        cells = cv2.distanceTransform((~mask).view(np.uint8), cv2.DIST_L2, 5)
        return np.asarray(cells * np.float32(self.size_m))

    def fits(self, seen: _Seen, places: _Places) -> Float64[np.ndarray, "places"]:
        """How well all points agree with the floor, at most 1; unknown ground says nothing."""
        told = zip(seen.kinds, seen.weights, self.by_kind, strict=True)
        sums = [weight * self._sums(field, points, places) for points, weight, field in told]
        return np.sum(sums, axis=0) / seen.count

    def evidence(self, seen: _Seen, place: _Place) -> float:
        """See `Relocalization.evidence`; an obstacle that nothing remembered is near counts."""
        at = np.array([place])
        known = sum(self._sums(self.known, one, at) for one in (seen.tall, seen.low))
        evidence = (1.0 + _LONE) * self.fits(seen, at) - _LONE * known / seen.count
        return float(evidence[0])

    def _sums(
        self, field: _Field, points: _Points, places: _Places
    ) -> Float64[np.ndarray, "places"]:
        """Sums of a field over points from the robot, for every place of it."""
        turned = np.stack([_turned(points, yaw) for yaw in places[:, 2]])
        at = turned + (places[:, None, :2] - self.origin)
        columns, rows = np.moveaxis(np.floor(at / self.size_m).astype(np.int64), 2, 0)
        height, width = field.shape
        inside = (rows >= 0) & (rows < height) & (columns >= 0) & (columns < width)
        values = field[np.where(inside, rows, 0), np.where(inside, columns, 0)]
        return values.sum(axis=1, dtype=np.float64, where=inside)


def _agreement(away_m: _Field) -> _Field:
    return np.exp(-0.5 * (away_m / np.float32(NEAR_M)) ** 2)


def _candidates(fields: _Fields, seen: _Seen) -> list[_Place]:
    """The places that agree best by the first comparison, no two of them alike."""
    size_m = fields.size_m * _COARSE
    coarse = np.stack([_coarse(one) for one in fields.by_kind], axis=-1)
    reach = math.ceil(seen.reach_m / size_m)
    found = list[tuple[float, _Place]]()
    for yaw in np.arange(_HEADINGS) * (2.0 * math.pi / _HEADINGS):
        drawn = [_counts(_turned(one, float(yaw)), size_m, reach) for one in seen.kinds]
        fits = cv2.matchTemplate(coarse, np.stack(drawn, axis=-1), cv2.TM_CCORR)
        is_peak = (fits == cv2.dilate(fits, np.ones((5, 5), np.uint8))) & (fits > 0.0)
        for row, column in np.argwhere(is_peak):
            x, y = fields.origin + (np.array([column, row]) + reach + 0.5) * size_m
            found.append((float(fits[row, column]), (float(x), float(y), float(yaw))))
    kept = list[_Place]()
    for _, place in sorted(found, reverse=True):
        if len(kept) < _CANDIDATES and all(_apart(place, one) for one in kept):
            kept.append(place)
    return kept


def _coarse(field: _Field) -> _Field:
    """The means of a field in larger cells."""
    rows, columns = (side // _COARSE for side in field.shape)
    whole = field[: rows * _COARSE, : columns * _COARSE]
    return cv2.resize(whole, (columns, rows), interpolation=cv2.INTER_AREA)


def _counts(points: _Points, size_m: float, reach: int) -> Float32[np.ndarray, "side side"]:
    """Number of points in each cell around the robot, which stands in the middle of one."""
    side = 2 * reach + 1
    columns, rows = np.floor(points / size_m + 0.5).astype(np.int64).T + reach
    counts = np.bincount(rows * side + columns, minlength=side * side)
    return counts.reshape(side, side).astype(np.float32)


def _shifted(fields: _Fields, seen: _Seen, place: _Place) -> _Place:
    """A place shifted to where it agrees best."""
    at = np.array(place)
    best = fields.fits(seen, at[None])[0]
    for step_m, step_deg in _SHIFTS:
        steps = _AROUND * (step_m, step_m, math.radians(step_deg))
        while True:
            near = at + steps
            fits = fields.fits(seen, near)
            if fits.max() <= best:
                break
            best, at = fits.max(), near[fits.argmax()]
    x, y, yaw = at.tolist()
    return (x, y, yaw)


def _turned(points: _Points, yaw: float) -> _Points:
    c, s = math.cos(yaw), math.sin(yaw)
    return points @ np.array([[c, s], [-s, c]])


def _apart(a: _Place, b: _Place) -> bool:
    """Whether two poses are different places."""
    return math.dist(a[:2], b[:2]) > _APART_M or abs(wrap_angle(a[2] - b[2])) > _APART_RAD


@dataclass(frozen=True)
class FoundStart:
    """Where a robot took itself to be in its memory.

    Attributes:
        place: The likeliest place; None if there was nothing to compare.
        turns: Number of turns that it took to look around; they are no steps of the search.
        is_refused: Whether what it sees contradicts the map at that place.
    """

    place: Relocalization | None
    turns: int
    is_refused: bool = False

    @property
    def doubt(self) -> str:
        """The reason why the place may be wrong, for people; empty if it is sure."""
        if self.place is None:
            return "there is no obstacle to compare"
        if self.is_refused:
            return "what the robot sees contradicts the map at the likeliest place"
        return self.place.doubt

    def as_dict(self) -> dict[str, Any]:
        """Values for ``result.json``; floors count from 1."""
        place = self.place
        known = (
            {}
            if place is None
            else {
                "floor": place.floor + 1,
                "evidence": round(place.evidence, 3),
                "rival": round(place.rival, 3),
            }
        )
        return {"sure": not self.doubt, "doubt": self.doubt, "turns": self.turns, **known}


def found_by_turn(memory: Memory, frames: Sequence[Observation]) -> FoundStart:
    """Where a robot is in its memory, by what a turn on the spot shows.

    Args:
        memory: What is known of the building; it is not changed.
        frames: The frames before, between and after the turns, at least one, in an upright frame
            of the robot's own.
    """
    return FoundStart(relocalized(memory, frames), turns=len(frames) - 1)
