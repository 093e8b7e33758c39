"""Drawn images and maps whose right answers are known, for the examination of a model."""

import numpy as np

from hypernav.core.chat import Image
from hypernav.core.exploring.overview import Block, Overview
from hypernav.core.geometry.boxes import Box
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.perception.explorers.block_explorer import OverviewConfig
from hypernav.show.drawing.question_map import draw_question_map

SHAPE = Goal("red rectangle")
SHAPE_BOX = Box(380.0, 90.0, 560.0, 330.0)
WIDTH, HEIGHT = 640, 480
_ROOM_M, _CELL_M = 4.0, 0.05
_ROOMS: tuple[tuple[int, int], ...] = ((0, 1), (1, 1), (0, 0), (1, 0))
"""Column and row of the rooms, in the order of their numbers."""


def drawn_shape() -> Image:
    """A red rectangle at a known position on a plain, light ground."""
    image = drawn_ground()
    x_min, y_min, x_max, y_max = SHAPE_BOX.pixels()
    image[y_min:y_max, x_min:x_max] = (215, 30, 30)
    return image


def drawn_ground() -> Image:
    """The ground alone."""
    return np.full((HEIGHT, WIDTH, 3), 225, dtype=np.uint8)


def drawn_house(config: OverviewConfig, right: int) -> Overview:
    """A house of four rooms that was walked through, and opens to the unknown in one alone.

    Args:
        config: Drawing of the map.
        right: Number of the room that leads on, 1 to 4 from the upper left to the lower right.
    """
    side, half = round(2 * _ROOM_M / _CELL_M), round(_ROOM_M / _CELL_M)
    margin = half // 4
    cells = np.full((side + 2 * margin,) * 2, Cell.UNKNOWN, dtype=np.uint8)
    house = cells[margin:-margin, margin:-margin]
    house[:] = Cell.FREE
    house[[0, 1, -2, -1], :] = house[:, [0, 1, -2, -1]] = Cell.OCCUPIED
    column, row = _ROOMS[right - 1]
    outer = slice(0, 2) if column == 0 else slice(side - 2, side)
    opening = slice(row * half + half // 5, row * half + 4 * half // 5)
    house[opening, outer] = Cell.FREE
    corner = -margin * _CELL_M
    grid = OccupancyGrid(cells, _CELL_M, (corner, corner))
    edge_x = 0.5 * _CELL_M if column == 0 else 2 * _ROOM_M - 0.5 * _CELL_M
    edge_y = (np.arange(opening.start, opening.stop) + 0.5) * _CELL_M
    frontier = np.stack([np.full(edge_y.size, edge_x), edge_y], axis=1)
    blocks = tuple(
        Block(
            number=number,
            x_min=x * _ROOM_M,
            y_min=y * _ROOM_M,
            size_m=_ROOM_M,
            free_cells=half * half,
            frontier_cells=len(frontier) if number == right else 0,
            destination=((x + 0.5) * _ROOM_M, (y + 0.5) * _ROOM_M),
            travel_m=_ROOM_M,
        )
        for number, (x, y) in enumerate(_ROOMS, start=1)
    )
    robot = Pose2(_ROOM_M, 0.9 * _ROOM_M, 0.5 * np.pi)
    walked = [block.destination for block in blocks if block.number != right]
    trajectory = [*walked, robot.xy]

    def draw(shown, excluded) -> Image:
        return draw_question_map(
            grid,
            [block for block in blocks if block.number in {*shown, *excluded}],
            robot,
            trajectory,
            config.style,
            size=config.image_px,
            excluded=excluded,
            frontier=frontier,
        )

    return Overview(draw, blocks, robot, legend=config.style.legend, trajectory=trajectory)
