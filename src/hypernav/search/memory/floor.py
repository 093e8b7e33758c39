"""One floor as the robot knows it, and what the present search has learned and seen of it."""

import math
from collections import Counter
from dataclasses import dataclass, field, replace
from enum import Enum, auto
from typing import Any

import cv2
import numpy as np
from jaxtyping import Bool

from hypernav.core.exploring.floors import Sightings
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2, Transform, wrap_angle
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.search.mapping.top_down_map import TopDownMap
from hypernav.search.memory.candidate import GoalEvidence
from hypernav.search.memory.image_kernels import fan_of_view
from hypernav.search.memory.thing import Thing
from hypernav.search.memory.things import Things
from hypernav.search.memory.visibility import BLIND_M

_EVERY_PX = 16

MOST_POSITIONS = 5000
"""Number of positions of earlier searches that a floor's trajectory keeps."""
_NEW_VIEW_M = 0.75
_NEW_VIEW_DEG = 45.0
"""Way and turn from which an image shows enough that the one before didn't to look at all of it."""


@dataclass(eq=False)
class CoverageMask:
    """The cells of a floor that the images of this search have shown.

    Things move, and detectors overlook them: where nothing new is left to explore, the search goes
    on where it has not looked yet itself.

    Attributes:
        cells: Mask of the cells.
        origin: Lower left corner ``(x, y)`` of the mask, metres.
    """

    cells: Bool[np.ndarray, "rows columns"]
    origin: tuple[float, float]

    @staticmethod
    def nothing(grid: OccupancyGrid) -> "CoverageMask":
        """Nothing of a floor."""
        return CoverageMask(np.zeros(grid.cells.shape, dtype=bool), grid.origin)

    def add(self, observation: Observation, grid: OccupancyGrid) -> None:
        """Add what an image shows: in every direction up to the farthest that has depth."""
        self._grow(grid)
        lens, pose = observation.camera.lens, observation.camera_to_map.rows
        farthest, side = observation.farthest_m, grid.resolution_m
        mask = self.cells.view(np.uint8)
        cv2.fillPoly(mask, [fan_of_view(farthest, _EVERY_PX, lens, pose, self.origin, side)], 1)
        row, column = grid.cell_of(*observation.robot.xy)
        cv2.circle(mask, (column, row), math.ceil(BLIND_M / side), 1, -1)

    def applied(self, grid: OccupancyGrid) -> OccupancyGrid:
        """The map as if only this search had been on the floor: the rest is unknown."""
        self._grow(grid)
        return replace(grid, cells=np.where(self.cells, grid.cells, np.uint8(Cell.UNKNOWN)))

    def _grow(self, grid: OccupancyGrid) -> None:
        """Cover the cells of a map, which only grows."""
        if self.cells.shape == grid.cells.shape and self.origin == grid.origin:
            return
        column, row = (
            round((old - new) / grid.resolution_m)
            for old, new in zip(self.origin, grid.origin, strict=True)
        )
        grown = np.zeros(grid.cells.shape, dtype=bool)
        rows, columns = self.cells.shape
        grown[row : row + rows, column : column + columns] = self.cells
        self.cells, self.origin = grown, grid.origin


@dataclass(frozen=True, eq=False)
class HeadingsSeen:
    """Where the robot has looked from its present position.

    Attributes:
        spot: The position ``(x, y)``, ``map`` frame, metres.
        bearings: Whether it has looked in each direction, counter-clockwise from the x axis.
    """

    spot: tuple[float, float]
    bearings: Bool[np.ndarray, " rays"]


class ThingStatus(Enum):
    """What a search has found out about a thing; without a status it is as earlier ones left it."""

    HIDDEN = auto()
    """Not seen from beside it; gone to once more, where it was seen best."""
    DONE = auto()
    """Gone to, given up, or seen not to be the goal."""


