import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from certainty import certain
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.memory.goal_area import GoalArea, points_under_mask
from images import thing_before_wall, thing_pixels

coordinates = st.floats(-20, 20)


def area_of(points, **options):
    return certain(GoalArea.from_points(np.array(points), resolution_m=0.05, **options))


def masked_points(observation, **options):
    mask = thing_pixels(observation)
    return points_under_mask(mask, observation, min_depth_m=0.5, max_depth_m=5.0, **options)


@given(
    st.builds(Pose2, coordinates, coordinates, st.floats(-3.2, 3.2)),
    st.floats(0.6, 3.5),
)
def test_masked_pixels_lie_where_the_thing_stands(robot, thing_m):
    points = masked_points(thing_before_wall(robot=robot, thing_m=thing_m))
    in_base = robot.to_transform().inverse().apply(points)
    np.testing.assert_allclose(in_base[:, 0], thing_m, atol=1e-4)
    assert np.abs(in_base[:, 1]).max() < thing_m  # within the field of view
    assert in_base[:, 2].min() < 0.88 < in_base[:, 2].max()


def test_pixels_without_usable_depth_are_skipped():
    observation = thing_before_wall()
    depth = observation.depth
    depth[50:60, 60:100] = [[0.0, np.nan, np.inf, 9.0] * 10]
    assert len(masked_points(observation)) == 40 * 40 - 10 * 40


def test_a_stride_keeps_the_place():
    observation = thing_before_wall()
    dense, sparse = masked_points(observation), masked_points(observation, stride=2)
    assert len(sparse) * 4 == len(dense)
    np.testing.assert_allclose(sparse.mean(axis=0), dense.mean(axis=0), atol=0.02)


@pytest.mark.parametrize("window", [None, (0, 0, 20, 10)])
def test_a_mask_of_another_size_is_refused(window):
    observation = thing_before_wall()
    half = thing_pixels(observation)[::2, ::2].copy()
    with pytest.raises(ValueError, match="expected a mask of") as refused:
        points_under_mask(half, observation, min_depth_m=0.5, max_depth_m=5.0, window=window)
    assert str(half.shape) in str(refused.value)


@given(coordinates, coordinates)
def test_a_single_point_grows_by_the_paper_s_dilation(x, y):
    area = area_of([[x, y, 0.4]])
    assert area.seen.sum() == 1
    assert area.mask.sum() == 13 * 13  # 5×5, three times
    assert area.centre == pytest.approx((x, y), abs=0.051)
    assert area.distance_to(x, y) <= 0.051


def test_without_dilation_a_single_point_is_a_single_cell():
    area = area_of([[1.0, 2.0, 0.4]], iterations=0)
    assert area.mask.sum() == area.seen.sum() == 1


def test_without_points_there_is_no_area():
    assert GoalArea.from_points(np.zeros((0, 3)), resolution_m=0.05) is None


def test_a_leak_to_the_wall_behind_is_cut_off():
    thing = [[2.0 + 0.01 * i, 0.0, 0.5] for i in range(30)]
    wall = [[4.0, 0.0, 0.5]] * 5
    assert area_of(thing + wall).seen_points[:, 0].max() < 2.5
    whole = area_of(thing + wall, largest_cluster_only=False)
    assert whole.seen_points[:, 0].max() > 3.9


def test_a_few_points_apart_are_another_thing_s_in_a_guessed_mask():
    thing = np.tile([[2.0, 0.0, 0.4]], (100, 1))
    stray = np.tile([[1.7, 0.0, 0.4]], (3, 1))
    points = np.concatenate([thing, stray])
    assert area_of(points).seen.sum() == 2
    assert area_of(points, stray_share=0.05).seen.sum() == 1


def test_areas_know_what_they_share():
    here, nearby = area_of([[1.0, 1.0, 0.0]]), area_of([[1.2, 1.0, 0.0]])
    elsewhere = area_of([[9.0, -3.0, 0.0]])
    assert here.covers(here) == 1.0
    assert here.covers(nearby) == 1.0
    assert here.covers(elsewhere) == 0.0


def test_the_outline_surrounds_the_cells():
    area = area_of([[1.0, 1.0, 0.0]])
    (outline,) = area.outlines
    xs, ys = zip(*outline, strict=True)
    assert min(xs) == pytest.approx(area.points[:, 0].min(), abs=1e-3)
    assert max(ys) == pytest.approx(area.points[:, 1].max(), abs=1e-3)


@given(coordinates, coordinates, coordinates, coordinates)
def test_joined_areas_cover_both(x, y, u, v):
    a, b = area_of([[x, y, 0.0]]), area_of([[u, v, 0.0]])
    both = a.joined(b)
    assert both.covers(a) == both.covers(b) == 1.0
    for one in (a, b):
        assert {tuple(p) for p in np.round(one.seen_points, 3)} <= {
            tuple(p) for p in np.round(both.seen_points, 3)
        }
    assert both.seen.sum() <= a.seen.sum() + b.seen.sum()


def looked_at(observation):
    area = area_of(masked_points(observation))
    return area.entered_from(observation, 0.6)


