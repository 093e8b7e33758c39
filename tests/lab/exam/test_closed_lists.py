"""A detector of a closed list is asked for what it can name, and the share of the rest is said."""

from pathlib import Path

import numpy as np
import pytest

from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.core.geometry.boxes import Box
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.observation import LabelledPixels, Observation
from hypernav.lab.exam.bank import Bank, Sheet
from hypernav.lab.exam.examinee import Examinee
from hypernav.lab.exam.questions import ExamQuestion
from hypernav.lab.exam.sitting import nameless_of, sit
from small_worlds import small_config

CLOSED = '''
from hypernav import Box, Detection, GoalError

class Closed:
    """Knows beds and chairs, sees the bed, and takes something beside it for a chair."""

    def check_goal(self, goal):
        if goal.text not in ("bed", "chair"):
            raise GoalError(f"no {goal.text}")

    def detect(self, observation, goal):
        self.check_goal(goal)
        told = [("chair", Box(90, 20, 110, 60)), ("bed", Box(20, 20, 60, 80))]
        return [Detection(box, 0.9, name, is_goal=name == goal.text) for name, box in told]
'''


@pytest.fixture
def examinee(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Examinee:
    (tmp_path / "closed_eye.py").write_text(CLOSED)
    monkeypatch.syspath_prepend(tmp_path)
    made = Examinee(small_config(), ComponentSpecs(detector="closed_eye:Closed"), None)
    made.check()
    return made


def question(sheet: Sheet, text: str, number: int) -> ExamQuestion:
    ids = np.full((120, 160), -1, np.int32)
    ids[20:80, 20:60] = 3
    camera = PinholeCamera.from_hfov(160, 120, 79.0)
    here, goal = Pose2(0.0, 0.0, 0.0), Goal(text)
    truth = LabelledPixels(ids, {3: ObjectLabel("bed")})
    view = Observation(
        np.zeros((120, 160, 3), np.uint8),
        np.ones((120, 160), np.float32),
        camera,
        Transform.identity(),
        here,
        truth,
    )
    boxes = (Box(20.0, 20.0, 60.0, 80.0),) if text == "bed" else ()
    stratum = "near" if boxes else "absent"
    name = sheet.question_id(number, "boxes", stratum, goal)
    return ExamQuestion(name, "boxes", stratum, sheet.scene, goal, view, boxes=boxes)


def gather(sheet: Sheet) -> list[ExamQuestion]:
    """Of the first sheet a bed to find, two things without a name, and a chair that isn't there."""
    texts = ("bed", "table lamp", "table lamp", "wardrobe", "chair") if sheet.number == 0 else ()
    return [question(sheet, text, number) for number, text in enumerate(texts)]


def test_what_it_has_no_name_for_is_left_out_and_said(examinee: Examinee, tmp_path: Path):
    bank = Bank("train", "quick", examinee.kinds, {("boxes", "near"): 30, ("boxes", "absent"): 30})
    folder, always = tmp_path / "exam", {"who": "closed"}

    def sat(gather=gather):
        return sit(
            folder,
            bank,
            gather,
            examinee,
            configuration=always,
            at_once=1,
            watch=lambda _: None,
        )

    answers = sat()
    assert [(one.goal, one.score) for one in answers] == [("bed", 1.0), ("chair", 0.0)]
    assert [len(one.boxes) for one in answers] == [1, 1]  # what isn't the goal is no answer
    nameless = nameless_of(folder)
    assert nameless.goals == ("table lamp", "wardrobe")
    assert nameless.share == pytest.approx(0.6)
    assert nameless.words.startswith("60% of the bank's questions for boxes were left out")
    assert [one.goal for one in sat(lambda sheet: [])] == ["bed", "chair"]  # nothing is asked again
    assert nameless_of(folder) == nameless
