import math
from dataclasses import dataclass, field

import numpy as np
import pytest

from hypernav.core.exploring.floors import SeenThing
from hypernav.core.exploring.overview import Block, Overview
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.search.perception.config import VlmReasonerConfig
from hypernav.search.perception.explorers.map_question import map_question

CHAIR = Goal("the chair in the office")


def block(number: int, x: float, y: float, frontier: int) -> Block:
    return Block(number, x, y, 2.0, 100, frontier, (x + 1.0, y + 1.0), math.hypot(x, y))


BLOCKS = (
    block(1, 3.0, 3.0, 30),
    block(2, 3.0, -5.0, 0),
    block(3, -5.0, -1.0, 60),
    block(4, 6.0, -1.0, 10),
)


@dataclass(frozen=True, eq=False)
class Drawn(Overview):
    """Remembers which blocks an image was to show, and which were hatched."""

    drawn: list[tuple[set[int], set[int]]] = field(default_factory=list)

    def draw(self, shown, hatched) -> np.ndarray:
        self.drawn.append((set(shown), set(hatched)))
        return np.zeros((8, 8, 3), np.uint8)


def asked(excluded: frozenset[int] = frozenset(), **config):
    overview = Drawn(
        BLOCKS,
        Pose2(0.0, 0.0, 0.0),
        legend="white is floor",
        trajectory=[(6.5, 0.0)],
        things=[SeenThing("sofa", (3.5, 4.0)), SeenThing("lamp", (4.0, 4.5))],
    )
    return map_question(VlmReasonerConfig(**config), overview, CHAIR, excluded), overview.drawn


def test_each_block_is_described():
    question, drawn = asked()
    lines = question.text.splitlines()
    first, third, fourth = (line for line in lines if line.startswith("- block"))
    assert "- block 1: 4.2 m away, ahead on the left; 30% of the boundary" in first
    assert first.endswith("not visited yet; seen there: lamp, sofa")
    assert "seen there" not in third
    assert "behind" in third
    assert "60% of the boundary" in third
    assert "ahead; 10%" in fourth
    assert "the robot was there" in fourth
    assert "white is floor" in question.text
    assert question.text.endswith('a last line "Answer: N", where N is one of 1, 3, 4.')
    assert question.allowed == ()
    assert drawn == [({1, 3, 4}, set())]


@pytest.mark.parametrize("mode", ["paper", "reasoned", "constrained"])
def test_the_goal_is_named_without_its_article(mode):
    question, _ = asked(mode=mode)
    assert "find the chair in the office?" in question.text
    assert "the the" not in question.text


def test_what_is_excluded_is_hatched_and_neither_listed_nor_allowed():
    for mode in ("reasoned", "constrained"):
        question, drawn = asked(frozenset({3}), mode=mode)
        assert "3" not in question.text.replace("30%", "")
        assert "3" not in question.allowed
        assert drawn == [({1, 4}, {3})]


def test_every_switch_alone():
    assert "boundary to the unknown" not in asked(facts=False)[0].text
    assert asked(min_frontier_cells=0)[1][0][0] == {1, 2, 3, 4}
    assert asked(max_blocks=2)[1][0][0] == {1, 3}
    question, drawn = asked(frozenset({3}), list_excluded=True)
    assert question.text.endswith("Don't answer number [3].")
    assert drawn == [({1, 3, 4}, set())]
