"""Real, tiny networks with random weights sit the exam to its end, no better than by chance."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from hypernav.app.cli.main import main
from hypernav.lab.exam import bank

SMALL = ("embodiment.camera.width=160", "embodiment.camera.height=120")
SHORT = ("grounding.max_tokens=16", "arrows.max_tokens=16", "chat_guide.max_tokens=16")
CLOSED = ("block_choice.mode=constrained",)  # so that every answer names a block
QUOTAS = {
    ("block", "map"): 15,
    ("boxes", "near"): 8,
    ("boxes", "absent"): 8,
    ("presence", "there"): 8,
    ("presence", "not there"): 8,
    ("near", "near"): 4,
    ("near", "far"): 4,
    ("arrow", "view"): 4,
    ("direction", "view"): 4,
    ("images", "shown"): 4,
    ("images", "none"): 4,
}


@pytest.fixture(autouse=True)
def few_questions(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bank, "QUICK", QUOTAS)


def examined(out: Path, *who: str) -> dict[str, dict]:
    """The marks by type, after an exam by the command."""
    settings = ("--set", *SMALL, *SHORT, *CLOSED)
    with pytest.raises(SystemExit) as stop:
        main(["exam", *who, "--bank", "train", "--predict", "0", "--out", str(out), *settings])
    assert not stop.value.code
    assert (out / "index.html").read_text().startswith("<!doctype html>")
    result = json.loads((out / "exam.json").read_text())
    assert result["count"] == result["wanted"]
    return {one["kind"]: one for one in result["types"]}


def test_a_chat_model(tmp_path: Path, tiny: Callable[[str], Path]):
    marks = examined(tmp_path / "exam", "--vlm", f"local:{tiny('qwen25_vl')}")
    assert set(marks) == {"block", "boxes", "presence", "near", "arrow", "direction", "images"}
    for kind in ("block", "presence"):
        score = marks[kind]["score"]
        assert score["low"] <= marks[kind]["chance"] <= score["high"]
    assert all(one["tokens_in"] > 20 for one in marks.values())
    assert not marks["block"]["unusable"]


def test_a_detector(tmp_path: Path, tiny: Callable[[str], Path]):
    marks = examined(tmp_path / "exam", "--detector", f"zero-shot:{tiny('owlv2')}")
    assert set(marks) == {"boxes"}
    near = next(part for part in marks["boxes"]["parts"] if "at most 2.5 m" in part["name"])
    assert near["score"]["low"] < 0.05  # a box by chance hardly ever covers the goal
    assert marks["boxes"]["calls"] == 0
    assert "Words of the questions" not in (tmp_path / "exam" / "index.html").read_text()


def test_a_segmenter(tmp_path: Path, tiny: Callable[[str], Path]):
    marks = examined(tmp_path / "exam", "--segmenter", f"sam:{tiny('sam')}")
    assert set(marks) == {"mask"}
    assert marks["mask"]["count"] == QUOTAS["boxes", "near"]
    assert 0.0 <= marks["mask"]["overlap"] < 1.0
