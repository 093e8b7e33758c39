"""The panel of a floor: stairs have their size, and no words cover a number."""

from dataclasses import replace

import numpy as np

from hypernav.core.exploring.floors import KnownFloor, WayOut
from hypernav.core.exploring.overview import Block
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.search.drawing import palette
from hypernav.search.drawing.map_view import MapView
from hypernav.search.drawing.question_map import QuestionStyle
from hypernav.search.perception.explorers.floor_panels import _MARGIN, FloorPanel, draw_floors

SIZE = 756
GRID = OccupancyGrid(np.full((200, 200), Cell.FREE, np.uint8), 0.05, (-5.0, -5.0))
DOWNWARDS = WayOut(4, 0.0, 0.0, "stairs up", axis=-np.pi / 2.0)
FLOOR = KnownFloor(1, 3.0, GRID, (), (), (), (DOWNWARDS,), (), (0.0, 0.0))


def drawn(*blocks: Block, floor: KnownFloor = FLOOR) -> tuple[np.ndarray, MapView]:
    """The map of a floor without its title, and its window."""
    panel = FloorPanel(floor, blocks, np.empty((0, 2)))
    image = draw_floors([panel], QuestionStyle(), size=SIZE)
    return image[-SIZE:], MapView.around(panel.bounds, SIZE, margin=_MARGIN)


def test_stairs_are_five_bars_across_their_direction_from_behind_the_position_before_them():
    image, view = drawn(floor=replace(FLOOR, stairs=(replace(DOWNWARDS, axis=0.0),)))
    is_stairs = (image == palette.STAIRS).all(axis=2)
    _, row = view.pixel_of(0.0, 0.2)
    edges = np.flatnonzero(np.diff(is_stairs[int(row)].astype(int)))
    middles = (edges[::2] + edges[1::2]) / 2.0 + 1.0
    expected = [view.pixel_of(0.3 + 0.25 * k, 0.0)[0] for k in range(5)]
    np.testing.assert_allclose(middles, expected, atol=1.0)
    first = np.flatnonzero(is_stairs[:, int(expected[0])])
    assert abs(first[0] - view.pixel_of(0.0, 0.45)[1]) < 0.1 * view.pixels_per_m


def test_the_words_at_stairs_cover_no_number():
    block = Block(7, -0.5, -2.1, 1.0, 400, 0, (0.0, -1.6), 1.0)  # its middle is below the stairs
    alone, view = drawn(block, floor=replace(FLOOR, stairs=()))
    named, _ = drawn(block)
    u, v = (round(one) for one in view.pixel_of(0.0, -1.6))
    number = np.s_[v - 10 : v + 10, u - 8 : u + 8]
    assert (alone[number] == palette.INK).all(axis=2).any()
    np.testing.assert_array_equal(named[number], alone[number])
    without, _ = drawn()
    assert (without[number] == palette.STAIRS).all(axis=2).any()  # there they stand otherwise
