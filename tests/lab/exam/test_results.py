import json
from pathlib import Path

import pytest

from exam_answers import answered, boxed
from hypernav.core.trace import Exchange
from hypernav.lab.exam.results import Examined, wrappings_of, write_results

ELSEWHERE = (100.0, 10.0, 140.0, 40.0)


def said(kind: str, text: str, *, by_model: bool = True) -> Exchange:
    return Exchange(kind=kind, asked="m", by_model=by_model, question="?", answer=text)


def test_names_what_was_taken_off_the_models_answers(tmp_path: Path):
    texts = ["<think>no</think>yes", "<think>yes</think>no<|im_end|>", "yes"]
    answers = [
        answered("presence", "there", number, exchanges=[said("verify", text)])
        for number, text in enumerate(texts)
    ]
    ruled = [said("choose block", "<think>", by_model=False)]
    answers.append(answered("block", "", exchanges=ruled))
    assert wrappings_of(answers) == {"<think>": 2, "turn tokens": 1}
    page = write_results(tmp_path, Examined("m", "auto", "quick", 4, {}, {}), answers).read_text()
    assert "wrapped, and were read without: &lt;think&gt; (2), turn tokens (1)" in page
    assert json.loads((tmp_path / "exam.json").read_text())["wrappings"]["<think>"] == 2


def test_says_nothing_where_nothing_was_taken_off(tmp_path: Path):
    plain = [answered("presence", "there", exchanges=[said("verify", "yes")])]
    page = write_results(tmp_path, Examined("m", "auto", "quick", 1, {}, {}), plain).read_text()
    assert "came wrapped" not in page


@pytest.mark.parametrize(
    ("mistaken", "sentence", "entries"),
    [
        (0, "No systematic fault is shown.", 0),
        (8, "One systematic fault is shown.", 1),  # a light one
        (16, "One systematic fault is shown.", 1),
    ],
)
def test_the_lead_counts_the_faults_that_the_section_lists(tmp_path, mistaken, sentence, entries):
    boxes = [ELSEWHERE] * mistaken + [None] * (24 - mistaken)
    answers = [boxed("look-alike", box) for box in boxes]
    page = write_results(tmp_path, Examined("m", "auto", "quick", 24, {}, {}), answers).read_text()
    assert sentence in page
    assert page.count('<div class="fault') == entries
    assert ("Nothing that these answers show." in page) is (entries == 0)
