"""What the robot believes about its target."""

import math
from dataclasses import replace

import numpy as np
import pytest

from certainty import certain
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.search.memory.candidate import Candidate
from hypernav.search.memory.goal_area import GoalArea, points_under_mask
from images import thing_before_wall, thing_pixels


def target_at(thing_m=2.0):
    observation = thing_before_wall(thing_m=thing_m)
    points = points_under_mask(
        thing_pixels(observation), observation, min_depth_m=0.5, max_depth_m=5.0
    )
    area = certain(GoalArea.from_points(points, resolution_m=0.05))
    return Candidate(area.entered_from(observation, 0.6), observation, best_pixels=1600.0)


def test_a_place_that_is_cut_off_is_no_entry_until_none_is_left():
    target = target_at()
    x, y = target.entry_points[0].tolist()
    position = (x, y)
    assert target.distance_to(*position) == pytest.approx(0.0)
    barred = certain(target.barred_at(position))
    assert barred.distance_to(*position) > 0.3
    left = barred
    while (fewer := left.barred_at(tuple(left.entry_points[0].tolist()))) is not None:
        assert len(fewer.entry_points) < len(left.entry_points)
        left = fewer
    everywhere = replace(target, barred=tuple(map(tuple, target.entry_points.tolist())))
    assert len(everywhere.entry_points) == len(target.entry_points)


@pytest.mark.parametrize(("thing_m", "is_beside"), [(1.5, True), (4.5, False)])
def test_a_goal_is_not_claimed_from_where_it_is_far_away(thing_m: float, is_beside: bool):
    target = target_at(thing_m=thing_m)  # seen from the origin
    assert target.nearest_view == (0.0, 0.0)
    assert target.views_beside.tolist() == ([[0.0, 0.0]] if is_beside else [])


def at_eye_level(wall_x):
    """A map that shows a wall across the view of a target."""
    cells = np.full((80, 80), Cell.FREE, dtype=np.uint8)
    grid = OccupancyGrid(cells, 0.05, (0.0, -2.0))
    if wall_x is not None:
        cells[:, grid.cell_of(wall_x, 0.0)[1]] = Cell.OCCUPIED
    return grid


def test_the_goal_area_is_not_entered_behind_a_wall():
    target = target_at(thing_m=2.0)
    everywhere = target.entry_points_in_sight(at_eye_level(None))
    assert len(everywhere) == len(target.entry_points)
    unseen = replace(target, area=replace(target.area, before=np.zeros_like(target.area.before)))
    before = unseen.entry_points_in_sight(at_eye_level(1.7))
    assert 0 < len(before) < len(everywhere)
    assert before[:, 0].min() > 1.7


def test_what_was_seen_over_a_counter_is_in_sight_from_before_it():
    target = target_at(thing_m=2.0)  # seen from the origin, along x
    points = target.entry_points_in_sight(at_eye_level(1.7))
    across = points[points[:, 0] < 1.6]
    assert len(across) > 0
    assert np.abs(across[:, 1]).max() < np.abs(points[:, 1]).max()  # before the target only
    beyond = target.area.entry_points[target.area.entry_before]
    assert beyond[:, 0].max() < target.area.seen_points[:, 0].max()


def test_what_the_target_itself_covers_hides_nothing():
    target = target_at(thing_m=2.0)
    wall_x = float(target.area.seen_points[0, 0])
    in_sight = target.entry_points_in_sight(at_eye_level(wall_x))
    front = target.entry_points[:, 0] < wall_x - 0.05
    assert len(in_sight) >= front.sum() * 0.5


def test_where_all_is_barred_nothing_is_in_sight():
    target = target_at()
    everywhere = replace(target, barred=tuple(map(tuple, target.entry_points.tolist())))
    assert len(everywhere.entry_points_in_sight(at_eye_level(None))) == 0


def test_every_entry_point_knows_the_nearest_position_that_the_target_was_seen_at():
    area = target_at().area
    away = np.linalg.norm(area.entry_points[:, None] - area.seen_points[None], axis=2)
    nearest = np.linalg.norm(area.entry_points - area.nearest_seen_points, axis=1)
    np.testing.assert_allclose(nearest, away.min(axis=1), atol=1e-6)


def test_images_from_one_position_count_once_and_the_best_of_them():
    target = target_at()
    once = target.with_look((0.0, 0.0), 0.5)
    assert once.with_look((0.1, 0.0), -0.8).log_odds == once.log_odds
    assert once.with_look((0.1, 0.0), 0.9).log_odds == pytest.approx(target.log_odds + 0.9)


def test_other_sides_and_other_distances_count_for_themselves():
    target = target_at(thing_m=2.0).with_look((0.0, 0.0), 0.5)  # 2 m before it
    for position in ((1.0, 0.0), (2.0, 2.0), (4.0, 0.0)):
        assert len(target.with_look(position, 0.5).looks) == 2
    assert len(target.with_look((0.0, 0.3), 0.5).looks) == 1


def test_a_form_that_is_refuted_outweighs_any_number_of_looks():
    target = target_at()
    for number in range(12):
        target = target.with_look((0.0, 3.0 * number), 2.5)
    assert target.log_odds < 5.0
    assert replace(target, form=-4.0).log_odds < 1.0


def test_what_is_refuted_needs_more_than_it_has():
    target = target_at().with_look((0.0, 0.0), 0.5)
    refuted = replace(target, needed=target.log_odds + 1.0)
    assert refuted.is_refuted
    assert not refuted.with_look((2.0, 2.0), 1.2).is_refuted


@pytest.mark.parametrize("weight", [-3.0, 0.5, 4.0])
def test_the_chance_is_that_of_the_odds(weight: float):
    target = target_at().with_look((0.0, 0.0), weight)
    assert target.chance / (1.0 - target.chance) == pytest.approx(math.exp(target.log_odds))
    assert target.log_odds - target_at().log_odds == pytest.approx(weight)


@pytest.mark.parametrize("turn", np.linspace(0.3, 6.0, 8).tolist())
@pytest.mark.parametrize(
    ("ratio", "side_deg", "is_same"),
    [(1.0, 8.0, True), (1.1, 0.0, True), (1.0, 89.0, False), (3.9, 0.0, False)],
)
def test_which_views_are_the_same_depends_on_side_and_distance_alone(
    turn: float, ratio: float, side_deg: float, is_same: bool
):
    target = target_at()
    x, y = target.area.centre

    def position(angle: float, away_m: float) -> tuple[float, float]:
        return (x + away_m * math.cos(angle), y + away_m * math.sin(angle))

    one = position(turn, 6.0)
    for sign in (1.0, -1.0):
        other = position(turn + sign * math.radians(side_deg), 6.0 * ratio**sign)
        looks = target.with_look(one, 1.0).with_look(other, 1.0).looks
        assert len(looks) == len(target.looks) + (1 if is_same else 2)
