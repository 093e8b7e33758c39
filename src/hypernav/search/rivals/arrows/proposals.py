"""Directions and lengths of the moves that are offered in the camera image, and how far is free.

Source: Goetting, Singh and Loquercio, "End-to-End Navigation with Vision-Language Models" (VLMnav),
2024, and its released code.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float64

from hypernav.core.embodiment import CameraConfig
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.observation import Observation
from hypernav.search.rivals.arrows.free_range_kernels import walk_lines

_FLOOR_M = (-0.24, 0.16)
"""Heights above the robot's floor between which a point is floor, metres (VLMnav's code)."""
_HEADINGS = 60
"""Number of directions that are examined (VLMnav's code)."""
_SPREAD = 1.5
"""Angle between the outermost of them, in fields of view (VLMnav's code); those that the camera
doesn't see are not free."""
_BLOCKED_PX = 5
"""Length in the image, pixels, up to which a line counts as blocked (VLMnav's code)."""
_CELL_M = 0.05
"""Side of a cell, metres; ours: the original draws 100 pixels a metre."""
_SIDE_M = 50.0
_ALONG_M = np.array([-0.02, -0.01, 0.0, 0.01])
_PROBES_M = np.array([(x, 0.0) for x in _ALONG_M] + [(0.0, y) for y in _ALONG_M])
"""Positions at and beside a point, metres: four along each axis (VLMnav's code)."""
_SEEN_PROBES = 3
"""Number of these that must be explored for the point to be explored (VLMnav's code)."""
_WIDTH_M = 0.6
"""Width of the strip of floor that one image explores, metres (VLMnav's code)."""
_REACH = 0.8
"""Length of the strip, as a share of the free range (VLMnav's code)."""


@dataclass(frozen=True, eq=False)
class FreeDirections:
    """What an image shows of the floor, by direction.

    Attributes:
        headings: Directions from the robot's heading, radians, from right to left.
        free_m: How far the floor is free there, metres.
        is_explored: Whether the floor there counts as explored; see `RayMemory.look`.
        fov: Horizontal field of view of the camera, radians.
    """

    headings: Float64[np.ndarray, "n"]
    free_m: Float64[np.ndarray, "n"]
    is_explored: Bool[np.ndarray, "n"]
    fov: float

    def at(self, heading: float) -> tuple[float, bool]:
        """Free range, metres, and whether it is explored, in the nearest of the directions."""
        nearest = int(np.abs(self.headings - heading).argmin())
        return float(self.free_m[nearest]), bool(self.is_explored[nearest])


@dataclass(frozen=True)
class Move:
    """A straight move: angle from the robot's heading, radians, left positive; length, metres."""

    heading: float
    length_m: float


IsOpen = Callable[[float, float], bool]
"""Whether the robot can be at a position ``(x, y)``, ``map`` frame, metres."""


MOST_MOVE_M = 1.7
"""Largest length of a move and of the strip that an image explores, metres (VLMnav's code)."""
_SHARE = 0.66
"""Length of a move as a share of the free range (VLMnav's code)."""
_LEAST_M = 0.75
"""Length up to which a move is not offered, metres (VLMnav's code)."""
_SPACING, _EXPLORED_SPACING = 0.9, 4.0
"""Angle between unexplored directions, and between an explored one and all that were chosen before,
in units of (field of view in degrees / 360) radians (VLMnav's code)."""

DEFAULT_MOVES = tuple(Move(math.radians(angle), 1.5) for angle in (45.9, 11.5, -11.5, -45.9))
"""What VLMnav offers where nothing is free and the robot may not turn around."""


def biased_moves(
    directions: FreeDirections, *, may_turn: bool, space_explored: bool = True
) -> list[Move]:
    """Moves into unexplored directions first, then into explored ones far from them (VLMnav).

    Args:
        directions: What the image shows of the floor.
        may_turn: Whether turning around is offered as well.
        space_explored: Whether explored directions keep their angle among themselves as well.

    Returns:
        Moves from left to right. Where none is free: `DEFAULT_MOVES`, or none if it may turn.
    """
    headings = directions.headings
    lengths = _SHARE * directions.free_m
    worth = lengths > _LEAST_M
    unit = math.degrees(directions.fov) / 360.0
    fresh = np.flatnonzero(worth & ~directions.is_explored)
    chosen: list[int] = []
    if len(fresh):
        chosen = _outward(headings, fresh, directions.free_m, _SPACING * unit)
        unexplored = tuple(chosen)
        for k in np.flatnonzero(worth & directions.is_explored).tolist():
            others = chosen if space_explored else unexplored
            if all(abs(headings[k] - headings[one]) >= _EXPLORED_SPACING * unit for one in others):
                chosen.append(k)
    elif worth.any():
        chosen = _outward(headings, np.flatnonzero(worth), directions.free_m, unit)
    moves = [
        Move(float(headings[k]), min(float(lengths[k]), MOST_MOVE_M))
        for k in sorted(chosen, reverse=True)
    ]
    return moves or ([] if may_turn else list(DEFAULT_MOVES))


def _outward(
    headings: Float64[np.ndarray, "n"],
    candidates: np.ndarray,
    free_m: Float64[np.ndarray, "n"],
    angle: float,
) -> list[int]:
    """The freest candidate, and from there to both sides those at least an angle apart."""
    longest = int(candidates[free_m[candidates].argmax()])
    chosen = [longest]
    for side in (candidates[candidates > longest], candidates[candidates < longest][::-1]):
        last = longest
        for k in side:
            if abs(headings[k] - headings[last]) >= angle:
                last = int(k)
                chosen.append(last)
    return chosen


_ANGLE_DEG = 10.0
_RANGES_M = (0.8, 1.6, 2.4)
"""Angle between directions and distances of DyNaVLM's points, which were not published; ours."""
_MOST_POINTS = 8
"""Largest number of them; those that are farthest from each other are kept (ours)."""


def spatial_moves(directions: FreeDirections, robot: Pose2, is_open: IsOpen) -> list[Move]:
    """At most eight moves to free, reachable floor in view, far apart (DyNaVLM's style).

    Args:
        directions: What the image shows of the floor.
        robot: Pose of the robot, ``map`` frame.
        is_open: Function that tells where the robot can be.
    """
    half = math.degrees(directions.fov) / 2.0
    moves: list[Move] = []
    most = math.floor(half / _ANGLE_DEG)
    for k in range(-most, most + 1):
        heading = math.radians(k * _ANGLE_DEG)
        free_m, _ = directions.at(heading)
        for length_m in _RANGES_M:
            x = robot.x + length_m * math.cos(robot.yaw + heading)
            y = robot.y + length_m * math.sin(robot.yaw + heading)
            if length_m <= _SHARE * free_m and is_open(x, y):
                moves.append(Move(heading, length_m))
    return _far_apart(moves, _MOST_POINTS)


def _far_apart(moves: list[Move], most: int) -> list[Move]:
    """The longest move, then again and again the one whose end is farthest from those taken."""
    if not moves:
        return []
    ends = np.array(
        [(m.length_m * math.cos(m.heading), m.length_m * math.sin(m.heading)) for m in moves]
    )
    taken = [max(range(len(moves)), key=lambda k: moves[k].length_m)]
    nearest = np.hypot(*(ends - ends[taken[0]]).T)
    while len(taken) < min(most, len(moves)):
        taken.append(int(nearest.argmax()))
        nearest = np.minimum(nearest, np.hypot(*(ends - ends[taken[-1]]).T))
    return [moves[k] for k in taken]


def all_headings(camera: CameraConfig) -> Float64[np.ndarray, "n"]:
    """The examined directions, radians from the robot's heading, from right to left."""
    half = _SPREAD * math.radians(camera.hfov_deg) / 2.0
    return np.linspace(-half, half, _HEADINGS)


def free_ranges(
    observation: Observation,
    headings: Float64[np.ndarray, "n"],
    camera: CameraConfig,
) -> Float64[np.ndarray, "n"]:
    """How far the floor is free along some headings.

    Floor right before the robot that the camera doesn't see counts as free if what it sees first
    is (ours: the original's camera looks down to its feet).

    Args:
        observation: Present frame.
        headings: Directions from the robot's heading, radians, positive to the left.
        camera: Range of the camera.

    Returns:
        Distances from the robot, metres; 0 where the path is blocked or not in the image.
    """
    to_base = observation.robot.to_transform().inverse() @ observation.camera_to_map
    lens = observation.camera
    return walk_lines(
        np.require(observation.depth, np.float32, ["C"]),
        (lens.fx, lens.fy, lens.cx, lens.cy),
        np.ascontiguousarray(to_base.rotation),
        float(to_base.translation[2]),
        np.ascontiguousarray(headings, dtype=np.float64),
        _FLOOR_M,
        camera.max_depth_m,
        camera.depth_limits_m,
        _BLOCKED_PX,
    )


class RayMemory:
    """Strips of floor that images explored, in a square of 50 m around the first robot position.

    Beyond that nothing counts as explored.
    """

    def __init__(self) -> None:
        """Begin without any strip."""
        side = round(_SIDE_M / _CELL_M)
        self._explored = np.zeros((side, side), dtype=np.uint8)
        self._corner: Float64[np.ndarray, 2] | None = None

    def look(
        self, robot: Pose2, headings: Float64[np.ndarray, "n"], free_m: Float64[np.ndarray, "n"]
    ) -> Bool[np.ndarray, " n"]:
        """Add the strips of the present image, then tell which directions lead to explored floor.

        Args:
            robot: Pose of the robot, ``map`` frame.
            headings: Directions from its heading, radians, positive to the left.
            free_m: Free ranges in these directions, metres.

        Returns:
            Whether each direction is explored at four fifths of its range, by this image or others.
        """
        if self._corner is None:
            self._corner = np.array(robot.xy) - _SIDE_M / 2.0
        angles = robot.yaw + headings
        towards = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        reaches = _REACH * free_m
        here = np.array(robot.xy)
        ends = self._cells(here + towards * np.minimum(reaches, MOST_MOVE_M)[:, None])
        start = tuple(int(number) for number in self._cells(here[None])[0])
        thickness = max(round(_WIDTH_M / _CELL_M), 1)
        for end in ends[free_m > 0.0]:
            cv2.line(self._explored, start, (int(end[0]), int(end[1])), 1, thickness)
        return self._is_explored(here + towards * reaches[:, None])

    def _is_explored(self, points: Float64[np.ndarray, "n 2"]) -> Bool[np.ndarray, " n"]:
        cells = self._cells((points[:, None] + _PROBES_M).reshape(-1, 2))
        side = len(self._explored)
        inside = ((cells >= 0) & (cells < side)).all(axis=1)
        seen = np.zeros(len(cells), dtype=bool)
        seen[inside] = self._explored[cells[inside, 1], cells[inside, 0]] > 0
        return seen.reshape(-1, len(_PROBES_M)).sum(axis=1) >= _SEEN_PROBES

    def _cells(self, points: Float64[np.ndarray, "n 2"]):
        assert self._corner is not None
        return np.floor((points - self._corner) / _CELL_M).astype(np.int64)
