"""Time a vision-language model of a given size on the two questions of the method.

The model is Qwen2.5-VL with random weights, so nothing is downloaded: the benchmark measures
latency, not the quality of answers. The questions are those of the method in tokens: grounding
(640×480 image, sent as 644×476, 60 answer tokens) and block choice (768×768 image, 8 answer
tokens), alone and in batches. With 8 tokens a block choice stands for the constrained question.

    python benchmarks/vlm_latency.py                      # 7B in bfloat16; needs a GPU of 24 GB
    python benchmarks/vlm_latency.py --size tiny --device cpu

Needs the extra: pip install 'hypernav[local-vlm]'.
"""

import statistics
import sys
import time
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Any, Literal

import tyro

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "local_vlm"))

from cpu_torchvision import prepare

from hypernav.core.components.extras import require
from hypernav.core.errors import HyPerNavError
from hypernav.models.chat.vlm_families import family_named
from hypernav.models.torch_device import EXTRA, choose_device, choose_dtype

IMAGE_PAD, VISION_START, VISION_END = 151655, 151652, 151653
TEXT_TOKENS = 120
TEXT = {
    "7b": {
        "hidden_size": 3584,
        "intermediate_size": 18944,
        "num_hidden_layers": 28,
        "num_attention_heads": 28,
        "num_key_value_heads": 4,
        "mrope": [16, 24, 24],
    },
    "3b": {
        "hidden_size": 2048,
        "intermediate_size": 11008,
        "num_hidden_layers": 36,
        "num_attention_heads": 16,
        "num_key_value_heads": 2,
        "mrope": [16, 24, 24],
    },
    "tiny": {
        "hidden_size": 32,
        "intermediate_size": 64,
        "num_hidden_layers": 2,
        "num_attention_heads": 4,
        "num_key_value_heads": 2,
        "mrope": [1, 1, 2],
    },
}
VISION = {
    "7b": {"depth": 32, "hidden_size": 1280, "intermediate_size": 3420, "num_heads": 16},
    "3b": {"depth": 32, "hidden_size": 1280, "intermediate_size": 3420, "num_heads": 16},
    "tiny": {"depth": 2, "hidden_size": 32, "intermediate_size": 64, "num_heads": 4},
}
FULL_ATTENTION = {"7b": [7, 15, 23, 31], "3b": [7, 15, 23, 31], "tiny": [1]}
Size = Literal["7b", "3b", "tiny"]


@dataclass(frozen=True)
class Task:
    """One kind of question: its name, image and length of answer."""

    name: str
    width: int
    height: int
    answer_tokens: int


TASKS = (Task("grounding", 640, 480, 60), Task("block choice", 768, 768, 8))


def build(size: Size, device: Any, dtype: Any) -> Any:
    """The network with random weights, on the device."""
    torch = require("torch", extra=EXTRA)
    if device.type == "cpu" and find_spec("torchvision") is not None:
        prepare()
    hf = require("transformers", extra=EXTRA)
    text: dict[str, Any] = dict(TEXT[size])
    sections = text.pop("mrope")
    config = hf.Qwen2_5_VLConfig(
        text_config={
            **text,
            "vocab_size": 152064,
            "max_position_embeddings": 32768,
            "tie_word_embeddings": False,
            "rope_parameters": {
                "rope_type": "default",
                "mrope_section": sections,
                "rope_theta": 1e6,
            },
        },
        vision_config={
            **VISION[size],
            "out_hidden_size": text["hidden_size"],
            "fullatt_block_indexes": FULL_ATTENTION[size],
        },
        image_token_id=IMAGE_PAD,
        vision_start_token_id=VISION_START,
        vision_end_token_id=VISION_END,
    )
    torch.manual_seed(0)
    usual = torch.get_default_dtype()
    torch.set_default_dtype(dtype)
    try:
        with torch.device(device):
            model = hf.Qwen2_5_VLForConditionalGeneration(config)
    finally:
        torch.set_default_dtype(usual)
    return model.eval()


def inputs_for(task: Task, batch: int, device: Any, dtype: Any) -> dict[str, Any]:
    """The inputs that the model's processor would produce for a batch of such questions."""
    torch = require("torch", extra=EXTRA)
    width, height = family_named("qwen2.5-vl").sent_size(task.width, task.height)
    grid = (1, height // 14, width // 14)
    patches = grid[1] * grid[2]
    image = [VISION_START, *[IMAGE_PAD] * (patches // 4), VISION_END]
    prompt = [*range(1000, 1000 + TEXT_TOKENS // 2), *image]
    prompt += range(2000, 2000 + TEXT_TOKENS // 2)
    ids = torch.tensor([prompt] * batch, device=device)
    return {
        "input_ids": ids,
        "attention_mask": torch.ones_like(ids),
        "mm_token_type_ids": (ids == IMAGE_PAD).int(),
        "pixel_values": torch.randn(batch * patches, 3 * 2 * 14 * 14, device=device, dtype=dtype),
        "image_grid_thw": torch.tensor([grid] * batch, device=device),
    }


def measure(model: Any, task: Task, batch: int, rounds: int) -> float:
    """Median seconds of one batch, with answers of exactly the task's length."""
    torch = require("torch", extra=EXTRA)
    inputs = inputs_for(task, batch, model.device, model.dtype)
    length = {"min_new_tokens": task.answer_tokens, "max_new_tokens": task.answer_tokens}
    taken = []
    for round_number in range(rounds + 1):
        if model.device.type == "cuda":
            torch.cuda.synchronize()
        begin = time.perf_counter()
        with torch.inference_mode():
            model.generate(**inputs, **length, do_sample=False, pad_token_id=0)
        if model.device.type == "cuda":
            torch.cuda.synchronize()
        if round_number > 0:  # the first one warms up
            taken.append(time.perf_counter() - begin)
    return statistics.median(taken)


def main(
    size: Annotated[Size, tyro.conf.arg(help="which Qwen2.5-VL")] = "7b",
    device: Annotated[str, tyro.conf.arg(help="auto, cpu, cuda")] = "auto",
    batches: Annotated[tuple[int, ...], tyro.conf.arg(help="batch sizes")] = (1, 8, 32),
    rounds: Annotated[int, tyro.conf.arg(help="measured rounds, one more warms up")] = 5,
) -> None:
    torch = require("torch", extra=EXTRA)
    where = choose_device(device)
    dtype = choose_dtype(where)
    model = build(size, where, dtype)
    weights = sum(parameter.numel() for parameter in model.parameters())
    hardware = torch.cuda.get_device_name(where) if where.type == "cuda" else where.type
    print(f"Qwen2.5-VL {size}, {weights / 1e9:.2f} G weights, {dtype}, {hardware}")
    print(f"{'question':14} {'batch':>5} {'seconds':>9} {'per question':>13}")
    for task in TASKS:
        for batch in batches:
            seconds = measure(model, task, batch, rounds)
            print(f"{task.name:14} {batch:5d} {seconds:9.3f} {seconds / batch:13.3f}")


if __name__ == "__main__":
    try:
        tyro.cli(main, description=__doc__)
    except HyPerNavError as error:
        sys.exit(f"error: {error}")
