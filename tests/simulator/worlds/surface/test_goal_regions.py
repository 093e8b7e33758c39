import math

import numpy as np
import pytest

from box_scenes import room_boxes, scene_of
from hypernav.core.goal import Goal
from hypernav.simulator.worlds.drawing.rays import RayCaster
from hypernav.simulator.worlds.surface.goal_regions import (
    GoalRegion,
    GoalRegions,
    surface_points,
    view_points,
)
from hypernav.simulator.worlds.surface.walkable import WalkableGrid

WALL = [(None, (2.9, 0.0, 0.0), (3.0, 1.5, 2.5)), (None, (2.9, 2.4, 0.0), (3.0, 4.0, 2.5))]
BED = ("bed", (0.0, 2.6, 0.0), (1.6, 4.0, 0.5))
IMAGE = ("picture", (2.88, 0.4, 1.2), (2.9, 1.0, 1.6))


def regions_of(*boxes):
    scene = scene_of(*boxes)
    walkable = WalkableGrid.from_scene(scene)
    return scene, walkable, GoalRegions(scene, walkable, RayCaster(scene))


def gap_to(points: np.ndarray, low, high) -> np.ndarray:
    """Horizontal distance of points to a box."""
    gaps = np.maximum(np.maximum(np.array(low[:2]) - points, points - np.array(high[:2])), 0.0)
    return np.hypot(gaps[:, 0], gaps[:, 1])


def test_view_points_are_the_standable_cells_within_a_metre_that_see_the_object():
    _, walkable, regions = regions_of(*room_boxes(), *WALL, BED)
    region = regions.of(Goal("bed"))
    assert all(walkable.component_of(x, y) == 0 for x, y in region.view_points[:, :2])
    assert gap_to(region.view_points[:, :2], *BED[1:]).max() <= 1.0
    assert np.allclose(region.view_points[:, 2], 0.0, atol=1e-3)
    centres = walkable.centres()
    # Nothing hides the bed in its room, so every near cell there counts.
    expected = centres[(gap_to(centres, *BED[1:]) <= 1.0) & (centres[:, 0] < 2.9)]
    assert len(region.view_points) == len(expected)


def test_an_object_is_not_seen_through_a_wall():
    _, _, regions = regions_of(*room_boxes(), *WALL, IMAGE)
    points = regions.of(Goal("picture")).view_points
    assert len(points) > 100
    assert points[:, 0].max() < 2.9


def test_an_object_shut_away_has_no_view_point():
    box = [
        ("safe", (4.0, 1.0, 0.0), (5.0, 2.0, 0.8)),
        ("diamond", (4.4, 1.4, 0.3), (4.5, 1.5, 0.4)),
    ]
    _, _, regions = regions_of(*room_boxes(), *box)
    region = regions.of(Goal("diamond"))
    assert len(region.instances) == 1
    assert not region.is_reachable
    assert region.distance(1.0, 1.0) == math.inf
    assert regions.categories() == ("safe",)


def test_a_goal_that_the_scene_does_not_hold_is_legal():
    _, _, regions = regions_of(*room_boxes(), BED)
    region = regions.of(Goal("umbrella"))
    assert region.instances == ()
    assert not region.is_reachable
    assert region.distance(3.0, 2.0) == math.inf


def test_a_region_is_the_union_over_all_instances():
    other = ("bed", (4.6, 0.0, 0.0), (6.0, 1.4, 0.5))
    scene, _, regions = regions_of(*room_boxes(), BED, other)
    region = regions.of(Goal("the bed"))
    each = [regions.view_points(instance) for instance in region.instances]
    assert len(each) == 2
    union = {tuple(p) for points in each for p in points}
    assert {tuple(p) for p in region.view_points} == union
    assert len(region.view_points) == len(union)
    assert scene.instances[region.instances[1].id].box_max[0] == pytest.approx(6.0)


