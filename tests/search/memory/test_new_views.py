"""Views that are new: only they are looked at whole, for things and for key images."""

import math

import pytest

from hypernav.app.build.agents import build_search
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.search.memory.floor import SearchMemory
from hypernav.search.memory.key_images import KeyImages
from hypernav.search.memory.memory import Memory
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from small_episodes import episode_from
from small_worlds import small_config, two_rooms


@pytest.mark.parametrize(
    ("robot", "is_new"),
    [
        (Pose2(0.5, 0.0, 0.0), False),
        (Pose2(0.5, 0.0, math.radians(-30.0)), False),
        (Pose2(1.0, 0.0, 0.0), True),
        (Pose2(0.0, 0.0, math.radians(60.0)), True),
    ],
)
def test_a_view_is_new_from_far_enough_away_or_after_turning_far_enough(robot, is_new):
    search = SearchMemory()
    search.note_view(Pose2(0.0, 0.0, 0.0))
    assert search.has_new_view
    search.note_view(robot)
    assert search.has_new_view is is_new


def test_small_moves_add_up_to_a_new_view():
    search = SearchMemory()
    views = list[bool]()
    for k in range(9):
        search.note_view(Pose2(0.25 * k, 0.0, 0.0))
        views.append(search.has_new_view)
    assert [k for k, is_new in enumerate(views) if is_new] == [0, 3, 6]


class Counting(GroundTruthDetector):
    """Counts the images that all things are looked for in."""

    asked = 0

    def things_in(self, observation, detections):
        Counting.asked += 1
        return super().things_in(observation, detections)


def test_all_things_are_looked_for_in_new_views_alone_and_none_is_left_out():
    config = small_config()
    agent = build_search(config, Counting(), ExchangeLog())
    memory = Memory(config.mapping, config.embodiment, images=KeyImages(10**9))
    episode = episode_from(Pose2(2.5, 1.0, 1.5), "bed")
    Counting.asked = 0
    run = EpisodeRun(agent, two_rooms(), episode, memory=memory)
    steps = len(list(run))
    assert 2 <= Counting.asked <= 0.7 * steps
    assert {one.label for one in memory.floor.things.known} >= {"bed"}
    (bed, _), *_ = memory.floor.things.fitting(Goal("bed"))
    assert bed.seen > 1
