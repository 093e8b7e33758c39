"""What a search has looked at of a floor that was known before."""

import numpy as np

from box_views import room, view_of
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.memory.floor import CoverageMask, SearchMemory

KNOWN = OccupancyGrid(np.full((80, 120), Cell.FREE, np.uint8), 0.1, (-2.0, -1.0))


def test_nothing_looked_at_is_all_unknown():
    assert not CoverageMask.nothing(KNOWN).applied(KNOWN).explored.any()


def test_what_lies_ahead_is_looked_at_up_to_the_wall_and_what_lies_behind_is_not():
    over = CoverageMask.nothing(KNOWN)
    over.add(view_of(room(8.0, 6.0), Pose2(4.0, 3.0, 0.0)), KNOWN)
    seen = over.applied(KNOWN)
    assert seen.state_at(6.0, 3.0) is Cell.FREE
    assert seen.state_at(4.1, 3.1) is Cell.FREE
    assert seen.state_at(2.0, 3.0) is Cell.UNKNOWN
    assert seen.state_at(9.5, 3.0) is Cell.UNKNOWN


def test_it_keeps_its_place_when_the_map_grows():
    over = CoverageMask.nothing(KNOWN)
    over.add(view_of(room(8.0, 6.0), Pose2(4.0, 3.0, 0.0)), KNOWN)
    grown = OccupancyGrid(np.full((140, 160), Cell.FREE, np.uint8), 0.1, (-5.0, -4.0))
    seen = over.applied(grown)
    assert seen.state_at(6.0, 3.0) is Cell.FREE
    assert seen.state_at(2.0, 3.0) is Cell.UNKNOWN
    assert seen.explored.sum() == over.cells.sum()


def test_the_latest_place_off_the_floor_counts_until_the_robot_was_led_to_one():
    search = SearchMemory()
    for z in (-2.5, 3.0):
        search.note_off_floor((1.0, 2.0, z))
        assert search.seen_off_floor == (1.0, 2.0, z)
    search.seen_off_floor, search.went_off_floor = None, True
    search.note_off_floor((1.0, 2.0, 3.0))
    assert search.seen_off_floor is None
