import numpy as np
import pytest

from box_scenes import room_boxes, scene_of
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.lab.evaluation.refinement.goal_position import GoalPosition, judge_position
from hypernav.search.memory.goal_area import GoalArea
from hypernav.simulator.worlds.simulation import SimulatedWorld
from small_episodes import episode_from
from small_worlds import small_config

CONFIG = small_config("paper")
START = Pose2(1.0, 2.0, 0.0)
WALL_X = 4.0


@pytest.fixture(scope="module")
def room():
    """A bed at x 2.5 to 3, a wall at x 4, and behind it a part that no door leads to."""
    scene = scene_of(
        *room_boxes(6.0, 4.0),
        (None, (WALL_X, 0.0, 0.0), (WALL_X + 0.1, 4.0, 2.5)),
        ("bed", (2.5, 1.5, 0.0), (3.0, 2.5, 0.5)),
    )
    world = SimulatedWorld(scene, CONFIG.world, CONFIG.embodiment)
    return world, world.reset(episode_from(START))


def judged(room, points, iterations=3):
    """What becomes of an area around points of the scene."""
    world, observation = room
    moved = np.array([(x - START.x, y - START.y, z) for x, y, z in points])
    area = GoalArea.from_points(
        moved, resolution_m=0.05, iterations=iterations, largest_cluster_only=False
    )
    assert area is not None
    goal = world.goal_truth(Goal("bed"))
    return judge_position(area, observation.robot, world, goal, CONFIG)


def test_an_area_before_the_goal_gives_a_good_position(room):
    position = judged(room, [(2.6, 2.0, 0.5), (2.7, 2.0, 0.5)])
    assert position == GoalPosition(
        in_obstacle=False, unreachable=False, occluded=False, fails=False
    )


def test_cells_that_were_not_dilated_lie_in_the_goal_itself(room):
    """The robot stops before them all the same: the facts are counted each by itself."""
    position = judged(room, [(2.6, 2.0, 0.5), (2.7, 2.0, 0.5)], iterations=0)
    assert position.in_obstacle
    assert not position.occluded
    assert not position.unreachable


def test_an_area_behind_a_wall_without_a_door_is_unreachable(room):
    position = judged(room, [(5.2, 2.0, 0.5)])
    assert position.unreachable
    assert position.fails
    assert not position.in_obstacle


def test_an_area_that_turns_the_robot_away_from_the_goal_occludes_it(room):
    assert judged(room, [(0.35, 0.35, 1.0)]).occluded


def test_a_stop_that_sees_the_goal_from_afar_fails(room):
    position = judged(room, [(1.25, 2.0, 0.5)])
    assert position.fails
    assert not position.occluded
    assert not position.unreachable
