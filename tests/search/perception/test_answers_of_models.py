"""Answers as public models give them, each with the reading that it must have.

``tests/search/models/chat/answers.jsonl`` holds an answer a line: model, kind of question, text,
expected reading and the page that it was written after. Boxes and points are in pixels of an image
of 640 by 480, with their labels. What can't be told from an answer is unusable: no box, no yes.
"""

import json
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from arrow_views import arrow, view_of
from hypernav.core.chat import Question
from hypernav.search.models.chat.answer_parsing import final_answer, parse_answer, unwrapped
from hypernav.search.models.chat.vlm_families import family_named, family_of
from hypernav.search.perception.explorers.map_question import summarised
from hypernav.search.perception.image_recall import named_images
from hypernav.search.perception.local.grounding_format import read_grounding
from hypernav.search.rivals.arrows.arrow_reasoners import named_numbers
from hypernav.search.rivals.navvlm.guides import direction_in

FILE = Path(__file__).parents[1] / "models" / "chat" / "answers.jsonl"
ANSWERS: list[dict[str, Any]] = [json.loads(line) for line in FILE.read_text("utf-8").splitlines()]
ALLOWED = {"yes_no": ("yes", "no"), "choice": ("1", "2", "3", "8", "9", "12")}
VIEW = view_of(arrow(1), arrow(2), arrow(3))


def answer_to(one: dict[str, Any]):
    question = Question(one["kind"], "?", allowed=ALLOWED.get(one["kind"], ()))
    return parse_answer(question, one["text"], model=one["model"])


def reading_of(one: dict[str, Any]) -> Any:
    answer = answer_to(one)
    match one["kind"]:
        case "yes_no" | "choice":
            return answer.value
        case "block":
            return summarised(one["text"], [3, 5, 8, 9])
        case "arrow":
            return list(named_numbers(final_answer(one["text"]), VIEW))
        case "direction":
            return "explore" if answer.fault is not None else str(direction_in(answer.value))
        case "images":
            found = None if answer.fault is not None else named_images(one["text"], 6)
            return None if found is None else list(found)
    raise AssertionError(one["kind"])


@pytest.mark.parametrize(
    "one", ANSWERS, ids=[f"{k}-{one['model']}-{one['kind']}" for k, one in enumerate(ANSWERS, 1)]
)
def test_reads_what_a_model_says(one: dict[str, Any]):
    removed = unwrapped(one["text"]).removed
    assert set(one.get("removed", ())) <= set(removed)
    if "fault" in one:
        fault = answer_to(one).fault
        assert fault is not None
        assert fault.value == one["fault"]
    if one["kind"] != "boxes":
        assert reading_of(one) == one["expected"]
        return
    named = one.get("family")
    family = family_of(one["model"]) if named is None else family_named(named)
    found = read_grounding(one["text"], family, 640, 480, names_goal=lambda key: key == "sofa")
    boxes = [(*_corners(each.box), each.label) for each in found.boxes]
    points = [(each.x, each.y, each.label) for each in found.points]
    for read, expected in ((boxes, one["expected"]), (points, one.get("points", []))):
        assert [each[-1] for each in read] == [each[-1] for each in expected]
        for each, wanted in zip(read, expected, strict=True):
            assert each[:-1] == pytest.approx(wanted[:-1], abs=0.8)
    assert sorted(found.rejected) == sorted(one.get("rejected", []))


def _corners(box: Any) -> tuple[float, float, float, float]:
    return box.x_min, box.y_min, box.x_max, box.y_max


def test_there_are_answers_of_every_kind_and_of_many_models():
    kinds = Counter(one["kind"] for one in ANSWERS)
    assert len(ANSWERS) >= 200
    assert set(kinds) == {"yes_no", "boxes", "block", "choice", "arrow", "direction", "images"}
    assert min(kinds.values()) >= 20
    assert len({one["model"] for one in ANSWERS}) >= 40
    assert all(one["source"] for one in ANSWERS)
