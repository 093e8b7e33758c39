from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from pydantic import BaseModel

from chat_models import image
from hypernav.core.chat import Fault, Question
from hypernav.core.errors import (
    ConfigError,
    MissingExtraError,
    ModelError,
    ModelUnavailableError,
)
from hypernav.search.models.chat.config import ChatConfig
from hypernav.search.models.chat.local_chat import LocalChat
from hypernav.search.models.chat.vlm_spec import open_chat

VIEW = image(0, 476, 644)
OPEN = Question("ground", "Locate every bed", (VIEW,), max_tokens=12)
WHICH = Question("choose block", "Which block?", (VIEW,), ("1", "3", "12"), max_tokens=8)


@pytest.fixture(scope="module")
def chat(tiny: Callable[[str], Path], device: str) -> LocalChat:
    return LocalChat(str(tiny("qwen25_vl")), ChatConfig(device=device))


def test_counts_the_tokens_of_text_and_image(chat: LocalChat):
    answer = chat.ask(OPEN)
    patches = 476 * 644 // 28**2
    assert patches < answer.usage.tokens_in < patches + 100
    assert answer.usage.tokens_out <= 12
    assert answer.seconds > 0.0
    without = chat.ask(Question("ground", OPEN.text, max_tokens=1))
    # The image and the two tokens around it.
    assert answer.usage.tokens_in - without.usage.tokens_in == patches + 2


def test_says_the_same_twice(chat: LocalChat):
    assert chat.ask(OPEN).text == chat.ask(OPEN).text


def test_sampling_is_repeatable_by_its_seed(tiny: Callable[[str], Path], device: str):
    path = str(tiny("qwen25_vl"))
    texts = [
        LocalChat(path, ChatConfig(device=device, temperature=2.0, seed=seed)).ask(OPEN).text
        for seed in (1, 1, 2)
    ]
    assert texts[0] == texts[1] != texts[2]


def test_a_closed_question_can_only_get_an_allowed_answer(chat: LocalChat):
    answer = chat.ask(WHICH)
    assert answer.value in WHICH.allowed
    assert set(answer.probabilities) == set(WHICH.allowed)
    assert sum(answer.probabilities.values()) == pytest.approx(1.0)
    assert answer.probabilities[answer.value] == max(answer.probabilities.values())


def test_probabilities_are_those_of_the_model(chat: LocalChat):
    """Against the definition, written out: P(1) and P(3) from the scores after the prompt."""
    import torch

    answer = chat.ask(Question("choose block", "Which block?", (VIEW,), ("1", "3")))
    with torch.inference_mode():
        inputs = chat._inputs(Question("choose block", "Which block?", (VIEW,)))
        scores = chat._model(**inputs).logits[0, -1].double()
    tokens = chat._processor.tokenizer.convert_tokens_to_ids(["1", "3"])
    expected = torch.softmax(scores[tokens], 0).tolist()
    assert [answer.probabilities["1"], answer.probabilities["3"]] == pytest.approx(
        expected, abs=1e-4
    )


def test_the_order_of_the_answers_does_not_matter(chat: LocalChat):
    turned = Question("choose block", WHICH.text, WHICH.images, WHICH.allowed[::-1])
    first, second = chat.ask(WHICH).probabilities, chat.ask(turned).probabilities
    assert {key: pytest.approx(value, abs=1e-5) for key, value in first.items()} == dict(second)


def test_nonsense_for_a_form_is_a_fault(chat: LocalChat):
    class Point(BaseModel):
        x: float

    answer = chat.ask(Question("point", "Where?", (VIEW,), form=Point, max_tokens=12))
    assert answer.fault in {Fault.UNPARSABLE, Fault.INVALID}


def test_two_images_are_two_images(chat: LocalChat):
    one = chat.ask(Question("ground", "Compare", (VIEW,), max_tokens=2)).usage.tokens_in
    two = chat.ask(Question("ground", "Compare", (VIEW, np.zeros_like(VIEW)), max_tokens=2))
    assert two.usage.tokens_in - one == 476 * 644 // 28**2 + 2


def test_opens_by_its_spec(tiny: Callable[[str], Path]):
    chat = open_chat(f"local:{tiny('qwen25_vl')}", ChatConfig(device="cpu"))
    assert chat.ask(WHICH).value in WHICH.allowed


def test_missing_weights_say_how_to_get_them():
    with pytest.raises(ModelError, match=r"hf download Qwen/Qwen2\.5-VL-3B"):
        LocalChat("Qwen/Qwen2.5-VL-3B-Instruct")


def test_a_folder_without_a_model(tmp_path: Path):
    with pytest.raises(ModelError):
        LocalChat(str(tmp_path))


def test_a_model_of_another_kind(tiny: Callable[[str], Path]):
    with pytest.raises(ModelError):
        LocalChat(str(tiny("clip")))


@pytest.mark.parametrize("absent", ["toaster", "cuda:99"])
def test_a_device_that_is_not_there(absent: str):
    with pytest.raises(ConfigError, match=absent):
        LocalChat("anything", ChatConfig(device=absent))


def test_without_a_gpu_the_gpu_is_not_there(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("torch.cuda.is_available", lambda: False)
    with pytest.raises(ConfigError, match="no GPU"):
        LocalChat("anything", ChatConfig(device="cuda"))


def test_weights_without_room_say_how_large_they_are(
    tiny: Callable[[str], Path], monkeypatch: pytest.MonkeyPatch
):
    import torch

    def full(*_: object) -> None:
        raise torch.OutOfMemoryError

    monkeypatch.setattr("torch.nn.Module.to", full)
    with pytest.raises(ModelError, match=r"take 0\.0 GiB, and cpu has no room"):
        LocalChat(str(tiny("qwen25_vl")), ChatConfig(device="cpu"))


def test_a_question_without_room_is_an_outage_and_the_next_one_is_answered(
    chat: LocalChat, monkeypatch: pytest.MonkeyPatch
):
    import torch

    def full(*_: object, **__: object) -> None:
        raise torch.OutOfMemoryError

    with monkeypatch.context() as patch:
        patch.setattr(chat._model, "generate", full)
        with pytest.raises(ModelUnavailableError, match="ran out of memory"):
            chat.ask(OPEN)
    assert chat.ask(OPEN).text


def test_questions_leave_nothing_in_the_memory_of_a_gpu(chat: LocalChat):
    import torch

    if chat.device.type != "cuda":
        pytest.skip("only a GPU's memory is counted")
    chat.ask(OPEN), chat.ask(WHICH)
    before = torch.cuda.memory_allocated()
    chat.ask(OPEN), chat.ask(WHICH)
    assert torch.cuda.memory_allocated() == before


def test_a_package_that_a_model_needs_is_named(
    tiny: Callable[[str], Path], monkeypatch: pytest.MonkeyPatch
):
    def lacking(*_: object, **__: object) -> None:
        raise ImportError("\nQwen2VLVideoProcessor requires the Torchvision library\n")

    monkeypatch.setattr("transformers.AutoProcessor.from_pretrained", lacking)
    with pytest.raises(MissingExtraError, match=r"requires the Torchvision library .*local-vlm"):
        LocalChat(str(tiny("qwen25_vl")), ChatConfig(device="cpu"))
