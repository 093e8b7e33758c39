"""Directions and lengths of the moves that are offered."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated, Protocol, runtime_checkable

import numpy as np
from jaxtyping import Bool, Float64
from pydantic import Field

from hypernav.core.config import RoomConfig
from hypernav.core.geometry.transforms import Pose2


@dataclass(frozen=True, eq=False)
class FreeDirections:
    """What an image shows of the floor, by direction.

    Attributes:
        headings: Directions from the robot's heading, radians, from right to left.
        free_m: How far the floor is free there, metres.
        is_explored: Whether the robot has looked there before.
        fov: Horizontal field of view of the camera, radians.
    """

    headings: Float64[np.ndarray, "n"]
    free_m: Float64[np.ndarray, "n"]
    is_explored: Bool[np.ndarray, "n"]
    fov: float

    def at(self, heading: float) -> tuple[float, bool]:
        """Free range and whether it is explored in the nearest direction that was looked at."""
        nearest = int(np.abs(self.headings - heading).argmin())
        return float(self.free_m[nearest]), bool(self.is_explored[nearest])


@dataclass(frozen=True)
class Move:
    """A move straight ahead: direction from the robot's heading, radians, and length, metres."""

    heading: float
    length_m: float


IsOpen = Callable[[float, float], bool]
"""Whether the robot can be at a position ``(x, y)``, ``map`` frame, metres."""


@runtime_checkable
class Proposer(Protocol):
    """Proposes moves."""

    def propose(
        self, directions: FreeDirections, robot: Pose2, is_open: IsOpen, *, may_turn: bool
    ) -> list[Move]:
        """Moves in the order of their numbers.

        Args:
            directions: What the image shows of the floor.
            robot: Pose of the robot.
            is_open: Function that tells where the robot can be.
            may_turn: Whether turning around is offered as well.
        """
        ...


class BiasedConfig(RoomConfig):
    """Moves into what is unexplored, as VLMnav proposes them. Values are those of its code.

    Attributes:
        share: Length of a move as a share of the free range.
        least_m: Length up to which a move is not worth it, metres.
        most_m: Largest length of a move, metres.
        spacing: Angle between unexplored directions, in units of (field of view in degrees / 360)
            radians.
        explored_spacing: Angle between an explored direction and all that were chosen before, in
            the same unit.
        space_explored: Whether explored directions keep that angle among themselves as well. The
            original means to, but compares with a stale angle.
    """

    share: float = Field(default=0.66, gt=0.0, le=1.0)
    least_m: float = Field(default=0.75, ge=0.0, le=10.0)
    most_m: float = Field(default=1.7, gt=0.0, le=20.0)
    spacing: float = Field(default=0.9, gt=0.0, le=10.0)
    explored_spacing: float = Field(default=4.0, gt=0.0, le=20.0)
    space_explored: bool = True


DEFAULT_MOVES = tuple(Move(math.radians(angle), 1.5) for angle in (45.9, 11.5, -11.5, -45.9))
"""What VLMnav offers where nothing is free and the robot may not turn around."""


class BiasedProposer:
    """Proposes moves into unexplored directions first, then into explored ones far from them."""

    def __init__(self, config: BiasedConfig) -> None:
        """Create it.

        Args:
            config: Lengths and angles.
        """
        self._config = config

    def propose(
        self, directions: FreeDirections, robot: Pose2, is_open: IsOpen, *, may_turn: bool
    ) -> list[Move]:
        """Moves from left to right; see `Proposer.propose`."""
        config, headings = self._config, directions.headings
        lengths = config.share * directions.free_m
        worth = lengths > config.least_m
        unit = math.degrees(directions.fov) / 360.0
        fresh = np.flatnonzero(worth & ~directions.is_explored)
        if len(fresh):
            chosen = _outward(headings, fresh, directions.free_m, config.spacing * unit)
            known = np.flatnonzero(worth & directions.is_explored)
            chosen += self._far_from(headings, known, chosen, config.explored_spacing * unit)
        else:
            known = np.flatnonzero(worth)
            chosen = _outward(headings, known, directions.free_m, unit) if len(known) else []
        moves = [
            Move(float(headings[k]), min(float(lengths[k]), config.most_m))
            for k in sorted(chosen, reverse=True)
        ]
        return moves or ([] if may_turn else list(DEFAULT_MOVES))

    def _far_from(
        self,
        headings: Float64[np.ndarray, "n"],
        candidates: Sequence[int] | np.ndarray,
        chosen: list[int],
        angle: float,
    ) -> list[int]:
        added: list[int] = []
        for k in candidates:
            others = chosen + added if self._config.space_explored else chosen
            if all(abs(headings[k] - headings[other]) >= angle for other in others):
                added.append(int(k))
        return added


def _outward(
    headings: Float64[np.ndarray, "n"],
    candidates: np.ndarray,
    free_m: Float64[np.ndarray, "n"],
    angle: float,
) -> list[int]:
    """The longest candidate, and from there to both sides whatever keeps an angle."""
    longest = int(candidates[free_m[candidates].argmax()])
    chosen = [longest]
    for side in (candidates[candidates > longest], candidates[candidates < longest][::-1]):
        last = longest
        for k in side:
            if abs(headings[k] - headings[last]) >= angle:
                last = int(k)
                chosen.append(last)
    return chosen


class SpatialConfig(RoomConfig):
    """Target points in space, as DyNaVLM is described to sample them. All values are ours.

    Attributes:
        angle_deg: Angle between directions, degrees.
        ranges_m: Distances of the points, metres.
        share: Largest distance of a point, as a share of the free range.
        most_points: Largest number of points; those that are farthest from each other are kept.
    """

    angle_deg: float = Field(default=10.0, ge=1.0, le=90.0)
    ranges_m: tuple[Annotated[float, Field(gt=0.0, le=20.0)], ...] = (0.8, 1.6, 2.4)
    share: float = Field(default=0.66, gt=0.0, le=1.0)
    most_points: int = Field(default=8, ge=1, le=40)


class SpatialProposer:
    """Proposes points of free, reachable floor in view, far from each other."""

    def __init__(self, config: SpatialConfig) -> None:
        """Create it.

        Args:
            config: Distances and angles.
        """
        self._config = config

    def propose(
        self, directions: FreeDirections, robot: Pose2, is_open: IsOpen, *, may_turn: bool
    ) -> list[Move]:
        """Points by farthest-point choice; see `Proposer.propose`."""
        config = self._config
        half = math.degrees(directions.fov) / 2.0
        moves: list[Move] = []
        most = math.floor(half / config.angle_deg)
        for k in range(-most, most + 1):
            heading = math.radians(k * config.angle_deg)
            free_m, _ = directions.at(heading)
            for length_m in config.ranges_m:
                x = robot.x + length_m * math.cos(robot.yaw + heading)
                y = robot.y + length_m * math.sin(robot.yaw + heading)
                if length_m <= config.share * free_m and is_open(x, y):
                    moves.append(Move(heading, length_m))
        return _far_apart(moves, config.most_points)


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
