import math

import numpy as np
import pytest

from hypernav.core.goal import Goal
from hypernav.lab.episodes.referee import Referee
from hypernav.simulator.worlds.surface.goal_regions import GoalRegion
from hypernav.simulator.worlds.surface.walkable import WalkableGrid


@pytest.fixture
def region() -> GoalRegion:
    walkable = WalkableGrid.from_mask(np.ones((40, 100), dtype=bool))
    return GoalRegion.of_points(Goal("bed"), walkable, np.array([[4.0, 1.0, 0.0]]))


def test_a_straight_walk_to_the_goal_is_perfect(region):
    referee = Referee(region, (1.0, 1.0, 0.0))
    for x in (2.0, 3.0, 3.95):
        referee.watch((x, 1.0, 0.0))
    result = referee.measure(stopped=True)
    assert result.success
    assert result.spl == 1.0
    assert result.shortest_path_m == pytest.approx(3.0, abs=1e-3)
    assert result.path_length_m == pytest.approx(2.95)
    assert result.distance_to_goal_m == pytest.approx(0.05, abs=1e-3)


def test_a_detour_costs_spl_and_height_counts(region):
    referee = Referee(region, (1.0, 1.0, 0.0))
    referee.watch((1.0, 1.0, 0.0))
    referee.watch((1.0, 1.6, 0.8))
    referee.watch((1.0, 1.0, 0.0))
    referee.watch((4.0, 1.0, 0.0))
    result = referee.measure(stopped=True)
    assert result.path_length_m == pytest.approx(5.0)
    assert result.spl == pytest.approx(3.0 / 5.0, abs=1e-3)


def test_one_path_is_scored_under_many_protocols(region):
    referee = Referee(region, (1.0, 1.0, 0.0))
    referee.watch((3.8, 1.0, 0.0))
    within = [
        referee.measure(stopped=True, success_distance_m=d).success
        for d in (0.1, 0.19, 0.21, 0.3, 1.0)
    ]
    assert within == [False, False, True, True, True]
    assert not referee.measure(stopped=False, success_distance_m=1.0).success


def test_a_goal_that_is_not_there_cannot_be_reached():
    walkable = WalkableGrid.from_mask(np.ones((40, 40), dtype=bool))
    region = GoalRegion.of_points(Goal("umbrella"), walkable, np.zeros((0, 3)))
    referee = Referee(region, (1.0, 1.0, 0.0))
    referee.watch((1.5, 1.0, 0.0))
    result = referee.measure(stopped=True)
    assert result.distance_to_goal_m == math.inf
    assert (result.success, result.spl, result.soft_spl) == (False, 0.0, 0.0)
