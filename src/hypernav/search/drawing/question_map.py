"""The image of the map for a model that is asked where to go; several switches set its style."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
from jaxtyping import Float64, UInt8

from hypernav.core.exploring.floors import SeenThing
from hypernav.core.exploring.overview import Block
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.drawing import palette
from hypernav.search.drawing.map_painter import XY, MapPainter
from hypernav.search.drawing.map_view import CellColors, MapView

_STRONG = CellColors(palette.UNKNOWN_STRONG, palette.FREE, palette.OCCUPIED_STRONG)
_LARGEST_INSIDE_M2 = 3.0
_LEAST_ENCLOSED = 0.6


@dataclass(frozen=True)
class QuestionStyle:
    """Style of the image; with all switches off it is the plain one (paper).

    Attributes:
        strong_colors: Whether unknown and free floor have a contrast of at least 3:1.
        frontier: Whether the boundary to the unknown is drawn in a colour.
        fill_obstacles: Whether the inside of furniture and walls, which no camera sees, is filled.
        clear_numbers: Whether numbers are larger and not placed on furniture.
        labels: Whether things that were seen are named.
    """

    strong_colors: bool = False
    frontier: bool = False
    fill_obstacles: bool = False
    clear_numbers: bool = False
    labels: bool = False

    @property
    def legend(self) -> str:
        """Sentences that say what the colours and marks mean."""
        frontier = "; the pink line is the boundary to what is unexplored" if self.frontier else ""
        labels = "; small words name things that were seen there" if self.labels else ""
        return (
            "white is free floor, dark is walls and furniture, grey is not yet explored"
            f"{frontier}{labels}. The orange arrow is the robot and where it looks, the blue line "
            "is where it has been. Hatched blocks are ruled out"
        )


_PLAIN = QuestionStyle()


def draw_question_map(
    grid: OccupancyGrid,
    blocks: Sequence[Block],
    robot: Pose2,
    trajectory: Sequence[XY],
    style: QuestionStyle = _PLAIN,
    *,
    size: int = 768,
    excluded: Collection[int] = (),
    frontier: Float64[np.ndarray, "n 2"] | None = None,
    things: Sequence[SeenThing] = (),
) -> UInt8[np.ndarray, "_ _ 3"]:
    """Draw the image that comes with the question "which block next?".

    Args:
        grid: The map.
        blocks: All blocks that are drawn.
        robot: Pose of the robot, ``map`` frame.
        trajectory: Past positions of the robot, ``map`` frame, metres.
        style: Style of the image.
        size: Side of the image, pixels.
        excluded: Numbers of blocks that may not be answered; hatched.
        frontier: Middles of the cells at the boundary to the unknown, ``map`` frame, metres.
        things: Things that were seen.

    Returns:
        RGB, ``size`` squared.
    """
    view = MapView.fit(grid, size, points=[*_corners(blocks), robot.xy], margin=0.04)
    painter = question_painter(grid, view, style, frontier)
    painter.blocks(blocks, excluded=excluded)
    if style.labels:
        painter.labels(things)
    painter.trajectory(trajectory)
    if style.clear_numbers:
        painter.clear_numbers(blocks, excluded=excluded, robot=robot)
    else:
        painter.numbers(blocks, excluded=excluded, robot=robot)
    painter.scale_bar()
    painter.robot(robot)
    return painter.image


def question_painter(
    grid: OccupancyGrid,
    view: MapView,
    style: QuestionStyle,
    frontier: Float64[np.ndarray, "n 2"] | None,
) -> MapPainter:
    """A painter of the map in a style, before anything is drawn on the map but the frontier.

    Args:
        grid: The map.
        view: What part of the world the image shows.
        style: Style of the image.
        frontier: Middles of the cells at the boundary to the unknown, ``map`` frame, metres.
    """
    if style.fill_obstacles:
        grid = filled(grid)
    painter = MapPainter(grid, view=view, colors=_STRONG if style.strong_colors else None)
    if style.frontier and frontier is not None:
        painter.frontier(frontier, grid.resolution_m)
    return painter


def filled(grid: OccupancyGrid) -> OccupancyGrid:
    """The map in which small unknown parts that obstacles enclose are obstacles, too."""
    unknown = grid.cells == Cell.UNKNOWN
    _, parts, stats, _ = cv2.connectedComponentsWithStats(unknown.view(np.uint8), connectivity=4)
    largest = _LARGEST_INSIDE_M2 / grid.resolution_m**2
    inside = np.flatnonzero(stats[:, cv2.CC_STAT_AREA] <= largest)
    cells = grid.cells.copy()
    for part in inside[inside > 0]:
        left, top, width, height, _ = stats[part]
        rows = slice(max(top - 1, 0), top + height + 1)
        columns = slice(max(left - 1, 0), left + width + 1)
        own = parts[rows, columns] == part
        rim = cv2.dilate(own.view(np.uint8), np.ones((3, 3), np.uint8)).astype(bool) & ~own
        around = grid.cells[rows, columns][rim]
        if around.size and np.mean(around == Cell.OCCUPIED) >= _LEAST_ENCLOSED:
            cells[rows, columns][own] = Cell.OCCUPIED
    return replace(grid, cells=cells)


def _corners(blocks: Sequence[Block]) -> list[XY]:
    low = [(block.x_min, block.y_min) for block in blocks]
    return low + [(block.x_min + block.size_m, block.y_min + block.size_m) for block in blocks]
