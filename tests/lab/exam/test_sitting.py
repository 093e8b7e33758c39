"""The exam against a server that knows everything, and makes one mistake all the time."""

import json
import os
from collections.abc import Callable
from pathlib import Path

import pytest
from exam_servers import Knower, Spoiled

from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.components.exam_file import read_exam
from hypernav.app.build.components.fingerprints import prompt_hashes
from hypernav.core.errors import RunFolderError
from hypernav.lab.exam.bank import VIEWS, Bank, Sheet
from hypernav.lab.exam.examinee import Examinee
from hypernav.lab.exam.faults import faults_of
from hypernav.lab.exam.gathering import questions_of
from hypernav.lab.exam.marks import marks_of
from hypernav.lab.exam.questions import Answered, ExamQuestion, Kind
from hypernav.lab.exam.results import Examined, differences_of, digest_of, write_results
from hypernav.lab.exam.sitting import ANSWERS, Progress, read_answers, sit
from hypernav.search.models.chat.vlm_spec import open_chat
from servers.scripted import Personality, ScriptedServer
from small_worlds import small_config

pytestmark = pytest.mark.slow  # questions are made in whole buildings

Gather = Callable[[Sheet], list[ExamQuestion]]
CONFIG = small_config()
QUOTAS: dict[tuple[Kind, str], int] = {
    ("block", "map"): 45,
    ("boxes", "near"): 45,
    ("boxes", "far"): 15,
    ("boxes", "absent"): 45,
    ("presence", "there"): 30,
    ("presence", "not there"): 30,
    ("presence", "look-alike"): 15,
    ("near", "far"): 15,
    ("near", "near"): 15,
    ("arrow", "view"): 15,
    ("direction", "view"): 15,
    ("images", "shown"): 45,
    ("images", "none"): 45,
}
SHEETS = 5

NAMES: dict[Spoiled, set[str]] = {
    "": set(),
    "swapped axes": {"coordinates"},
    "0 to 1000": {"coordinates"},
    "always yes": {"says yes"},
    "always block 1": {"prefers block 1", "prefers image 1"},
    "ignores absence": {"ignores absence", "names images without the goal"},
    "half": {"unusable answers"},
}


@pytest.fixture(scope="session")
def found() -> dict[int, list[ExamQuestion]]:
    """All questions of a few sheets of the training bank, seen by a small camera."""
    sheets = list(Bank("train", "quick", ("block",)).sheets())[:SHEETS]
    return {sheet.number: questions_of(sheet, CONFIG) for sheet in sheets}


@pytest.fixture(scope="session")
def gather(found: dict[int, list[ExamQuestion]]) -> Callable[[Sheet], list[ExamQuestion]]:
    return lambda sheet: found.get(sheet.number, [])


class Exam:
    """Sits exams with the gathered questions."""

    def __init__(self, found: dict[int, list[ExamQuestion]], gather: Gather, folder: Path) -> None:
        self.known = [one for questions in found.values() for one in questions]
        self.gather, self.folder = gather, folder
        self.progress: list[Progress] = []
        self.stops: list[int] = []

    def sit(
        self, spoiled: Spoiled = "", *, part: str = "exam", most: int | None = None
    ) -> list[Answered]:
        """All answers; after so many the program is killed."""

        def watch(progress: Progress) -> None:
            self.progress.append(progress)
            if progress.answered_here == most:
                raise KeyboardInterrupt

        heard = Personality(honours=()) if spoiled == "half" else None
        with ScriptedServer(Knower(self.known, spoiled), heard) as server:
            chat = open_chat(server.spec, CONFIG.chat)
            examinee = Examinee(CONFIG, ComponentSpecs(vlm=server.spec), chat)
            bank = Bank("train", "quick", examinee.kinds, QUOTAS)
            try:
                return sit(
                    self.folder / part,
                    bank,
                    self.gather,
                    examinee,
                    configuration={"spoiled": spoiled},
                    at_once=4,
                    watch=watch,
                    stop=self.stops.append,
                )
            finally:
                self.asked = len(server.requests)


@pytest.fixture
def exam(found: dict[int, list[ExamQuestion]], gather: Gather, tmp_path: Path) -> Exam:
    return Exam(found, gather, tmp_path)


def test_questions_for_boxes_come_in_pairs_about_one_goal(found: dict[int, list[ExamQuestion]]):
    """So an exam that takes two of a stratum has two views of one thing, where there are two."""
    for questions in found.values():
        for stratum in ("near", "far", "look-alike"):
            goals = [one.goal.text for one in questions if one.stratum == stratum]
            often = {goal for goal in goals if goals.count(goal) >= VIEWS}
            if often:
                firsts = [goals[k : k + VIEWS] for k, goal in enumerate(goals) if goal in often]
                assert any(len(set(pair)) == 1 for pair in firsts)


@pytest.mark.parametrize("spoiled", NAMES)
def test_each_known_fault_is_named(exam: Exam, spoiled: Spoiled):
    answers = exam.sit(spoiled)
    named = faults_of(answers, "scripted/Qwen2.5-VL-7B", "auto")
    found = {one.check for one in named}
    assert found >= NAMES[spoiled]
    # What follows from the fault may be named as well; a model without one has none.
    assert found <= NAMES[spoiled] | {"too sure", "unusable answers"}
    assert spoiled or not found
    told = " ".join(f"{one.said} {one.remedy}" for one in named)
    assert spoiled != "swapped axes" or "x and y swapped" in told
    assert spoiled != "0 to 1000" or "grounding.family=thousandths" in told


