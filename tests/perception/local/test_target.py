"""What the robot believes about its target."""

from dataclasses import replace

import pytest

from certainty import certain
from hypernav.perception.local.goal_area import GoalArea, points_under_mask
from hypernav.perception.local.target import Target
from images import thing_before_wall, thing_pixels


def target_at(thing_m=2.0):
    observation = thing_before_wall(thing_m=thing_m)
    points = points_under_mask(
        thing_pixels(observation), observation, min_depth_m=0.5, max_depth_m=5.0
    )
    area = certain(GoalArea.from_points(points, resolution_m=0.05))
    return Target(
        area.entered_from(observation, 0.6), observation, best_pixels=1600.0, mean_score=1.0
    )


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
