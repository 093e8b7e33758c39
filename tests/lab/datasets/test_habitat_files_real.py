"""What the real ObjectNav file says of itself holds after it was read: no scene is needed."""

import numpy as np
import pytest

from hypernav.lab.datasets.benchmarks import BENCHMARKS
from hypernav.lab.datasets.habitat_files import episodes_of, read_episodes
from hypernav.lab.datasets.habitat_format import pose_from_habitat, positions_from_habitat

ROUNDING_M = 2e-5
"""The file keeps five decimals."""


@pytest.fixture(scope="module")
def dataset(test_data):
    return read_episodes(test_data / "habitat" / "objectnav_mp3d_v1_sample.json.gz")


@pytest.fixture(scope="module")
def pairs(dataset):
    """Every episode as it is run, with what the file says about it."""
    words = BENCHMARKS["mp3d"].words
    return list(zip(episodes_of(dataset, words=words), dataset.episodes, strict=True))


def in_scene(point):
    return positions_from_habitat(np.array([point], dtype=np.float64))[0]


def position_of(episode):
    return np.array([episode.start.x, episode.start.y, episode.start_z])


def test_starts_and_view_points_lie_within_the_navigation_bounds(pairs):
    for episode, entry in pairs:
        corners = np.array([in_scene(corner) for corner in entry.info["navigation_bounds"]])
        low, high = corners.min(axis=0) - ROUNDING_M, corners.max(axis=0) + ROUNDING_M
        points = np.vstack([episode.view_points, position_of(episode)])
        assert ((points >= low) & (points <= high)).all()


def test_no_path_is_shorter_than_the_straight_line_to_its_end(pairs):
    for episode, entry in pairs:
        end = in_scene(entry.info["best_viewpoint_position"])
        straight_m = float(np.linalg.norm(end - position_of(episode)))
        assert entry.info["geodesic_distance"] >= straight_m - ROUNDING_M
        assert entry.info["euclidean_distance"] <= entry.info["geodesic_distance"] + ROUNDING_M


def test_robots_stand_upright_on_a_floor_of_the_goal(pairs):
    for episode, entry in pairs:
        rotation = np.array(entry.start_rotation, dtype=np.float64)
        assert np.linalg.norm(rotation) == pytest.approx(1.0, abs=1e-4)
        assert rotation[0] == rotation[2] == 0.0
        assert np.abs(episode.view_points[:, 2] - episode.start_z).min() < 0.2


def test_view_points_look_at_their_object(dataset):
    for goals in dataset.goals_by_category.values():
        for goal in goals:
            middle = in_scene(goal.position)
            for point in goal.view_points:
                state = point.agent_state
                pose, _ = pose_from_habitat(state.position, state.rotation)
                if pose.distance_to(middle[0], middle[1]) > 0.5:
                    assert abs(pose.bearing_to(middle[0], middle[1])) < np.radians(60.0)


def test_categories_are_asked_for_in_words(pairs):
    asked = {entry.object_category: episode.goal.text for episode, entry in pairs}
    assert asked["tv_monitor"] == "tv"
    assert asked["chest_of_drawers"] == "chest of drawers"
    assert asked["cushion"] == "pillow"
    assert not any("_" in text for text in asked.values())
