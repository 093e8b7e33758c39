"""The questions of the `paper` preset, to the byte, so that figures of versions compare."""

import hashlib

import numpy as np

from chat_models import Parrot
from drawn_grids import divide_into_blocks, drawn
from exploration_views import exploration_view
from hypernav.app.build.presets import preset
from hypernav.core.exploring.overview import Overview
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog
from hypernav.search.models.chat.vlm_families import family_named
from hypernav.search.perception.explorers.block_explorer import BlockExplorer
from hypernav.search.perception.explorers.geometric_reasoner import GeometricReasoner
from hypernav.search.perception.explorers.map_question import VlmReasoner, map_question
from hypernav.search.perception.local.vlm_detector import grounding_question
from hypernav.search.perception.local.yes_no_checks import presence_question

PAPER = preset("paper")
GOAL = Goal("the chair in the office")
VIEW = np.zeros((56, 84, 3), np.uint8)
ROBOT = Pose2(1.5, 1.5, 0.4)
TRAJECTORY = [(1.0, 1.0), (1.2, 1.1), (1.5, 1.5)]
# A walled room of 6 m by 4 m with furniture, open to the unknown on its right.
ROOM = drawn(
    """
    ##############################
    #.............#..............?
    #.....##......#..............?
    #.....##.....................?
    #............................?
    #.............#.....####.....?
    #.............#.....####.....?
    ##############################
    """,
    scale=10,
)
CONTEXT = (
    "A robot searches an unknown building for: chair in the office. The picture is the map "
    "that it has drawn so far, seen from above: white is free floor, dark is walls and furniture, "
    "grey is not yet explored. The orange arrow is the robot and where it looks, the blue line is "
    "where it has been. The explored area is divided into numbered blocks: {numbers}.\n\n"
    "Which numbered block should the robot go to next to find the chair in the office? Think "
    "about what kind of room each part may be and where unexplored space begins. Answer with the "
    "number of one block and a short reason."
)


def test_the_question_for_boxes():
    question = grounding_question(PAPER.grounding, family_named("qwen2.5-vl"), VIEW, GOAL)
    assert question.text == (
        "Locate every chair in the office in the picture and report the bounding boxes in JSON "
        'format, for example [{"bbox_2d": [x1, y1, x2, y2], "label": "chair in the office"}]. '
        "If there is no chair in the office in the picture, answer []."
    )
    assert (question.allowed, question.form, question.max_tokens) == ((), None, 300)
    assert question.images[0].tobytes() == VIEW.tobytes()


def test_the_question_at_the_goal():
    question = presence_question(PAPER.presence, VIEW, GOAL)
    text = "Is there a chair in the office in this picture? Answer yes or no."
    assert question.text == text
    assert (question.allowed, question.max_tokens) == (("yes", "no"), 8)


class Listening(VlmReasoner):
    """Keeps the overviews that it is asked about."""

    seen: Overview

    def choose(self, overview: Overview, goal: Goal, excluded: frozenset[int]):
        self.seen = overview
        return super().choose(overview, goal, excluded)


def test_the_question_about_the_map():
    log, parrot = ExchangeLog(), Parrot("1", "1", "3")
    reasoner = Listening(parrot, log, GeometricReasoner(log), PAPER.block_choice)
    clearances_m = PAPER.planning.clearances_m(PAPER.embodiment.body)
    explorer = BlockExplorer(
        reasoner, PAPER.overview, PAPER.mapping, clearances_m, PAPER.embodiment
    )
    explorer.next_destination(exploration_view(ROOM, ROBOT, goal=GOAL, trajectory=TRAJECTORY))
    blocks = divide_into_blocks(ROOM, ROBOT, PAPER.mapping, clearances_m[0])
    context = CONTEXT.format(numbers=", ".join(str(block.number) for block in blocks))
    assert parrot.asked[0].text == context
    assert all(question.text.startswith(context) for question in parrot.asked)
    assert {(question.allowed, question.max_tokens) for question in parrot.asked} == {((), 300)}
    (image,) = {question.images[0].tobytes() for question in parrot.asked}
    assert parrot.asked[0].images[0].shape == (768, 768, 3)
    assert (
        hashlib.sha256(image).hexdigest()
        == "e1ddad79e5a722e4248c6acf5de6e2a734f62df2a63ef25df6d9661beabc542b"
    )
    again = map_question(PAPER.block_choice, reasoner.seen, GOAL, frozenset({2, 1}))
    assert again.text == context + " Don't answer number [1, 2]."
    assert again.images[0].tobytes() == image
