"""Stand-ins err as the exam's answers did, and the same way about a thing each time."""

import math
from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exam_answers import SIZE, TRUE_BOX, boxed, checked, chose
from hypernav.core.episode import EpisodeTruth
from hypernav.core.exploring.overview import Block, BlockChoice, Overview
from hypernav.core.geometry.boxes import Box
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel
from hypernav.lab.exam.prediction.choices import choices_of
from hypernav.lab.exam.prediction.confusion import confusion_of
from hypernav.lab.exam.prediction.mimics import Asked, MimicDetector, MimicPresence, MimicReasoner
from hypernav.lab.exam.prediction.sight import BoxAnswer, sight_of
from hypernav.search.perception.config import VlmReasonerConfig
from images import thing_before_wall

BED = Goal("bed")
THINGS = 60
ELSEWHERE = (100.0, 10.0, 140.0, 40.0)
COSTS = {"1": 5.0, "2": 9.0, "3": 12.0}

sides = st.floats(1.0, 150.0)


def seen(
    category: str,
    number: int,
    yaw: float = 0.2,
    *,
    away_m: float = 2.0,
    box: tuple[int, int, int, int] = (40, 30, 90, 80),
):
    """A view of the thing of a number."""
    label, robot = ObjectLabel(category, attributes=(str(number),)), Pose2(0.0, 0.0, yaw)
    return thing_before_wall(thing_m=away_m, box=box, robot=robot, label=label)


def detector(*answers) -> MimicDetector:
    return detector_with(0, *answers)


def detector_with(crops: int, *answers) -> MimicDetector:
    confusion = confusion_of(answers)
    assert confusion.sight is not None
    return MimicDetector(confusion.sight, confusion, Asked(), crops)


def answer_to(answered) -> BoxAnswer:
    sight = sight_of([answered])
    assert sight is not None
    return (*sight.found, *sight.missed)[0]


def share(mimic: MimicDetector, category: str) -> float:
    return float(np.mean([bool(mimic.detect(seen(category, k), BED)) for k in range(THINGS)]))


def choices(*answers, times: int = 200) -> Counter[int | None]:
    """How often each block is chosen; the truly best is 1, then 2, then 3; the rule takes 2."""
    truth = EpisodeTruth()
    blocks = [Block(k, 0.0, 0.0, 2.0, 50, 30, (10.0 * k, 0.0), 0.0) for k in (3, 1, 2)]
    truth.tell(rng=np.random.default_rng(0), path_left_m=lambda x, _y: x)
    overview = Overview(tuple(blocks), Pose2(0, 0, 0))

    class Rule:
        def choose(self, overview: Overview, goal: Goal, excluded: frozenset[int]) -> BlockChoice:
            return BlockChoice(2, "the rule")

    how = choices_of(answers)
    assert how is not None
    mimic = MimicReasoner(how, truth, VlmReasonerConfig(), Rule(), Asked())
    return Counter(mimic.choose(overview, BED, frozenset()).number for _ in range(times))


@given(st.tuples(sides, sides), st.tuples(sides, sides))
def test_a_perfect_box_stays_perfect_about_every_other_thing(corner, size):
    width, height = 400, 400
    (x, y), (w, h) = corner, size
    true = Box(x, y, x + w, y + h)
    perfect = answer_to(boxed("near", TRUE_BOX))
    box = perfect.same_error_on(true, width, height)
    assert box is not None
    assert box.iou(true) == pytest.approx(1.0)


def test_a_box_elsewhere_stays_where_it_was_in_the_image():
    wrong = answer_to(boxed("near", ELSEWHERE))
    assert wrong.is_elsewhere
    box = wrong.same_error_on(Box(0.0, 0.0, 5.0, 5.0), *SIZE)
    assert box is not None
    assert (box.x_min, box.y_min, box.x_max, box.y_max) == pytest.approx(ELSEWHERE)
    assert BoxAnswer().same_error_on(Box(0.0, 0.0, 5.0, 5.0), *SIZE) is None


def test_goals_are_missed_as_often_as_in_the_exam():
    half = [boxed("near", TRUE_BOX), boxed("near", None)]
    never = [boxed("absent", None)]
    assert share(detector(boxed("near", TRUE_BOX), *never), "bed") == 1.0
    assert share(detector(boxed("near", None), *never), "bed") == 0.0
    assert abs(share(detector(*half, *never), "bed") - 0.5) < 4.0 * math.sqrt(0.25 / THINGS)


def test_goals_are_missed_where_those_of_the_exam_were():
    """Near and far goals look equally large here, so that only the distance can tell."""
    near, far = boxed("near", TRUE_BOX, away_m=1.0), boxed("far", None, away_m=4.0)
    mimic = detector(*[near, far] * 40, boxed("absent", None))
    assert all(mimic.detect(seen("bed", k, away_m=1.2), BED) for k in range(20))
    assert not any(mimic.detect(seen("bed", k, away_m=3.5), BED) for k in range(20))


