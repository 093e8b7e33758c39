"""Time the questions of the method to a vision-language model in this process, and its memory.

The model is Qwen2.5-VL in its real size with random weights. It is written to a temporary folder
and opened as ``--vlm local:FOLDER`` opens it, so nothing is downloaded and the whole path of a
question is timed: image processor, chat template, network, reading of the answer. A token takes the
same time with random weights as with trained ones. What they say is nonsense that never ends, so
free answers have a fixed length: that of a real model's usual ones, about. Texts have a token a
word and a digit, as with Qwen's own tokenizer.

    python benchmarks/vlm_latency.py              # 7B in bfloat16: a GPU of 24 GB, 17 GB of disk
    python benchmarks/vlm_latency.py --size tiny --device cpu

Needs the extra: pip install 'hypernav[local-vlm]'.
"""

import statistics
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any, Literal

import numpy as np
import tyro

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "local_vlm"))

from cpu_torchvision import prepare
from qwen25_vl import save_qwen25_vl

from hypernav.core.chat import Answer, Question
from hypernav.core.components.registry import require
from hypernav.core.errors import HyPerNavError
from hypernav.core.exploring.overview import Block
from hypernav.core.goal import Goal
from hypernav.lab.evaluation.checks.vlm_checkup import drawn_house
from hypernav.search.models.chat.config import ChatConfig
from hypernav.search.models.chat.local_chat import LocalChat
from hypernav.search.models.chat.vlm_families import family_named
from hypernav.search.models.network_loading import EXTRA, choose_device, choose_dtype
from hypernav.search.perception.config import (
    OverviewConfig,
    PresenceConfig,
    VlmDetectorConfig,
    VlmReasonerConfig,
)
from hypernav.search.perception.explorers.map_question import map_question
from hypernav.search.perception.local.vlm_detector import grounding_question
from hypernav.search.perception.local.yes_no_checks import crop_question, presence_question

TEXT = {
    "7b": {
        "vocab_size": 152064,
        "hidden_size": 3584,
        "intermediate_size": 18944,
        "num_hidden_layers": 28,
        "num_attention_heads": 28,
        "num_key_value_heads": 4,
        "mrope": [16, 24, 24],
    },
    "3b": {
        "vocab_size": 151936,
        "hidden_size": 2048,
        "intermediate_size": 11008,
        "num_hidden_layers": 36,
        "num_attention_heads": 16,
        "num_key_value_heads": 2,
        "tie_word_embeddings": True,
        "mrope": [16, 24, 24],
    },
    "tiny": {
        "vocab_size": 4096,
        "hidden_size": 32,
        "intermediate_size": 64,
        "num_hidden_layers": 2,
        "num_attention_heads": 4,
        "num_key_value_heads": 2,
        "mrope": [1, 1, 2],
    },
}
LARGE_VISION = {
    "depth": 32,
    "hidden_size": 1280,
    "intermediate_size": 3420,
    "num_heads": 16,
    "fullatt_block_indexes": [7, 15, 23, 31],
}
TINY_VISION = {
    "depth": 2,
    "hidden_size": 32,
    "intermediate_size": 64,
    "num_heads": 4,
    "fullatt_block_indexes": [1],
}
Size = Literal["7b", "3b", "tiny"]
GIB = 2**30


@dataclass(frozen=True)
class Task:
    """A question, and what it is about."""

    name: str
    question: Question


def tasks() -> list[Task]:
    """One of each kind of question, with free answers as long as usual."""
    goal, noise = Goal("potted plant"), np.random.default_rng(0)
    view, crop = (
        noise.integers(0, 256, (height, width, 3), np.uint8)
        for height, width in ((480, 640), (240, 200))
    )
    boxes = grounding_question(VlmDetectorConfig(), family_named("qwen2.5-vl"), view, goal)
    blocks = tuple(
        Block(number, number, 0.0, 2.0, 1000, 40, (number + 1.0, 1.0), 3.0)
        for number in range(1, 13)
    )
    house = replace(drawn_house(OverviewConfig(), 1), blocks=blocks)
    reasoned, constrained = (
        map_question(VlmReasonerConfig(mode=mode), house, goal)
        for mode in ("reasoned", "constrained")
    )
    return [
        Task("boxes: none", replace(boxes, max_tokens=3)),
        Task("boxes: one", replace(boxes, max_tokens=45)),
        Task("crop", crop_question(crop, goal)),
        Task("presence", presence_question(PresenceConfig(), view, goal)),
        Task("block, reasoned", replace(reasoned, max_tokens=100)),
        Task("block, constrained", constrained),
    ]


