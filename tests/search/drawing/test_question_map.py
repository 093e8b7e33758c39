"""Laws of the image of the map that a model gets."""

from dataclasses import fields, replace

import numpy as np
import pytest

from drawn_grids import drawn
from hypernav.core.exploring.floors import SeenThing
from hypernav.core.exploring.overview import Block
from hypernav.core.geometry.grid import Cell
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.drawing import palette
from hypernav.search.drawing.map_view import MapView
from hypernav.search.drawing.question_map import QuestionStyle, draw_question_map, filled

STRONG = QuestionStyle(**{field.name: True for field in fields(QuestionStyle)})
ROOM = drawn(
    """
    ############
    #..........?
    #..####....?
    #..#??#....?
    #..#??#....?
    #..####....?
    #..........?
    ############
    """,
    scale=10,
)
ROBOT = Pose2(0.75, 0.75, 0.0)
FURNITURE = (1.5, 1.0, 3.5, 3.0)
BLOCKS = tuple(
    Block(1 + 3 * j + i, 2.0 * i, 2.0 * (1 - j), 2.0, 1000, 5, (2.0 * i + 1, 2.0 * j + 1), 1.0)
    for j in range(2)
    for i in range(3)
)
EDGE = np.array([[5.475, 0.525 + 0.05 * k] for k in range(60)])


def near(image: np.ndarray, color: palette.Rgb, most: int = 12) -> np.ndarray:
    away = np.abs(image.astype(int) - np.array(color))
    return away.max(axis=2) <= most


def color_at(image: np.ndarray, row: int, column: int) -> palette.Rgb:
    red, green, blue = map(int, image[row, column])
    return red, green, blue


@pytest.mark.parametrize("size", [756, 784])
def test_unknown_stands_out_from_free_floor(size: int):
    image = draw_question_map(ROOM, (), ROBOT, [], STRONG, size=size, frontier=EDGE)
    assert image.shape == (size, size, 3)
    unknown, free = (color_at(image, *at) for at in ((4, 4), (size // 2, size // 4)))
    assert free == palette.FREE
    assert palette.contrast(unknown, free) >= 3.0
    assert palette.contrast(palette.OCCUPIED_STRONG, unknown) >= 3.0


def test_the_frontier_is_drawn_where_it_is():
    image = draw_question_map(ROOM, (), ROBOT, [], STRONG, frontier=EDGE)
    without = draw_question_map(ROOM, (), ROBOT, [], STRONG)
    rows, columns = np.nonzero(near(image, palette.FRONTIER))
    assert columns.mean() > 0.8 * image.shape[1]
    assert rows.max() - rows.min() > 0.35 * image.shape[0]
    assert not near(without, palette.FRONTIER).any()


def test_the_inside_of_furniture_is_filled_and_what_opens_to_the_unknown_is_not():
    cells = filled(ROOM).cells
    assert (cells[30:50, 40:60] == Cell.OCCUPIED).all()
    assert (cells[:, 110:][ROOM.cells[:, 110:] == Cell.UNKNOWN] == Cell.UNKNOWN).all()
    assert (cells[ROOM.explored] == ROOM.cells[ROOM.explored]).all()


def test_no_number_stands_on_furniture():
    style = QuestionStyle(fill_obstacles=True, clear_numbers=True)
    with_numbers = draw_question_map(ROOM, BLOCKS, ROBOT, [], style)
    other = [replace(block, number=block.number + 6) for block in BLOCKS]
    changed = (with_numbers != draw_question_map(ROOM, other, ROBOT, [], style)).any(axis=2)
    dark = near(draw_question_map(ROOM, (), ROBOT, [], style), palette.OCCUPIED)
    assert changed.sum() > 300
    assert not (changed & dark).any()


def test_excluded_blocks_are_hatched_and_have_no_number():
    plain = draw_question_map(ROOM, BLOCKS, ROBOT, [], STRONG)
    hatched = draw_question_map(ROOM, BLOCKS, ROBOT, [], STRONG, excluded=[3])
    assert near(hatched, palette.EXCLUDED).sum() > near(plain, palette.EXCLUDED).sum() + 1000
    assert near(hatched, palette.INK).sum() < near(plain, palette.INK).sum()


def test_things_are_named_where_they_are():
    sofa = SeenThing("sofa", (1.0, 3.2))
    image = draw_question_map(ROOM, (), ROBOT, [], STRONG, things=[sofa])
    changed = (image != draw_question_map(ROOM, (), ROBOT, [], STRONG)).any(axis=2)
    u, v = MapView.fit(ROOM, 768, points=[ROBOT.xy], margin=0.04).pixel_of(*sofa.position)
    rows, columns = np.nonzero(changed)
    assert (columns.mean(), rows.mean()) == pytest.approx((u, v), abs=6.0)