def test_goals_are_missed_at_the_edge_of_the_image_if_those_of_the_exam_were():
    whole, cut = boxed("near", TRUE_BOX), boxed("near", None, true_box=(0.0, 20.0, 40.0, 80.0))
    mimic = detector(*[whole, cut] * 40, boxed("absent", None))
    assert all(mimic.detect(seen("bed", k), BED) for k in range(20))
    assert not any(mimic.detect(seen("bed", k, box=(0, 30, 50, 80)), BED) for k in range(20))


def test_other_things_are_taken_for_the_goal_only_if_the_exam_had_such_boxes():
    sees = boxed("near", TRUE_BOX)
    honest = detector(sees, boxed("absent", None), boxed("look-alike", None))
    confused = detector(sees, boxed("absent", None), boxed("look-alike", ELSEWHERE))
    assert share(honest, "sofa") == share(honest, "oven") == 0.0
    assert share(confused, "sofa") == 1.0
    assert share(confused, "oven") == 0.0


@pytest.mark.parametrize("by", ["thing", "view"])
def test_what_is_taken_for_the_goal_is_so_from_as_many_sides_as_in_the_exam(by: str):
    """Half of all answers have a box: all about every second sofa, or half about each."""
    is_boxed = [(k // 4 if by == "thing" else k) % 2 == 0 for k in range(160)]
    mimic = detector(
        boxed("near", TRUE_BOX),
        *(
            boxed("look-alike", ELSEWHERE if box else None, thing=k // 4, side=k % 4)
            for k, box in enumerate(is_boxed)
        ),
    )
    yaws = [2.0 * math.pi * k / 8 + 0.2 for k in range(8)]
    taken = np.array(
        [[bool(mimic.detect(seen("sofa", k, yaw), BED)) for yaw in yaws] for k in range(30)]
    ).mean(axis=1)
    always_or_never = np.mean((taken == 0.0) | (taken == 1.0))
    assert always_or_never > 0.7 if by == "thing" else always_or_never < 0.2


def test_an_answer_about_a_thing_does_not_change_while_the_view_does_not():
    mimic = detector(boxed("near", TRUE_BOX), boxed("near", None), boxed("absent", None))
    answers = [[bool(mimic.detect(seen("bed", k), BED)) for _ in range(3)] for k in range(20)]
    assert all(len(set(one)) == 1 for one in answers)
    assert {one[0] for one in answers} == {True, False}


def test_errors_belong_to_things_more_than_to_sides():
    mimic = detector(boxed("near", TRUE_BOX), boxed("near", None), boxed("absent", None))
    yaws = [2.0 * math.pi * k / 8 + 0.2 for k in range(8)]
    found = np.array(
        [[bool(mimic.detect(seen("bed", k, yaw), BED)) for yaw in yaws] for k in range(40)]
    )
    p = found.mean()
    assert found.mean(axis=1).var() > 3.0 * p * (1.0 - p) / len(yaws)


def test_presence_is_answered_by_what_is_there():
    confusion = confusion_of(
        [checked("there", "yes"), checked("look-alike", "yes"), checked("not there", "no")]
    )
    mimic = MimicPresence(confusion, Asked(), unsure_is_yes=False)
    assert mimic.is_present(seen("bed", 0), BED)
    assert mimic.is_present(seen("sofa", 0), BED)
    assert not mimic.is_present(seen("oven", 0), BED)


@pytest.mark.parametrize("unsure", [True, False])
def test_an_unusable_answer_counts_as_configured(unsure: bool):
    confusion = confusion_of([checked("there", None), checked("not there", "no")])
    assert MimicPresence(confusion, Asked(), unsure).is_present(seen("bed", 0), BED) is unsure


def test_blocks_are_as_good_as_in_the_exam():
    assert set(choices(*[chose(1, COSTS)] * 9)) == {1}
    assert set(choices(*[chose(3, COSTS)] * 9)) == {3}
    mixed = choices(*[chose(1, COSTS), chose(3, COSTS)] * 9)
    assert abs(mixed[1] - 100) < 4.0 * math.sqrt(50)
    assert mixed[2] < mixed[1]


def test_where_no_block_could_be_read_the_rule_chooses():
    assert set(choices(chose(None, COSTS))) == {2}


def test_questions_are_counted():
    mimic = detector_with(2, boxed("near", TRUE_BOX), boxed("absent", None))
    mimic.detect(seen("bed", 0), BED)
    mimic.detect(seen("oven", 0), BED)
    assert mimic.asked == {"ground": 2, "crop": 1}