def words_of(texts: Sequence[str]) -> Any:
    """A tokenizer that knows the words of these texts; a number is its digits."""
    tokenizers = require("tokenizers", extra=EXTRA)
    before = tokenizers.pre_tokenizers
    tokenizer = tokenizers.Tokenizer(tokenizers.models.BPE())
    tokenizer.pre_tokenizer = before.Sequence(
        [before.Digits(individual_digits=True), before.ByteLevel(add_prefix_space=False)]
    )
    tokenizer.decoder = tokenizers.decoders.ByteLevel()
    trainer = tokenizers.trainers.BpeTrainer(
        vocab_size=2048, initial_alphabet=before.ByteLevel.alphabet(), show_progress=False
    )
    tokenizer.train_from_iterator(texts, trainer)
    return tokenizer


def write_model(folder: Path, size: Size, texts: Sequence[str], config: ChatConfig) -> None:
    """Write a model of this size to a folder."""
    text: dict[str, Any] = dict(TEXT[size])
    rope = {"rope_type": "default", "rope_theta": 1e6, "mrope_section": text.pop("mrope")}
    device = choose_device(config.device)
    save_qwen25_vl(
        folder,
        words_of(texts),
        {**text, "max_position_embeddings": 32768, "rope_parameters": rope},
        TINY_VISION if size == "tiny" else LARGE_VISION,
        ends=False,
        device=device,
        dtype=choose_dtype(device, config.dtype),
    )


def measure(chat: LocalChat, question: Question, rounds: int) -> tuple[Answer, list[float]]:
    """The answer and its seconds, round by round; one more round warms up."""
    answers = [chat.ask(question) for _ in range(rounds + 1)][1:]
    return answers[0], sorted(answer.seconds for answer in answers)


def main(
    size: Annotated[Size, tyro.conf.arg(help="which Qwen2.5-VL")] = "7b",
    device: Annotated[str, tyro.conf.arg(help="auto, cpu, cuda")] = "auto",
    dtype: Annotated[
        Literal["auto", "bfloat16", "float16", "float32"], tyro.conf.arg(help="number format")
    ] = "auto",
    rounds: Annotated[int, tyro.conf.arg(help="measured rounds, one more warms up")] = 10,
) -> None:
    torch = require("torch", extra=EXTRA)
    prepare()
    config = ChatConfig(device=device, dtype=dtype)
    asked = tasks()
    with TemporaryDirectory() as folder:
        write_model(Path(folder), size, [task.question.text for task in asked], config)
        if torch.cuda.is_available():
            torch.cuda.empty_cache()  # of the model that was written
        begin = time.perf_counter()
        chat = LocalChat(folder, config)
        loaded = time.perf_counter() - begin
    cuda = chat.device.type == "cuda"
    hardware = torch.cuda.get_device_name(chat.device) if cuda else chat.device.type
    print(f"Qwen2.5-VL {size} of random weights on {hardware}, loaded in {loaded:.1f} s")
    if cuda:
        print(f"weights: {torch.cuda.memory_allocated() / GIB:.1f} GiB")
    print(f"{'question':20} {'in':>5} {'out':>4} {'median s':>9} {'from':>6} {'to':>6} {'GiB':>6}")
    for task in asked:
        if cuda:
            torch.cuda.reset_peak_memory_stats()
        answer, seconds = measure(chat, task.question, rounds)
        peak = torch.cuda.max_memory_allocated() / GIB if cuda else float("nan")
        print(
            f"{task.name:20} {answer.usage.tokens_in:5d} {answer.usage.tokens_out:4d} "
            f"{statistics.median(seconds):9.3f} {seconds[0]:6.3f} {seconds[-1]:6.3f} {peak:6.1f}"
        )
    if cuda:
        print(f"reserved in all: {torch.cuda.memory_reserved() / GIB:.1f} GiB")


if __name__ == "__main__":
    try:
        tyro.cli(main, description=__doc__)
    except HyPerNavError as error:
        sys.exit(f"error: {error}")
