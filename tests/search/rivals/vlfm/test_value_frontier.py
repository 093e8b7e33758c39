"""VLFM's choice of a frontier."""

import math

import numpy as np

from certainty import certain
from drawn_grids import drawn
from exploration_views import exploration_view
from hypernav.core.embodiment import CameraConfig, Embodiment
from hypernav.core.geometry.camera import optical_to_base
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.observation import Observation
from hypernav.core.trace import ExchangeLog
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.memory.floor import SearchMemory
from hypernav.search.rivals.vlfm.value_frontier import (
    ValueFrontierExplorer,
    without_pockets,
)

HERE = Pose2(0.0, 0.0, 0.0)
CAMERA = CameraConfig(width=160, height=120)


def hall(length_m=8.0, width_m=2.0):
    """A free hall along x with walls on both sides, open into the unknown at both ends."""
    columns, rows = round(length_m / 0.05) + 40, round(width_m / 0.05) + 40
    cells = np.zeros((rows, columns), dtype=np.uint8)
    cells[20:-20, 20:-20] = Cell.FREE
    cells[19, 20:-20] = cells[-20, 20:-20] = Cell.OCCUPIED
    return OccupancyGrid(cells, 0.05, (-length_m / 2 - 1.0, -width_m / 2 - 1.0))


class Says:
    """Gives every view the score that it is told to give."""

    def __init__(self):
        self.value = 0.0

    def score(self, observation, goal):
        return self.value


def explorer_of(scorer, log=None):
    robot = Embodiment(camera=CAMERA)
    return ValueFrontierExplorer(scorer, log or ExchangeLog(), robot, MappingConfig(), (0.22, 0.18))


def look(explorer, search, scorer, value, yaw, x=0.0):
    robot = Pose2(x, 0.0, yaw)
    scorer.value = value
    view = Observation(
        rgb=np.zeros((CAMERA.height, CAMERA.width, 3), np.uint8),
        depth=np.full((CAMERA.height, CAMERA.width), 4.9, np.float32),
        camera=CAMERA.intrinsics,
        camera_to_map=robot.to_transform() @ optical_to_base(0.88),
        robot=robot,
    )
    explorer.learn(exploration_view(hall(), view, search))


def next_of(explorer, search):
    return explorer.next_destination(exploration_view(hall(), HERE, search))


def chosen(explorer, search):
    return certain(next_of(explorer, search))


def test_the_frontier_with_the_best_values_is_gone_to_and_asked_about_again():
    scorer, log, search = Says(), ExchangeLog(), SearchMemory()
    explorer = explorer_of(scorer, log)
    look(explorer, search, scorer, 0.2, 0.0)
    look(explorer, search, scorer, 0.6, math.pi)
    destination = chosen(explorer, search)
    assert destination.x < -3.5
    assert destination.most_steps == 1
    assert "0.60" in destination.reason
    assert log.drain()[0].asked == "value map"


def test_a_frontier_is_kept_until_its_own_value_falls():
    scorer, search = Says(), SearchMemory()
    explorer = explorer_of(scorer)
    look(explorer, search, scorer, 0.5, 0.0)
    look(explorer, search, scorer, 0.4, math.pi)
    assert chosen(explorer, search).x > 3.5
    look(explorer, search, scorer, 0.9, math.pi)  # better now, but the other is as good as before
    assert chosen(explorer, search).x > 3.5
    look(explorer, search, scorer, 0.0, 0.0)
    assert chosen(explorer, search).x < -3.5


def test_what_was_visited_is_passed_over_and_at_the_end_nothing_is_left():
    scorer, search = Says(), SearchMemory()
    explorer = explorer_of(scorer)
    look(explorer, search, scorer, 0.5, 0.0)
    first = chosen(explorer, search)
    search.visits.append(first.xy)
    second = chosen(explorer, search)
    assert second.x < -3.5
    search.visits.append(second.xy)
    assert next_of(explorer, search) is None
    anew = certain(next_of(explorer, SearchMemory()))
    assert certain(certain(anew.insight).values).rows == 0  # no view was scored


def test_small_unknown_pockets_count_as_explored():
    grid = drawn(
        """
        ............
        ..??........
        ......???...
        ......???...
        ............
        """,
        scale=10,
    )
    known = without_pockets(grid, 1.0)
    assert known.state_at(1.25, 1.75) is Cell.FREE
    assert known.state_at(3.5, 1.0) is Cell.UNKNOWN
    assert grid.state_at(1.25, 1.75) is Cell.UNKNOWN