@dataclass(eq=False)
class SearchMemory:
    """What the search for one goal has learned on one floor; each goal begins a new one.

    Attributes:
        evidence: Candidates for the goal, and what speaks for and against them.
        visits: Destinations ``(x, y)`` that were reached or given up, the oldest first, metres.
        looked: Where the robot has looked from its position; None before the first look.
        notes: What explorers have noted, by keys of their own: plain values that can be copied.
        is_explored: Whether nothing was left to explore, nor to look at again.
        number: Number of the search in this memory.
        lasts: Whether later searches are to know what it has seen.
        statuses: What it has found out about things, by their numbers.
        unlike: Number of images, by the number of a thing, that show it not to be the goal.
        given_up: Numbers of the connectors of this floor that it has tried to take in vain.
        unreached: Numbers of those to which there was no path from where the robot stood.
        images_to_ask: Numbers of the key images that a chat model is to be asked about, in the
            order in which it is; None before the first question.
        images_to_visit: Numbers of those in which it sees the goal, or that look like it where no
            chat model is asked, and that are left to go to.
        meant: The thing that is gone to before all others, as it was known; None if any will do.
        coverage: What it has looked at of the floor; None if the floor was not known before.
        revisits: Whether it explores what it has not looked at itself, known or not.
        seen_off_floor: Position ``(x, y, z)`` where the goal was last seen below or above the room
            of this floor, heights from the floor, metres; it lies at that height or farther
            on from here. None if it was not, or has been found on this floor since.
        went_off_floor: Whether the robot has been to such a position; it is led away only once.
        views: Poses of all frames, one for each of the latest positions of the trajectory.
        viewed_from: Pose of the latest frame with a new view; None before the first frame.
        has_new_view: Whether the present frame has one: only then all things in it and what it
            tells as a key image are looked at, since frames close together show the same.
    """

    evidence: GoalEvidence = field(default_factory=GoalEvidence)
    visits: list[tuple[float, float]] = field(default_factory=list)
    looked: HeadingsSeen | None = None
    notes: dict[str, Any] = field(default_factory=dict)
    is_explored: bool = False
    number: int = 0
    lasts: bool = False
    statuses: dict[int, ThingStatus] = field(default_factory=dict)
    unlike: Counter[int] = field(default_factory=Counter)
    given_up: set[int] = field(default_factory=set)
    unreached: set[int] = field(default_factory=set)
    images_to_ask: tuple[int, ...] | None = None
    images_to_visit: tuple[int, ...] = ()
    meant: Thing | None = None
    coverage: CoverageMask | None = None
    revisits: bool = False
    seen_off_floor: tuple[float, float, float] | None = None
    went_off_floor: bool = False
    views: list[Pose2] = field(default_factory=list)
    viewed_from: Pose2 | None = None
    has_new_view: bool = True

    @property
    def done(self) -> set[int]:
        """Numbers of the things that the search goes to no more."""
        return {number for number, one in self.statuses.items() if one is ThingStatus.DONE}

    def errand(self, things: Things, goal: Goal) -> Thing | None:
        """The one thing that is meant, as it is known now; None if it is gone, or was gone to.

        Two records of one thing become one, with the number of either: then what is where it was.
        """
        if self.meant is None or self.meant.number in self.done:
            return None
        x, y, _ = self.meant.position
        there = (things.find(self.meant.number), *things.at(x, y, goal))
        now = next((one for one in there if one is not None and not one.is_gone), None)
        return None if now is None or now.number in self.done else now

    def note_others(self, others: set[int], things: Things, goal: Goal) -> None:
        """Note which things an image showed not to be the goal.

        As many images rule one out as would make it gone, were it missed in them. The one that is
        meant is what a person said it is.
        """
        meant = self.errand(things, goal)
        self.unlike.update(others - ({meant.number} if meant is not None else set()))
        unlike = [one for one in things.known if one.number in self.unlike] if self.unlike else []
        for one in unlike:
            if replace(one, missed=one.missed + self.unlike[one.number]).is_gone:
                self.statuses[one.number] = ThingStatus.DONE

    def note_off_floor(self, position: tuple[float, float, float]) -> None:
        """Note where below or above the room of this floor the goal was seen; see the attribute."""
        if not self.went_off_floor:
            self.seen_off_floor = position

    def note_view(self, robot: Pose2) -> None:
        """Note from where the present frame is taken."""
        self.views.append(robot)
        last = self.viewed_from
        self.has_new_view = (
            last is None
            or last.distance_to(*robot.xy) >= _NEW_VIEW_M
            or abs(wrap_angle(robot.yaw - last.yaw)) >= math.radians(_NEW_VIEW_DEG)
        )
        if self.has_new_view:
            self.viewed_from = robot

    def forget_exploration(self) -> None:
        """Forget visits and notes: what counts as visited may hardly have been seen.

        The robot may have been shut in when it found no path to stairs.
        """
        self.is_explored = False
        self.visits.clear()
        self.unreached.clear()
        self.notes.clear()


@dataclass(eq=False)
class Floor:
    """One floor as the robot knows it.

    Attributes:
        z: Its height in the ``map`` frame, metres.
        map: Map of it.
        trajectory: Positions ``(x, y)`` of the robot on it, one per frame, metres.
        sightings: Things that were seen on it, other than the goal, for explorers' questions.
        things: All things that were seen on it, for later searches.
        search: What the present search has learned on it.
        was_explored: Whether a search, this one or an earlier one, has explored it to its end.
    """

    z: float
    map: TopDownMap
    trajectory: list[tuple[float, float]] = field(default_factory=list)
    sightings: Sightings = field(default_factory=Sightings)
    things: Things = field(default_factory=Things)
    search: SearchMemory = field(default_factory=SearchMemory)
    was_explored: bool = False

    def integrate(self, observation: Observation) -> None:
        """Add a frame, with heights counted from the ground, to map and trajectory."""
        self.trajectory.append(observation.robot.xy)
        self.search.note_view(observation.robot)
        self.map.integrate(observation)
        if self.search.coverage is not None:
            self.search.coverage.add(observation, self.map.grid)

    def begin_search(self, number: int, *, lasts: bool) -> None:
        """Forget what the search for another goal learned; `SearchMemory` has the arguments."""
        self.search = SearchMemory(
            number=number,
            lasts=lasts,
            coverage=CoverageMask.nothing(self.map.grid) if self.trajectory else None,
        )
        del self.trajectory[:-MOST_POSITIONS]


def counted_from(z: float, observation: Observation) -> Observation:
    """The same observation with heights counted from another, metres: its camera is lowered."""
    if z == 0.0:
        return observation
    pose = observation.camera_to_map
    lowered = Transform(pose.rotation, pose.translation - np.array([0.0, 0.0, z]))
    return replace(observation, camera_to_map=lowered)