def test_a_thing_on_a_wall_is_not_entered_from_the_room_behind_the_wall():
    observation = thing_before_wall(thing_m=2.0, wall_m=2.05)
    area = looked_at(observation)
    assert area.entry_points[:, 0].max() < 2.05
    assert area.distance_to(2.4, 0.0) > 0.3
    assert area.distance_to(1.45, 0.0) < 0.05
    assert area.distance_to(1.0, 0.0) == pytest.approx(0.4, abs=0.05)


def test_what_was_seen_from_both_sides_is_entered_from_both():
    near = looked_at(thing_before_wall(wall_m=2.05))
    far = looked_at(thing_before_wall(wall_m=2.05, robot=Pose2(4.0, 0.0, np.pi)))
    both = near.joined(far)
    for x in (1.45, 2.55):
        assert both.distance_to(x, 0.0) < 0.05


@given(st.builds(Pose2, coordinates, coordinates, st.floats(-3.2, 3.2)), st.floats(0.2, 0.9))
def test_the_robot_enters_near_what_was_seen(robot, reach_m):
    observation = thing_before_wall(robot=robot)
    area = area_of(masked_points(observation))
    entered = area.entered_from(observation, reach_m)
    gaps = np.linalg.norm(entered.entry_points[:, None] - entered.seen_points[None], axis=2)
    assert gaps.min(axis=1).max() <= reach_m + 1e-6
    assert entered.covers(area) == area.covers(entered) == 1.0
    np.testing.assert_allclose(entered.centre, area.centre, atol=1e-9)


def test_the_inner_entry_points_are_those_nearest_to_what_was_seen():
    area = looked_at(thing_before_wall(thing_m=2.0, wall_m=2.05))
    points, inner = area.entry_points, area.inner_entry_points
    gaps = np.linalg.norm(points[:, None] - area.seen_points[None], axis=2).min(axis=1)
    is_inner = (points[:, None] == inner[None]).all(axis=2).any(axis=1)
    assert 0 < len(inner) < len(points)
    assert gaps[is_inner].max() <= gaps[~is_inner].min() + 1e-9


def test_one_image_that_takes_more_along_moves_no_inner_entry_point():
    thing = area_of(np.array([[2.0, 0.0, 0.4]]))
    leaked = area_of(np.array([[2.0, 0.0, 0.4], [1.7, 0.0, 0.4]]))
    often = thing.joined(thing).joined(leaked)
    away_m = np.linalg.norm(often.inner_entry_points - np.array(thing.centre), axis=1)
    farthest_m = np.linalg.norm(often.entry_points - np.array(thing.centre), axis=1).max()
    assert away_m.max() <= farthest_m / 2.0 + 1e-9


def test_where_the_robot_stands_is_open_though_no_image_shows_it():
    observation = thing_before_wall(thing_m=0.6, wall_m=0.65)
    assert looked_at(observation).distance_to(*observation.robot.xy) < 0.1


def test_the_paper_enters_the_dilated_cells():
    area = area_of([[1.0, 1.0, 0.0]])
    assert np.array_equal(area.entry, area.mask)


@given(st.lists(st.tuples(coordinates, coordinates), min_size=1, max_size=12))
def test_the_seen_points_are_the_middles_of_the_cells_that_hold_the_points(places):
    area = area_of([(x, y, 1.0) for x, y in places], kernel=1, largest_cluster_only=False)
    seen = area.seen_points
    for x, y in places:
        off = np.abs(seen - (x, y)).max(axis=1)
        assert off.min() <= 0.025 + 1e-6
    assert len(seen) <= len(places)


@pytest.mark.parametrize("reach_m", [0.07, 0.3, 0.82])
def test_an_area_is_entered_up_to_the_reach_from_what_was_seen(reach_m: float):
    observation = thing_before_wall()
    area = area_of(masked_points(observation)).entered_from(observation, reach_m)
    away = [np.linalg.norm(area.seen_points - one, axis=1).min() for one in area.entry_points]
    assert max(away) <= reach_m * 1.05 + 0.01
    assert max(away) > reach_m - 0.06
    before = area.entered_from(observation, 0.0)
    assert np.array_equal(before.entry_points, area.entry_points)


@settings(max_examples=30)
@given(st.builds(Pose2, coordinates, coordinates, st.floats(-3.2, 3.2)))
def test_before_a_thing_is_what_hides_it_from_the_camera_and_nothing_beside_it(robot):
    observation = thing_before_wall(robot=robot)
    area = area_of(masked_points(observation)).entered_from(observation, 0.6)

    def from_camera(points) -> tuple[np.ndarray, np.ndarray]:
        """Bearings, radians, and distances, metres."""
        at = np.column_stack([points, np.zeros(len(points))])
        x, y, _ = robot.to_transform().inverse().apply(at).T
        return np.arctan2(y, x), np.hypot(x, y)

    (seen, seen_m), (to, away_m) = from_camera(area.seen_points), from_camera(area.entry_points)
    inside = np.minimum(to - seen.min(), seen.max() - to)
    nearer_m = seen_m.max() - away_m
    assert area.entry_before[(inside > 1e-6) & (nearer_m > 1e-6)].all()
    assert not area.entry_before[(inside < -1e-6) | (nearer_m < -1e-6)].any()
    assert area.entry_before.any()
