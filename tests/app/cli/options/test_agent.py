import pickle
from pathlib import Path

import pytest
import tyro

from hypernav.app.build.components.choosing import choose_components
from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.cli.command_line import _with_one_set
from hypernav.app.cli.options.agent import AgentOptions
from hypernav.core.errors import ConfigError, HyPerNavError

VLM = "openai:http://localhost:8000/v1#Qwen/Qwen2.5-VL-7B-Instruct"


def read(*arguments: str) -> AgentOptions:
    return tyro.cli(AgentOptions, args=list(arguments))


def test_without_options_nothing_but_the_simulator_is_needed():
    parts = AgentOptions().build()
    assert (parts.detector_words, parts.reasoner_words) == ("ground truth", "geometric")
    assert parts.take_report() == {}


def test_a_model_sees_thinks_and_looks_once_more():
    parts = read("--vlm", VLM).build()
    chosen = parts.chosen.as_dict()
    assert (chosen["detector"], chosen["reasoner"], chosen["presence"]) == ("vlm", "vlm", "vlm")
    assert parts.detector_words == parts.reasoner_words == "Qwen/Qwen2.5-VL-7B-Instruct"
    assert parts.take_report()["ledger"]["total"]["calls"] == 0


def test_parts_may_be_set_apart():
    specs = ComponentSpecs(vlm=VLM, detector="yolox:net.onnx", segmenter="sam:facebook/sam")
    chosen = choose_components(specs).as_dict()
    assert (chosen["detector"], chosen["reasoner"]) == ("yolox:net.onnx", "vlm")
    assert (chosen["segmenter"], chosen["presence"]) == ("sam:facebook/sam", "vlm")


def test_the_presence_check_can_be_switched_off():
    options = read("--vlm", VLM, "--set", "presence.enabled=false")
    assert options.build().chosen.as_dict()["presence"] == "none"


def test_the_frontier_agent_thinks_for_itself():
    chosen = choose_components(ComponentSpecs(agent="frontier", vlm=VLM))
    assert chosen.as_dict() == {
        "agent": "frontier",
        "vlm": VLM,
        "detector": "vlm",
        "reasoner": "none",
        "segmenter": "depth-cut",
        "presence": "vlm",
    }


def test_the_paper_asks_in_its_own_way():
    assert read("--preset", "paper").resolve().block_choice.mode == "paper"
    assert read().resolve().block_choice.mode == "reasoned"


def test_options_travel_to_other_processes():
    options = read("--vlm", VLM, "--set", "chat.patience_s=5")
    assert pickle.loads(pickle.dumps(options)) == options
    assert options.resolve().chat.patience_s == 5.0


def test_the_description_repeats_the_agent():
    options = read("--vlm", VLM, "--detector", "ground-truth")
    told = options.describe(options.build())
    assert told["parts"]["vlm"] == VLM
    assert told["parts"]["detector"] == "ground-truth"
    assert (told["agent"], told["preset"]) == ("hypernav", "default")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--reasoner", "vlm"], "--reasoner vlm needs a chat model; name it"),
        (["--detector", "vlm"], "--detector vlm needs a chat model; name it"),
        (
            ["--reasoner", "magic"],
            "unknown reasoner 'magic'; use geometric, vlm, noisy:P, random or one of",
        ),
        (["--detector", "noisy:great"], "--detector noisy:great: expected one of perfect, good"),
        (["--reasoner", "noisy"], "reasoner 'noisy': expected noisy:P"),
        (["--reasoner", "noisy:2"], "--reasoner noisy:2: expected the probability"),
        (["--detector", "magic"], "unknown detector 'magic'; use ground-truth"),
        (["--detector", "yolox:"], "detector 'yolox:': expected yolox:PATH.onnx"),
        (["--segmenter", "scissors"], "unknown segmenter 'scissors'; use depth-cut"),
        (["--vlm", VLM, "--segmenter", "onnx-sam:a.onnx"], "expected onnx-sam:ENCODER.onnx,DEC"),
        (["--segmenter", "sam:x"], "would never be asked: ground-truth detections"),
        (["--agent", "frontier", "--reasoner", "geometric"], "--agent frontier asks no reasoner"),
        (["--vlm", "http://localhost/v1"], "write openai:http://localhost/v1"),
        (["--vlm", "replay:nowhere.jsonl"], "nowhere.jsonl"),
        (
            [
                *("--vlm", VLM, "--detector", "ground-truth", "--reasoner", "geometric"),
                *("--set", "presence.enabled=false"),
            ],
            "would never be asked",
        ),
    ],
)
def test_what_contradicts_itself_names_the_remedy(arguments: list[str], words: str):
    with pytest.raises(HyPerNavError) as caught:
        read(*arguments).build()
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "has nothing to record; name a model with --vlm"),
        (["--vlm", "replay:a.jsonl"], "would only copy the recording"),
    ],
)
def test_only_what_a_model_answers_is_recorded(arguments: list[str], words: str):
    with pytest.raises(HyPerNavError, match=words):
        read(*arguments).build(record=Path("r.jsonl"))


def test_a_missing_onnx_file_is_named(tmp_path: Path):
    with pytest.raises(HyPerNavError, match=r"gone\.onnx"):
        read("--detector", f"yolox:{tmp_path / 'gone.onnx'}").build()


def test_a_model_of_an_unknown_family_is_refused_before_the_search():
    with pytest.raises(ConfigError, match="in which coordinates 'wise-owl' answers"):
        read("--vlm", "openai:http://localhost:8000/v1#wise-owl").build()


@pytest.mark.parametrize(
    "words",
    [
        ["--set", "search.endurance_steps=7", "--set", "search.patience_steps=8"],
        ["--set=search.endurance_steps=7", "--set=search.patience_steps=8"],
        ["--set", "search.endurance_steps=7", "--set=search.patience_steps=8"],
    ],
)
def test_every_value_that_is_set_counts_however_it_is_written(words):
    merged = ["--set", "search.endurance_steps=7", "search.patience_steps=8"]
    assert _with_one_set(["find", "bed", *words]) == ["find", "bed", *merged]
