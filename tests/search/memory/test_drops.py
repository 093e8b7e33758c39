"""Edges of the floor: which patches make one, and how far the robot was from them."""

import math

import numpy as np
import pytest

from hypernav.search.memory.floor_exits import _IN_SIGHT_M, _PATCH_M, _distances_m, _edges


def test_patches_that_touch_make_an_edge_if_there_are_enough():
    patches = np.array([(5, 5), (6, 6), (7, 6), (-3, 2), (-3, 3), (20, 20)], dtype=float)
    found = [sorted(edge.tolist()) for edge in _edges(patches)]
    assert sorted(found) == [[0, 1, 2], [3, 4]]
    assert _edges(np.empty((0, 2))) == []


def test_the_distance_of_a_patch_is_that_of_the_nearest_position():
    patches = np.array([(3.0, 4.0), (10.0, -2.0), (11.0, -2.0)])
    positions = [(0.1, 0.1), (1.5, -1.1), (90.0, 0.0)]
    at = [(math.floor(x / _PATCH_M), math.floor(y / _PATCH_M)) for x, y in positions]
    expected = [min(_PATCH_M * math.dist(one, cell) for cell in at) for one in patches.tolist()]
    # The distance transform is inexact by some percent.
    assert _distances_m(patches, positions) == pytest.approx(expected, rel=0.05)
    assert max(expected) < _IN_SIGHT_M
