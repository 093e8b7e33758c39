"""The path before and after the first sight of the goal, by labels and lengths of our own."""

import numpy as np

from hypernav.core.embodiment import Action
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.observation import LabelledPixels
from hypernav.core.world import Instance
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.lab.episodes.goal_sight import GoalSight, PathParts
from hypernav.lab.episodes.referee import Referee
from small_episodes import episode_from
from small_worlds import two_rooms

BED = ObjectLabel("bed")


class BedAtTen:
    """A goal on a line: its view point is at x = 10 m, and it is instance 3."""

    goal = Goal("bed")
    instances = (Instance(3, "bed", BED, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)),)
    view_points = np.array([[10.0, 0.0, 0.0]])

    def distance(self, x, y, z=None):
        return abs(10.0 - x)


def labels(pixels):
    """Labels of an image of 100×100 of which that many pixels, in full rows, show the bed."""
    ids = np.full((100, 100), -1, dtype=np.int32)
    ids.reshape(-1)[:pixels] = 3
    return LabelledPixels(ids, {3: BED})


def walk(shown):
    """A walk of a metre a step, with the bed in the image at some of the steps."""
    referee = Referee(BedAtTen(), (0.0, 0.0, 0.0))
    sight = GoalSight(referee)
    seen = []
    for step, pixels in enumerate(shown):
        seen.append(sight.watch(labels(pixels)))
        referee.watch((float(step + 1), 0.0, 0.0))
    return seen, sight.parts


def test_the_path_is_divided_where_the_goal_is_first_in_the_image():
    seen, parts = walk([0, 0, 0, 400, 0, 400])
    assert seen == [False, False, False, True, False, True]
    assert parts == PathParts(explored_m=3.0, approached_m=3.0, shortest_from_sight_m=7.0)


def test_a_goal_in_the_first_image_leaves_nothing_to_explore():
    _, parts = walk([400, 0])
    assert parts == PathParts(explored_m=0.0, approached_m=2.0, shortest_from_sight_m=10.0)


def test_a_goal_never_in_the_image_divides_nothing():
    assert walk([0, 0, 0]) == ([False] * 3, None)


def test_a_few_pixels_are_no_sight():
    assert walk([2])[0] == [False]


class Turning:
    """Turns round where it stands, and stops."""

    def reset(self, goal):
        self.left = 12

    def act(self, observation):
        self.left -= 1
        return Action.TURN_LEFT if self.left >= 0 else Action.STOP


def test_turning_sees_the_sofa_of_this_room_and_not_the_bed_of_the_next():
    start = Pose2(2.5, 1.0, 0.0)  # facing away from the sofa
    world = two_rooms(coloured=False)
    of_sofa = EpisodeRun(Turning(), world, episode_from(start, "sofa"))
    views = [step.goal_in_view for step in of_sofa]
    assert views[0] is False
    assert any(views)
    shortest = of_sofa.result().metrics.shortest_path_m
    assert of_sofa.result().parts == PathParts(0.0, 0.0, shortest)
    assert of_sofa.result().measures()["explored_m"] == 0.0


def test_what_is_behind_a_wall_is_not_in_view():
    run = EpisodeRun(
        Turning(), two_rooms(coloured=False), episode_from(Pose2(2.5, 1.0, 0.0), "bed")
    )
    assert not any(step.goal_in_view for step in run)
    assert run.result().parts is None
    assert "explored_m" not in run.result().measures()
