import json
from pathlib import Path

from exam_answers import answered
from hypernav.core.trace import Exchange
from hypernav.lab.exam.results import Examined, wrappings_of, write_results


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
