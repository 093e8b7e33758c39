"""Laws of a goal in sight that no path leads to."""

import math
from dataclasses import replace

import pytest

from hypernav.app.build.agents import build_search
from hypernav.core.episode import Outcome
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.trace import Ending, ExchangeLog, Mode
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.search.agents.plan import Approaching, patience_of
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from meeting_room import meeting_room
from small_episodes import episode_from
from small_worlds import small_config

IN_THE_CORRIDOR = Pose2(10.5, 1.0, math.pi)


class Doubtful(GroundTruthDetector):
    """Sees what is there, with a score that says little."""

    def detect(self, observation, goal):
        return [replace(one, score=0.35) for one in super().detect(observation, goal)]


def search_for_the_screen(*, board_m, aisle_m, steps=300, open_the_way=True, detector=None):
    config = small_config(search={"max_steps": steps, "open_the_way": open_the_way})
    eyes = detector or GroundTruthDetector()
    agent = build_search(config, eyes, ExchangeLog(), agent="hypernav")
    world = meeting_room(board_m=board_m, aisle_m=aisle_m)
    episode = EpisodeRun(agent, world, episode_from(IN_THE_CORRIDOR, "tv", max_steps=steps))
    return [step.trace for step in episode], episode.result()


@pytest.mark.parametrize(("board_m", "aisle_m"), [(0.76, 0.46), (0.80, 0.5)])
def test_a_goal_seen_with_a_true_path_is_not_left_for_good(board_m, aisle_m):
    steps, result = search_for_the_screen(board_m=board_m, aisle_m=aisle_m)
    assert result.outcome is Outcome.FOUND
    seen = next(step.step for step in steps if step.goal_area)
    assert {step.mode for step in steps[seen:]} <= {Mode.APPROACH, Mode.VERIFY, Mode.STOP}


def test_what_blocks_the_goal_is_waited_for_as_long_as_patience_lasts():
    config = small_config().search
    blocked = [
        replace(Approaching(patience_of(config)), blocked_steps=steps)
        for steps in range(config.patience_steps + 2)
    ]
    assert not blocked[0].may_clear(config)
    assert all(approaching.may_clear(config) for approaching in blocked[1:-1])
    assert not blocked[-1].may_clear(config)


@pytest.mark.slow
def test_without_it_the_goal_is_left():
    steps, _ = search_for_the_screen(board_m=0.76, aisle_m=0.46, open_the_way=False)
    seen = next(step.step for step in steps if step.goal_area)
    assert Mode.EXPLORE in {step.mode for step in steps[seen:]}


@pytest.mark.slow
def test_a_gap_that_fails_by_centimetres_is_looked_at_before_it_counts_as_closed():
    steps, _ = search_for_the_screen(board_m=0.8, aisle_m=0.32)
    looks = [step for step in steps if "looking from near" in step.reason]
    closed = [step for step in steps if "gap closed" in step.events]
    assert looks
    assert closed
    assert len({step.step for step in closed}) < 10  # remembered: none is looked at for ever


@pytest.mark.slow
def test_no_gap_is_looked_at_for_what_is_not_believed_in():
    steps, _ = search_for_the_screen(board_m=0.8, aisle_m=0.32, detector=Doubtful())
    assert any(step.goal_area for step in steps)
    assert not [step for step in steps if "looking from near" in step.reason]


def test_the_last_steps_lead_to_the_best_candidate_though_no_path_does():
    steps, _ = search_for_the_screen(board_m=0.8, aisle_m=0.32, steps=140)
    assert steps[-1].ending is Ending.FOUND