def test_standing_anywhere_in_the_region_is_as_good_as_on_a_point():
    _, walkable, regions = regions_of(*room_boxes(), BED)
    region = regions.of(Goal("bed"))
    rng = np.random.default_rng(3)
    for _ in range(300):
        x, y = walkable.random_point(rng)
        if gap_to(np.array([[x, y]]), *BED[1:])[0] <= 1.0 - 0.05:
            assert region.distance(x, y) < 0.06


def test_the_distance_leads_around_walls():
    _, walkable, regions = regions_of(*room_boxes(), *WALL, IMAGE)
    region = regions.of(Goal("picture"))
    behind = (3.4, 0.5)
    assert gap_to(np.array([behind]), *IMAGE[1:])[0] < 1.0
    assert region.distance(*behind) > 1.2
    each = [walkable.distance(behind, (x, y)) for x, y, _ in region.view_points[::20]]
    assert region.distance(*behind) <= min(each) + 1e-3


def test_given_points_make_a_region():
    walkable = WalkableGrid.from_mask(np.ones((40, 40), dtype=bool))
    points = np.array([[1.0, 1.0, 0.0], [1.5, 1.0, 0.0]])
    region = GoalRegion.of_points(Goal("bed"), walkable, points)
    assert region.distance(1.0, 1.4) == pytest.approx(0.4, abs=1e-3)
    assert region.distance(1.9, 1.0) == pytest.approx(0.4, abs=1e-3)


def test_surface_points_lie_on_the_surface_spread_by_area_and_repeat():
    slab = ("rug", (1.0, 1.0, 0.0), (3.0, 2.0, 0.001))
    scene = scene_of(*room_boxes(), slab)
    instance = scene.instances[-1]
    points = surface_points(scene, instance, 400)
    assert np.array_equal(points, surface_points(scene, instance, 400))
    assert points[:, 0].min() >= 1.0 - 1e-5
    assert points[:, 0].max() <= 3.0 + 1e-5
    assert (points[:, 0] < 2.0).mean() == pytest.approx(0.5, abs=0.05)
    assert (points[:40, 1] < 1.5).mean() == pytest.approx(0.5, abs=0.15)


@pytest.mark.slow
def test_the_view_points_of_a_real_house_are_reachable(small_house):
    from hypernav.simulator.worlds.scenes.loading import read_scene

    scene = read_scene(small_house)
    walkable = WalkableGrid.from_scene(scene)
    regions = GoalRegions(scene, walkable, RayCaster(scene))
    rng = np.random.default_rng(0)
    starts = np.array([walkable.random_point(rng) for _ in range(100)])
    names = [name for name in regions.categories() if regions.of(Goal(name)).is_reachable]
    assert {"bed", "sofa", "refrigerator", "tv", "chair"} <= set(names)
    for name in names:
        region = regions.of(Goal(name))
        points = region.view_points[:, :2]
        distances = np.array([region.distance(x, y) for x, y in starts])
        straight = np.linalg.norm(starts[:, None] - points, axis=2).min(axis=1)
        assert np.isfinite(distances).all(), name
        assert (distances > straight - 0.05).all(), name
        near = [
            gap_to(points, one.box_min, one.box_max)
            for one in (scene.instances[i.id] for i in region.instances)
        ]
        assert np.min(near, axis=0).max() <= 1.0, name
        assert all(walkable.component_of(x, y) == 0 for x, y in points[::50]), name


def test_few_eyes_need_no_special_case():
    scene = scene_of(*room_boxes(), ("vase", (3.0, 2.0, 2.0), (3.2, 2.2, 2.4)))
    walkable = WalkableGrid.from_scene(scene)
    nowhere = view_points(scene, walkable, scene.instances[-1], RayCaster(scene), reach_m=0.0)
    below = view_points(scene, walkable, scene.instances[-1], RayCaster(scene), reach_m=0.5)
    assert 0 < len(nowhere) < len(below)
