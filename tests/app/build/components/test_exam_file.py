"""What a search takes from an exam's file, and which files it refuses."""

import json
from pathlib import Path

import pytest

from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.components.exam_file import read_exam, without_auto
from hypernav.app.build.presets import preset
from hypernav.core.errors import ConfigError
from hypernav.io.layered_config import layered

SERVER = "openai:http://localhost:8000/v1"


COST = {"calls": 1.0, "seconds": 1.0, "tokens_in": 9.0, "tokens_out": 9.0}


def written(folder: Path, **changes: object) -> Path:
    content = {
        "format": "hypernav-exam",
        "version": 2,
        "model": "qwen",
        "who": {"block": "vlm", "boxes": "vlm", "presence": "vlm", "model": "qwen"},
        "worth": {"presence": [[0.0, 0.1], [1.0, 0.8]], "boxes": [[1.0, 3.2]]},
        "predictions": [
            {
                "preset": "default",
                "steps": 90.0,
                "asked": {},
                "seconds": 1.0,
                "leave_out": ["block"],
            },
            {
                "preset": "paper",
                "steps": 90.0,
                "asked": {},
                "seconds": 1.0,
                "leave_out": ["presence"],
            },
        ],
        "more than searches need": 1,
    }
    path = folder / "exam.json"
    path.write_text(json.dumps(content | changes))
    return path


def test_the_worth_of_answers_becomes_values_of_the_configuration(tmp_path: Path):
    exam = read_exam(written(tmp_path))
    config = exam.applied(preset("default"), unchecked=False)
    assert config.presence.calibration == ((0.0, 0.1), (1.0, 0.8))
    assert config.local.score_weights == ((1.0, 3.2),)
    assert config.presence.enabled
    assert not exam.applied(preset("default"), unchecked=True).presence.enabled
    assert read_exam(tmp_path) == exam  # its folder will do


def test_auto_leaves_out_what_the_exam_says(tmp_path: Path):
    exam = read_exam(written(tmp_path))
    specs = ComponentSpecs(vlm=f"{SERVER}#qwen", reasoner="auto")
    by_rule, unchecked = without_auto(specs, exam, "default")
    assert (by_rule.reasoner, unchecked) == ("geometric", False)
    by_model, unchecked = without_auto(specs, exam, "paper")
    assert (by_model.reasoner, unchecked) == ("vlm", True)
    named = ComponentSpecs(reasoner="random")
    assert without_auto(named, None, "default") == (named, False)


def test_auto_needs_an_exam_with_a_prediction(tmp_path: Path):
    auto = ComponentSpecs(reasoner="auto")
    unsaid = read_exam(written(tmp_path, predictions=[]))
    for exam in (None, unsaid):
        with pytest.raises(ConfigError, match="--exam"):
            without_auto(auto, exam, "default")


def test_auto_in_capitals_is_told_of_auto(tmp_path: Path):
    for exam in (None, read_exam(written(tmp_path))):
        with pytest.raises(ConfigError, match="did you mean 'auto'"):
            without_auto(ComponentSpecs(reasoner="Auto"), exam, "default")


@pytest.mark.parametrize(
    ("specs", "words"),
    [
        (ComponentSpecs(vlm=f"{SERVER}#llava"), "not of llava"),
        (ComponentSpecs(vlm=SERVER), f"--vlm {SERVER}#qwen"),
        (ComponentSpecs(), "name it with --vlm"),
        (ComponentSpecs(vlm=f"{SERVER}#qwen", detector="yolox:a.onnx"), "yolox:a.onnx"),
    ],
)
def test_the_exam_of_another_is_refused(tmp_path: Path, specs: ComponentSpecs, words: str):
    exam = read_exam(written(tmp_path))
    exam.check_is_of(ComponentSpecs(vlm=f"{SERVER}#qwen"))
    with pytest.raises(ConfigError) as refused:
        exam.check_is_of(specs)
    assert words in str(refused.value)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"version": 1}, "version"),
        ({"format": "a map"}, "format"),
        ({"worth": {"boxes": [[1.0, 2.0], [0.5, 1.0]]}}, "worth.boxes"),
        ({"worth": {"boxes": [[1.0, 1e9]]}}, "worth.boxes"),
        ({"worth": {"presence": [[0.0, -5.0], [1.0, 0.8]]}}, "worth.presence.*0 to 1"),
        ({"worth": {"presence": [[0.0, 0.8], [1.0, 0.1]]}}, "worth.presence.*must not fall"),
        ({"worth": {"boxes": [[0.0, 3.0], [1.0, 1.0]]}}, "worth.boxes.*must not fall"),
        ({"costs": {"block": COST | {"calls": -1.0}}}, "costs.block.calls"),
    ],
)
def test_a_damaged_file_is_refused_with_the_place(tmp_path: Path, changes: dict, words: str):
    path = written(tmp_path, **changes)
    with pytest.raises(ConfigError, match=words):
        read_exam(path)


def test_a_missing_and_a_cut_file_are_refused(tmp_path: Path):
    with pytest.raises(ConfigError, match="hypernav exam writes it"):
        read_exam(tmp_path / "exam.json")
    path = written(tmp_path)
    path.write_bytes(path.read_bytes()[:-20])
    with pytest.raises(ConfigError, match="or damaged"):
        read_exam(path)


@pytest.mark.parametrize(
    "own", ["presence.calibration=[[0.5, 0.9]]", "local.score_weights=[[0.5, 2.0]]"]
)
def test_two_answers_to_what_an_answer_is_worth_are_refused(tmp_path: Path, own: str):
    config = layered(preset("default"), assignments=(own,))
    with pytest.raises(ConfigError, match="leave one of the two out"):
        read_exam(written(tmp_path)).applied(config, unchecked=False)


def test_auto_takes_the_reasoner_that_was_examined(tmp_path: Path):
    exam = read_exam(written(tmp_path))
    who = exam.who | {"block": "random"}
    other = exam.model_copy(update={"who": who})
    chosen, _ = without_auto(ComponentSpecs(reasoner="auto"), other, "paper")
    assert chosen.reasoner == "random"
