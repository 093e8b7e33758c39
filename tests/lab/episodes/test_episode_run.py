import math

import pytest

from hypernav.core.embodiment import Action
from hypernav.core.episode import Outcome
from hypernav.core.errors import StartError
from hypernav.core.geometry.transforms import Pose2
from hypernav.lab.episodes.episode_run import EpisodeRun
from small_episodes import episode_from
from small_worlds import two_rooms

BESIDE_BED = Pose2(6.3, 1.0, 0.0)


class Scripted:
    """Does what it is told, knows nothing, explains nothing."""

    def __init__(self, *actions):
        self._actions = list(actions)

    def reset(self, goal):
        self.goal = goal

    def act(self, observation):
        return self._actions.pop(0)


def run(*actions, goal="bed", start=BESIDE_BED, **options):
    episode = EpisodeRun(
        Scripted(*actions), two_rooms(coloured=False), episode_from(start, goal, **options)
    )
    steps = list(episode)
    return steps, episode.result()


def test_a_stop_at_the_goal_is_found():
    steps, result = run(Action.STOP)
    assert result.outcome is Outcome.FOUND
    assert (result.steps, result.metrics.spl, result.metrics.path_length_m) == (1, 1.0, 0.0)
    assert steps[0].grid is None
    assert steps[0].trace.action is Action.STOP


def test_a_stop_elsewhere_is_the_wrong_place():
    _, result = run(Action.STOP, start=Pose2(2.5, 1.0, 0.0))
    assert result.outcome is Outcome.WRONG_PLACE
    assert not result.metrics.success


def test_without_stop_nothing_is_found_even_at_the_goal():
    _, result = run(Action.TURN_LEFT, Action.TURN_LEFT, max_steps=2)
    assert result.outcome is Outcome.NOT_FOUND
    assert result.metrics.distance_to_goal_m < 0.1


def test_the_success_distance_can_be_chosen():
    start = Pose2(5.6, 1.0, 0.0)  # 0.4 m short of the view points
    assert run(Action.STOP, start=start)[1].outcome is Outcome.WRONG_PLACE
    assert run(Action.STOP, start=start, success_distance_m=1.0)[1].outcome is Outcome.FOUND


def test_path_length_is_what_was_really_driven():
    forward = [Action.MOVE_FORWARD] * 3
    _, result = run(*forward, Action.STOP, start=Pose2(2.0, 1.0, 0.0))
    assert result.metrics.path_length_m == pytest.approx(1.5)


def test_a_goal_that_the_scene_lacks_is_legal():
    _, result = run(Action.STOP, goal="piano")
    assert result.outcome is Outcome.WRONG_PLACE
    assert math.isinf(result.metrics.distance_to_goal_m)


def test_an_interrupted_episode_has_a_result():
    episode = EpisodeRun(
        Scripted(Action.TURN_LEFT), two_rooms(coloured=False), episode_from(BESIDE_BED)
    )
    next(iter(episode))
    result = episode.result(interrupted=True)
    assert (result.outcome, result.steps) == (Outcome.INTERRUPTED, 1)


def test_a_start_inside_a_wall_is_refused():
    with pytest.raises(StartError, match="nearest position"):
        run(Action.STOP, start=Pose2(5.0, 1.0, 0.0))
