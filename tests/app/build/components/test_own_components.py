"""Detectors, explorers and agents of somebody else's package, on the command line."""

import json
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from box_scenes import room_glb
from hypernav.app.build.agents import build_agent
from hypernav.app.build.components.choosing import choose_components, with_own_sections
from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.presets import preset
from hypernav.app.cli.main import main
from hypernav.core.errors import (
    ComponentError,
    ConfigError,
    ContractError,
    GoalError,
    HyPerNavError,
    MissingExtraError,
    ModelError,
)
from hypernav.core.goal import Goal
from hypernav.io.layered_config import layered

SMALL = ("--set", "embodiment.camera.width=160", "embodiment.camera.height=120")
MODULE = '''
import numpy as np

from hypernav.core.config import RoomConfig
from hypernav.core.errors import GoalError
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.embodiment import Action


class OwnConfig(RoomConfig):
    score: float = 0.9


class Sees:
    """Needs nothing, and sees a bed wherever the truth says so."""

    def detect(self, observation, goal):
        ids = observation.truth.ids
        wanted = [i for i, label in observation.truth.labels.items() if label.category == "bed"]
        masks = [ids == i for i in wanted if (ids == i).sum() > 50]
        return [Detection(Box(0.0, 0.0, 9.0, 9.0), 0.9, "bed", mask) for mask in masks]


class Configured(Sees):
    looks_at_colours = False

    def __init__(self, path="", *, config: OwnConfig, log):
        self.path, self.config, self.log = path, config, log

    def check_goal(self, goal):
        if goal.text == "moon":
            raise GoalError("no moon")

    def take_report(self):
        return {"looked": 7}


class Explorer:
    """Drives nowhere."""

    def next_destination(self, view): ...


class Whole:
    def __init__(self, detector):
        self.detector = detector

    def reset(self, goal): ...
    def act(self, observation):
        return Action.STOP


class Cutting(Whole):
    def __init__(self, detector, segmenter):
        self.detector, self.segmenter = detector, segmenter


def make_whole(detector):
    return Whole(detector)


class Closing(Sees):
    def __init__(self, path):
        self.path = path

    def close(self):
        open(self.path, "w").close()


class Compares:
    def __init__(self, path="", *, config: OwnConfig):
        self.path, self.config = path, config

    def image_vectors(self, image):
        return np.ones((1, 2))

    def text_vectors(self, texts):
        return np.ones((len(texts), 2))


class ComparesNothing(Compares):
    def text_vectors(self, texts):
        return np.zeros((len(texts), 2))


class Blind:
    pass


class Demanding:
    def __init__(self, weather): ...


class Vague(Sees):
    def __init__(self, config): ...


NUMBER = 3
'''


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Where the user stands, with a file of their own in it."""
    (tmp_path / "own_parts.py").write_text(MODULE)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [entry for entry in sys.path if entry])
    yield tmp_path
    sys.modules.pop("own_parts", None)


def hypernav(*arguments: object) -> int:
    """Run the command; its exit status."""
    with pytest.raises(SystemExit) as stop:
        main([str(argument) for argument in arguments])
    return int(stop.value.code or 0)


def built(specs: ComponentSpecs, *assignments: str):
    config = layered(preset("default"), assignments=assignments)
    return build_agent(with_own_sections(config, choose_components(specs)), specs)


def test_a_detector_of_ones_own_finds_the_bed(folder: Path):
    glb = room_glb(folder / "room.glb")
    own = ("--detector", "own_parts:Sees", *SMALL)
    assert hypernav("find", "bed", "--scene", glb, "--out", "one", "--quiet", *own) == 0
    result = json.loads((folder / "one" / "result.json").read_text())
    assert result["detector"] == "Sees of own_parts"
    assert result["parts"]["detector"] == "own_parts:Sees"


@pytest.mark.slow
def test_a_detector_of_ones_own_is_evaluated_in_processes_of_its_own(folder: Path):
    glb = room_glb(folder / "room.glb")
    dataset, quick = f"scene:{glb}#1", ("--workers", "1", "--max-steps", "40", "--quiet")
    own = ("--detector", "own_parts:Configured:net", "--set", "own.detector.score=0.5")
    assert hypernav("eval", dataset, "--goals", "bed", "--out", "run", *quick, *own) == 0
    run = json.loads((folder / "run" / "run.json").read_text())["configuration"]
    assert run["who"]["detector"] == "Configured of own_parts net"
    assert run["config"]["own"]["detector"] == {"score": 0.5}
    (line,) = (folder / "run" / "episodes.jsonl").read_text().splitlines()
    assert json.loads(line)["success"]


def test_an_installed_package_brings_a_detector(folder: Path, monkeypatch: pytest.MonkeyPatch):
    info = folder / "own_parts-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: own-parts\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[hypernav.detectors]\nmine = own_parts:Sees\n")
    monkeypatch.syspath_prepend(folder)
    parts = built(ComponentSpecs(detector="mine"))
    assert parts.detector_words == "mine"
    assert type(parts.components[0]).__name__ == "Sees"


@pytest.mark.slow
def test_a_component_is_closed_when_an_evaluation_ends(folder: Path):
    glb = room_glb(folder / "room.glb")
    quick = ("--goals", "bed", "--workers", "1", "--max-steps", "3", "--quiet")
    own = ("--detector", "own_parts:Closing:closed.txt", *SMALL)
    assert hypernav("eval", f"scene:{glb}#1", "--out", "run", *quick, *own) == 0
    assert (folder / "closed.txt").is_file()


def test_a_whole_agent_gets_the_segmenter_that_it_asks_for(folder: Path):
    agent: Any = built(ComponentSpecs(agent="own_parts:Cutting")).agent
    assert hasattr(agent.segmenter, "segment")


def test_a_function_is_taken_for_an_explorer_and_its_agent_refused(folder: Path):
    with pytest.raises(ContractError, match="is no Explorer"):
        built(ComponentSpecs(agent="own_parts:make_whole"))


def test_a_constructor_gets_what_it_asks_for(folder: Path):
    specs = ComponentSpecs(detector="own_parts:Configured:weights.onnx")
    parts = built(specs, "own.detector.score=0.25")
    detector: Any = parts.components[0]
    assert (detector.path, detector.config.score) == ("weights.onnx", 0.25)


def test_optional_abilities_are_asked_for(folder: Path):
    parts = built(ComponentSpecs(detector="own_parts:Configured"))
    with pytest.raises(GoalError, match="no moon"):
        parts.check_goal(Goal("moon"))
    assert parts.take_report() == {"fallbacks": {"looked": 7}}
    assert not built(ComponentSpecs()).looks_at_colours
    assert built(ComponentSpecs(detector="own_parts:Sees")).looks_at_colours


def test_a_model_of_ones_own_compares_key_images(folder: Path):
    parts = built(ComponentSpecs(similarity="own_parts:Compares:weights.onnx"))
    agent: Any = parts.agent
    ranking = agent.components.image_ranking
    assert (ranking.name, ranking.least) == ("Compares of own_parts weights.onnx", 3.0)
    assert (ranking.model.path, ranking.model.config.score) == ("weights.onnx", 0.9)
    assert parts.looks_at_colours  # key images of a world without colours could not be compared
    assert parts.chosen.as_dict()["similarity"] == "own_parts:Compares:weights.onnx"


def test_without_one_nothing_is_compared(folder: Path):
    parts = built(ComponentSpecs())
    agent: Any = parts.agent
    assert agent.components.image_ranking is None
    assert "similarity" not in parts.chosen.as_dict()


def test_an_explorer_of_ones_own_is_driven_for(folder: Path):
    parts = built(ComponentSpecs(agent="own_parts:Explorer"))
    assert parts.reasoner_words == "Explorer of own_parts"
    assert type(parts.agent).__name__ == "SearchAgent"


def test_an_agent_of_ones_own_asks_for_a_detector(folder: Path):
    parts = built(ComponentSpecs(agent="own_parts:Whole", detector="own_parts:Sees"))
    assert type(parts.agent).__name__ == "Whole"
    agent: Any = parts.agent
    assert type(agent.detector).__name__ == "Sees"


@pytest.mark.parametrize(
    ("specs", "assignments", "error", "words"),
    [
        ({"detector": "own_parts:Blind"}, (), ContractError, "is no Detector: it has no detect"),
        ({"detector": "own_parts:Demanding"}, (), ContractError, "constructor asks for 'weather'"),
        ({"detector": "own_parts:Vague"}, (), ContractError, "annotate it with a class of yours"),
        ({"detector": "own_parts:NUMBER"}, (), ContractError, "expected a class or a function"),
        ({"detector": "own_parts:Sees:x"}, (), ConfigError, "nothing can follow its name"),
        ({"agent": "own_parts:Blind"}, (), ContractError, "is no Explorer: it has no"),
        (
            {"detector": "own_parts:Configured"},
            ("own.detector.scor=1",),
            ConfigError,
            "own.detector: unknown key 'scor'; did you mean 'score'?",
        ),
        (
            {"detector": "own_parts:Configured"},
            ("own.detector.score=high",),
            ConfigError,
            "own.detector.score: Input should be a valid number",
        ),
        ({"similarity": "own_parts:Blind"}, (), ContractError, "no image_vectors and no text"),
        (
            {"similarity": "own_parts:ComparesNothing"},
            (),
            ComponentError,
            "text_vectors returned no direction in",
        ),
        (
            {"similarity": "local:no/such-model"},
            (),
            (MissingExtraError, ModelError),
            "no/such-model" if find_spec("torch") else "local-vlm",
        ),
        (
            {"agent": "own_parts:Whole", "similarity": "own_parts:Compares"},
            (),
            ConfigError,
            "--agent own_parts:Whole asks no similarity",
        ),
        (
            {"similarity": "own_parts:Compares"},
            ("search.recall=false",),
            ConfigError,
            "--similarity own_parts:Compares would never be asked",
        ),
        ({}, ("own.detector.score=1",), ConfigError, "own.detector is not for ground-truth"),
        ({}, ("own.segmenter.score=1",), ConfigError, "own.segmenter: no segmenter is asked"),
        (
            {"agent": "own_parts:Explorer", "reasoner": "geometric"},
            (),
            ConfigError,
            "--agent own_parts:Explorer asks no reasoner",
        ),
    ],
)
def test_what_does_not_fit_names_the_remedy(
    folder: Path,
    specs: dict[str, Any],
    assignments: tuple[str, ...],
    error: type[HyPerNavError] | tuple[type[HyPerNavError], ...],
    words: str,
):
    with pytest.raises(error) as caught:
        built(ComponentSpecs(**specs), *assignments)
    assert words in str(caught.value)