def test_who_knows_everything_is_always_right(exam: Exam):
    marks = {one.kind: one for one in marks_of(exam.sit())}
    assert set(marks) == {"block", "boxes", "presence", "near", "arrow", "direction", "images"}
    scores = {kind: one.score.mean for kind, one in marks.items()}
    # Whole pixels of a small image are too coarse for the smallest boxes.
    assert scores.pop("boxes") > 0.9
    assert set(scores.values()) == {1.0}
    assert marks["block"].regret_m is not None
    assert marks["block"].regret_m <= 0.5
    assert marks["block"].chance < 1.0


def test_a_killed_exam_goes_on_and_equals_a_whole_one(exam: Exam):
    whole = exam.sit(part="whole")
    calls = exam.asked
    with pytest.raises(KeyboardInterrupt):
        exam.sit(part="killed", most=12)
    (under_way,) = exam.stops  # said before they are waited for; a whole exam says nothing
    assert 0 <= under_way <= 4
    path = exam.folder / "killed" / ANSWERS
    path.write_bytes(path.read_bytes() + b'{"id": "half a li')
    before = exam.asked
    resumed = exam.sit(part="killed")
    assert [(o.id, o.chosen, o.boxes) for o in resumed] == [
        (o.id, o.chosen, o.boxes) for o in whole
    ]
    assert before < calls
    assert exam.asked <= calls - 12  # nothing that was answered is asked again


@pytest.mark.parametrize("kind", ["link", "pipe"])
def test_an_exam_from_a_stranger_leads_to_no_file_elsewhere(tmp_path: Path, kind: str):
    mine, folder = tmp_path / "mine", tmp_path / "exam"
    mine.write_text("my only copy, without a line's end")
    folder.mkdir()
    if kind == "link":
        (folder / ANSWERS).symlink_to(mine)
    else:
        os.mkfifo(folder / ANSWERS)
    with pytest.raises(RunFolderError, match=f"is a {kind}"):
        read_answers(folder)
    assert mine.read_text() == "my only copy, without a line's end"


def test_a_half_line_is_cut_off_in_the_folder_only(tmp_path: Path):
    mine = tmp_path / "mine"
    mine.write_text("whole\nnot whole")
    (tmp_path / ANSWERS).hardlink_to(mine)
    with pytest.raises(RunFolderError):  # no line of it is an answer
        read_answers(tmp_path)
    assert mine.read_text() == "whole\nnot whole"


def test_there_is_a_forecast_after_ten_answers(exam: Exam):
    exam.sit()
    by_done = {one.answered_here: one for one in exam.progress}
    assert by_done[9].left_s is None
    assert by_done[10].left_s is not None
    cost = by_done[10].cost(1.0, 1.0)
    assert cost is not None
    assert cost > 0.0
    assert by_done[10].cost(None, None) is None


def test_a_folder_of_another_exam_is_refused(exam: Exam):
    exam.sit()
    with pytest.raises(RunFolderError, match="spoiled"):
        exam.sit("always yes")


def test_page_and_json_hold_what_was_found(exam: Exam):
    answers = exam.sit("always yes")
    examined = Examined(
        "<model>", "auto", "train, quick", 300, {"block": "vlm"}, prompt_hashes(CONFIG), 1.0, 1.0
    )
    page = write_results(exam.folder / "exam", examined, answers).read_text()
    assert "&lt;model&gt;" in page
    assert "Says yes." in page
    assert page.count("data:image/webp") > 3
    result = json.loads((exam.folder / "exam" / "exam.json").read_text())
    assert result["cost"] > 0.0
    assert {one["kind"] for one in result["types"]} == {one.kind for one in answers}
    assert result["faults"][0]["check"] == "says yes"
    taken = read_exam(exam.folder / "exam")  # as a search reads it
    assert set(taken.costs) >= {"ground", "choose block", "verify"}
    assert taken.worth.presence
    assert taken.worth.boxes[-1][1] > 2.0


def test_other_questions_have_another_digest(exam: Exam):
    answers = exam.sit()
    moved = answers[0].model_copy(update={"conditions": {"light": 0.123}})
    assert digest_of(answers) == digest_of(list(answers))
    assert digest_of([moved, *answers[1:]]) != digest_of(answers)


def test_two_exams_are_compared_question_by_question(exam: Exam):
    good, bad = exam.sit(part="good"), exam.sit("always yes", part="bad")
    gaps = {one.words: one.gap.difference for one in differences_of(bad, good)}
    assert gaps["Is it really there"].mean > 0.0
    assert gaps["Where is it in this image"].mean == 0.0
    same = differences_of(good, good)
    assert all(one.gap.difference.mean == 0.0 and one.gap.p_value == 1.0 for one in same)


def test_every_question_has_a_name_of_its_own_and_a_truth_to_be_missed(
    found: dict[int, list[ExamQuestion]],
):
    ids = [one.id for questions in found.values() for one in questions]
    assert len(set(ids)) == len(ids)
    for one in (one for questions in found.values() for one in questions):
        assert not one.costs or 0 < len(one.right) < len(one.costs)
        assert (one.kind == "mask") == (one.mask is not None)
        assert bool(one.boxes) == (one.kind == "mask" or one.stratum in {"near", "far"}) or (
            one.kind == "near"
        )
