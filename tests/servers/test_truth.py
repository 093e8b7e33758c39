"""What the scripted model says is true of the scene, not of our geometric rule."""

import math

import pytest

from hypernav.core.exploring.overview import Block
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from overviews import BlankOverview
from servers.scripted import Asked
from servers.truth import Errors, Truth, TruthfulBrain
from small_episodes import episode_from
from small_worlds import two_rooms

BED = Goal("bed")
START = Pose2(2.5, 1.0, math.pi / 2)


def block(number: int, scene_x: float, scene_y: float, frontier: int) -> Block:
    """A block around a position of the scene, for a robot that started at START."""
    x, y = scene_y - START.y, START.x - scene_x
    travel_m = math.hypot(scene_x - START.x, scene_y - START.y)
    return Block(number, x - 0.5, y - 0.5, 1.0, 100, frontier, (x, y), travel_m)


# Behind the door to the bedroom, two corners with more to explore, and a point halfway to the door.
BLOCKS = (
    block(1, 5.4, 3.0, 5),
    block(2, 1.2, 3.6, 200),
    block(3, 4.5, 0.5, 90),
    block(4, 3.6, 2.0, 5),
)


def asked_with(errors: Errors, seed: int = 0) -> str:
    truth = Truth(world=two_rooms())
    two_rooms().reset(episode_from(START, BED))
    overview = BlankOverview(BLOCKS, Pose2(0.0, 0.0, 0.0))
    truth.draw(overview.image, overview, BED)
    text = "Which numbered block? N is one of 1, 2, 3, 4."
    return TruthfulBrain(truth, errors, seed)(Asked(text, [overview.image], [], {}))


def test_the_block_on_the_shortest_path_is_named():
    assert asked_with(Errors()).endswith("Answer: 1")


def test_another_one_is_named_as_often_as_told():
    answers = [asked_with(Errors(wrong_block=0.3), seed)[-1] for seed in range(100)]
    assert answers.count("1") == pytest.approx(70, abs=15)
    assert set(answers) == {"1", "2", "3", "4"}
