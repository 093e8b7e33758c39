"""Exploration of the area that a model points to, or of frontiers where it points to none.

Source: the released code of NavVLM (a demonstration of one scene that differs from its paper).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial

import cv2
import numpy as np
from jaxtyping import Float64, Int64, UInt8

from hypernav.core.components.protocols import Guide
from hypernav.core.embodiment import Embodiment
from hypernav.core.exploring.exploration import Destination, ExplorationView
from hypernav.core.exploring.guidance import Direction, GuideView
from hypernav.core.exploring.insight import ImageWindow, Insight
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.observation import Observation
from hypernav.core.trace import ExchangeLog
from hypernav.search.drawing.question_map import draw_question_map
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.reachable_area import ReachableArea
from hypernav.search.rivals.config import AreaConfig
from hypernav.search.rivals.nearest_frontier import NearestFrontierExplorer

_CENTRES = {Direction.LEFT: 0.25, Direction.RIGHT: 0.75, Direction.STRAIGHT: 0.5}
"""Middles of the labelled squares, as shares of the width (NavVLM's code); at half the height."""
_JOINED_CELLS = 3  # side of the kernel that joins cells to pieces
_KEY = "navvlm"
"""Key of this explorer's notes."""
_SQUARE = 0.3125
"""Side of the labelled square, as a share of the width: 200 of 640 columns (NavVLM's code)."""
_ARRIVAL_M = 0.8
"""Distance within which an area counts as reached, metres (NavVLM's code)."""
_KEEP_STEPS = 10
"""Largest number of steps towards one area (NavVLM's code)."""
_TURNS = 12
"""Largest number of turns to the right, with a question after each, before the nearest frontier is
gone to (NavVLM's code)."""
_LEAST_CELLS = 6
"""Number of map cells that the square must cover in one piece (NavVLM's code)."""
_GAP_M = 1.0
"""Largest distance from an area to floor that the robot can reach, metres; ours."""
_MAP_PX = 480
"""Side of the map's image, pixels; ours."""


@dataclass
class _Notes:
    """What the explorer notes in the search for one goal.

    Attributes:
        turns: Number of turns since the last area.
        seen_before: Camera image of the choice before, RGB.
    """

    turns: int = 0
    seen_before: UInt8[np.ndarray, "_ _ 3"] | None = None


@dataclass(frozen=True, eq=False)
class AreaExplorer:
    """Asks which direction leads to the goal, and goes to the area that the image shows there.

    Where none does, it turns to the right and asks again; after 12 turns it goes to the nearest
    frontier. Map, planner and stop are those of all agents (ours: the original drives by
    fast marching, and asks a model at every step whether to stop).

    Attributes:
        guide: Guide that names a direction.
        log: Log of all choices, for the trace.
        embodiment: Turn of the robot, range of its camera.
        mapping: Cells of the map.
        clearances_m: Distances of destinations from obstacles, in the order to try, metres.
        config: Areas and turns.
    """

    guide: Guide
    log: ExchangeLog
    embodiment: Embodiment
    mapping: MappingConfig
    clearances_m: tuple[float, ...]
    config: AreaConfig = field(default_factory=AreaConfig)

    def next_destination(self, view: ExplorationView) -> Destination | None:
        """The area that the guide points to, a turn, or the nearest frontier; None without any.

        Raises:
            ModelUnavailableError: The guide's model did not answer.
        """
        seen = view.observation
        notes: _Notes = view.notes.setdefault(_KEY, _Notes())
        past = None
        if notes.seen_before is not None:
            past = partial(
                _past, notes.seen_before, view.grid, view.robot, view.trajectory, _MAP_PX
            )
        choice = self.guide.direct(GuideView(seen, self._windows(seen), past), view.goal)
        notes.seen_before = seen.rgb
        if choice.direction is not Direction.EXPLORE:
            position = self._area(view, choice.direction)
            if position is not None:
                notes.turns = 0
                rows, columns = _square(seen, choice.direction)
                box = (columns.start, rows.start, columns.stop, rows.stop)
                return Destination(
                    *position,
                    reason=choice.reason,
                    insight=Insight(window=ImageWindow(box=box, label=choice.direction)),
                    holds=True,
                    arrival_m=_ARRIVAL_M,
                    most_steps=_KEEP_STEPS,
                )
        if notes.turns < _TURNS:
            notes.turns += 1
            return self._turned_right(view.robot, choice.reason)
        notes.turns = 0
        frontier = NearestFrontierExplorer(self.log, self.mapping, self.clearances_m)
        return frontier.next_destination(view)

    def _turned_right(self, robot: Pose2, reason: str) -> Destination:
        angle = math.radians(self.embodiment.motion.turn_angle_deg)
        return Destination(*robot.xy, reason=reason, holds=True, face=robot.yaw - angle)

    def _windows(self, seen: Observation) -> dict[Direction, slice]:
        return {direction: _square(seen, direction)[1] for direction in _CENTRES}

    def _area(self, view: ExplorationView, direction: Direction) -> tuple[float, float] | None:
        """Reachable position ``(x, y)`` nearest to the area in the square; None without any."""
        grid, robot = view.grid, view.robot
        cells = self._cells_in(view.observation, direction, grid)
        if not len(cells):
            return None
        reach = ReachableArea.of(grid, robot, self.mapping, self.clearances_m[0])
        shown = reach.grid.mask_of(grid.centres_of(cells))
        if not shown.any():
            return None
        away = cv2.distanceTransform((~shown).view(np.uint8), cv2.DIST_L2, 5)
        away_m = away * reach.grid.resolution_m
        away_m = np.where(reach.reachable > 0, away_m, np.inf)
        # Of cells that are equally near the area, the one with the shortest path.
        row, column = np.unravel_index(
            int((away_m + 1e-3 * np.minimum(reach.travel_m, 1e3)).argmin()), away_m.shape
        )
        position = reach.grid.centre_of(int(row), int(column))
        if away_m[row, column] > _GAP_M or self._is_known(position, view):
            return None
        return position

    def _is_known(self, position: tuple[float, float], view: ExplorationView) -> bool:
        """Whether the robot is at a position, or a destination near it was reached or given up."""
        radius_m = self.config.visited_radius_m
        here = view.robot.distance_to(*position) < _ARRIVAL_M
        return here or any(math.dist(position, visit) < radius_m for visit in view.visits)

    def _cells_in(
        self, seen: Observation, direction: Direction, grid: OccupancyGrid
    ) -> Int64[np.ndarray, "n 2"]:
        """``[row, column]`` of the map cells under the square, of the largest piece only.

        The original clusters by density; ours is a piece that is connected when cells are dilated
        by one.
        """
        rows, columns = _square(seen, direction)
        camera = self.embodiment.camera
        measured = is_measured(seen.depth[rows, columns], camera.min_depth_m, camera.max_depth_m)
        at_row, at_column = np.nonzero(measured)
        points = seen.points_at(at_row + rows.start, at_column + columns.start)
        return _largest_piece(grid, points[:, :2], self.config)


def _square(seen: Observation, direction: Direction) -> tuple[slice, slice]:
    """Rows and columns of the labelled square."""
    height, width = seen.depth.shape
    half = max(round(_SQUARE * width / 2.0), 1)
    middle, centre = height // 2, round(_CENTRES[direction] * width)
    return (
        slice(max(middle - half, 0), min(middle + half, height)),
        slice(max(centre - half, 0), min(centre + half, width)),
    )


def _largest_piece(
    grid: OccupancyGrid, points: Float64[np.ndarray, "n 2"], config: AreaConfig
) -> Int64[np.ndarray, "m 2"]:
    covered = grid.mask_of(points)
    kernel = np.ones((_JOINED_CELLS, _JOINED_CELLS), np.uint8)
    _, parts = cv2.connectedComponents(cv2.dilate(covered.view(np.uint8), kernel))
    sizes = np.bincount(parts[covered], minlength=1)
    if not sizes.any() or sizes.max() < _LEAST_CELLS:
        return np.empty((0, 2), dtype=np.int64)
    kept = covered & (parts == sizes.argmax())
    if config.clear_rows:
        kept[(covered & ~kept).any(axis=1)] = False
    return np.argwhere(kept)


def _past(
    before: UInt8[np.ndarray, "_ _ 3"],
    grid: OccupancyGrid,
    robot: Pose2,
    trajectory: Sequence[tuple[float, float]],
    size: int,
) -> UInt8[np.ndarray, "_ _ 3"]:
    """The camera image of the choice before, beside the map with the trajectory; RGB."""
    drawn = draw_question_map(grid, (), robot, trajectory, size=size)
    width = round(before.shape[1] * size / before.shape[0])
    return np.hstack([cv2.resize(before, (width, size), interpolation=cv2.INTER_AREA), drawn])
