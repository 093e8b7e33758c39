"""What each layer of a map adds, where it is."""

import numpy as np
import pytest

from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.trace import BlockRecord
from hypernav.search.drawing import palette
from hypernav.search.drawing.map_painter import MapPainter, StairsMark
from hypernav.search.drawing.map_view import MapView

VIEW = MapView(left_m=-4.0, top_m=4.0, pixels_per_m=96.0, size=768)
"""The origin is in the middle."""


def painter(view: MapView = VIEW) -> MapPainter:
    floor = OccupancyGrid(np.full((200, 200), Cell.FREE, np.uint8), 0.05, (-5.0, -5.0))
    return MapPainter(floor, view=view)


def color_at(drawn: MapPainter, x: float, y: float) -> tuple[int, ...]:
    u, v = VIEW.pixel_of(x, y)
    return tuple(drawn.image[int(v), int(u)].tolist())


@pytest.mark.parametrize("corners", [2, 3, 4])
def test_a_goal_area_of_three_corners_or_more_is_filled(corners: int):
    drawn = painter()
    drawn.goal_area([[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)][:corners]])
    expected = palette.blend(palette.FREE, palette.GOAL, 0.45) if corners > 2 else palette.FREE
    assert color_at(drawn, 0.5, -0.5) == expected
    assert color_at(drawn, 0.0, -1.0) == (palette.GOAL if corners > 2 else palette.FREE)
    assert color_at(drawn, 0.5, -1.5) == palette.FREE


def test_a_trajectory_gets_no_paler_from_its_beginning_to_its_end():
    drawn = painter()
    drawn.trajectory([(x, 0.0) for x in np.linspace(-3.0, 3.0, 200)])
    shades = [sum(color_at(drawn, x, 0.0)) for x in np.linspace(-3.0, 2.99, 100)]
    assert shades == sorted(shades, reverse=True)
    assert len(set(shades)) > 20
    assert color_at(drawn, 2.95, 0.0) == palette.TRAJECTORY_NEW
    oldest = palette.blend(palette.TRAJECTORY_OLD, palette.TRAJECTORY_NEW, 1 / 24)
    assert color_at(drawn, -2.95, 0.0) == oldest
    assert color_at(drawn, 0.0, 0.1) == palette.FREE


def test_the_start_is_a_ring_with_an_empty_middle():
    drawn = painter()
    drawn.start(1.0, 2.0)
    at_px = {0.0: palette.FREE, 4.5: palette.TRAJECTORY_NEW, 10.0: palette.FREE}
    for away_px, color in at_px.items():
        for u, v in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)):
            x, y = 1.0 + u * away_px / 96.0, 2.0 + v * away_px / 96.0
            assert color_at(drawn, x, y) == color


def test_stairs_are_three_treads_that_rise_to_the_right_and_words_beside_them():
    drawn = painter()
    drawn.stairs([StairsMark((0.0, 0.0), "up")])
    is_stairs = (drawn.image == palette.STAIRS).all(axis=2)
    mark = is_stairs[384 - 14 : 384 + 14, 384 - 14 : 384 + 14]
    heights = mark.sum(axis=0)
    assert heights.tolist() == [0] * 2 + [8] * 8 + [16] * 8 + [24] * 8 + [0] * 2
    assert is_stairs[:, 384 + 14 :].any()
    assert not is_stairs[:, : 384 - 14].any()


def test_stairs_at_the_right_edge_have_their_words_on_the_left():
    drawn = painter()
    drawn.stairs([StairsMark((3.8, 0.0), "up to floor 2")])
    is_stairs = (drawn.image == palette.STAIRS).all(axis=2)
    u, _ = VIEW.pixel_of(3.8, 0.0)
    assert is_stairs[:, : int(u) - 14].any()


def test_only_the_chosen_block_is_tinted_and_less_so_where_blocks_are_paler():
    left, right = (
        BlockRecord(number=k, x_min=x, y_min=0.0, size_m=1.0) for k, x in ((1, -2.0), (2, 1.0))
    )
    tints = list[int]()
    for opacity in (1.0, 0.5):
        drawn = painter()
        drawn.blocks([left, right], chosen=2, opacity=opacity)
        assert color_at(drawn, -1.5, 0.5) == palette.FREE
        found = np.subtract(palette.FREE, color_at(drawn, 1.5, 0.5))
        assert (found >= 0).all()
        assert (found <= np.subtract(palette.FREE, palette.CHOSEN)).all()
        tints.append(int(found.sum()))
    assert tints[0] > tints[1] > 0


@pytest.mark.parametrize("size", [576, 768, 1536])
def test_the_scale_bar_is_as_long_as_it_says_between_two_equal_ends(size: int):
    drawn = painter(MapView(left_m=-4.0, top_m=4.0, pixels_per_m=size / 8.0, size=size))
    drawn.scale_bar()
    ink = (drawn.image == palette.INK).all(axis=2)
    left = int(np.nonzero(ink.any(axis=0))[0][0])
    right = left + size // 8  # 1 m
    heights = ink[:, left : right + 2].sum(axis=0)
    assert (
        heights.tolist()
        == [heights[0]] * 2 + [heights[2]] * (size // 8 - 4) + [heights[0]] * 2 + [0] * 2
    )
    assert (heights[0], heights[2]) == pytest.approx((8.0 * size / 768, 3.0 * size / 768), abs=1.0)


def test_the_mark_of_a_destination_is_the_same_to_all_sides():
    drawn = painter()
    drawn.destination(0.0, 0.0)
    mark = drawn.image[384 - 40 : 384 + 40, 384 - 40 : 384 + 40].astype(int)
    for turned in (mark[::-1], mark[:, ::-1], mark.transpose(1, 0, 2)):
        assert np.abs(mark - turned).max() < 40
