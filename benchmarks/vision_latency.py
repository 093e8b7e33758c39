"""Time detectors and segmenters through transformers, and their memory on a GPU.

The networks have their real sizes and random weights, so nothing is downloaded. They are written to
a temporary folder and opened as ``--detector zero-shot:FOLDER`` and ``--segmenter sam:FOLDER`` open
them: the way from the camera's image to boxes or to a mask is timed.

    python benchmarks/vision_latency.py
    python benchmarks/vision_latency.py --dtypes bfloat16 --device cuda:1

Needs the extra: pip install 'hypernav[local-vlm]'.
"""

import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any, Literal

import numpy as np
import tyro

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "local_vlm"))

import tiny_models
from cpu_torchvision import prepare

from hypernav.core.components.registry import require
from hypernav.core.errors import HyPerNavError
from hypernav.core.geometry.boxes import Box
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.search.models.config import SamConfig, ZeroShotConfig
from hypernav.search.models.network_loading import EXTRA
from hypernav.search.models.sam import SamSegmenter
from hypernav.search.models.zero_shot import ZeroShotDetector

Dtype = Literal["bfloat16", "float16", "float32"]
VIT_HUGE = {
    "hidden_size": 1280,
    "num_hidden_layers": 32,
    "num_attention_heads": 16,
    "mlp_dim": 5120,
    "global_attn_indexes": [7, 15, 23, 31],
}
GIB = 2**30


def _tokenizer_of(tiny: Callable[[Path], Path]) -> Any:
    hf = require("transformers", extra=EXTRA)
    with TemporaryDirectory() as folder:
        return hf.AutoTokenizer.from_pretrained(tiny(Path(folder)))


def networks() -> dict[str, Callable[[], tuple[Any, Any]]]:
    """Model and processor of each network, built when they are wanted."""
    hf = require("transformers", extra=EXTRA)
    images = hf.SamImageProcessor()
    text = {"vocab_size": 300, "max_position_embeddings": 64}  # what the tiny tokenizer needs
    owlv2 = hf.Owlv2Config(text_config=text, vision_config={"image_size": 960})
    return {
        "sam: SAM, ViT-B": lambda: (
            hf.SamModel(hf.SamConfig()),
            hf.SamProcessor(image_processor=images),
        ),
        "sam: SAM, ViT-H": lambda: (
            hf.SamModel(hf.SamConfig(vision_config=VIT_HUGE)),
            hf.SamProcessor(image_processor=images),
        ),
        "sam: SAM 2, tiny": lambda: (
            hf.Sam2Model(hf.Sam2Config()),
            hf.Sam2Processor(image_processor=hf.Sam2ImageProcessor()),
        ),
        "zero-shot: Grounding DINO, tiny": lambda: (
            hf.GroundingDinoForObjectDetection(hf.GroundingDinoConfig()),
            hf.GroundingDinoProcessor(
                image_processor=hf.GroundingDinoImageProcessor(),
                tokenizer=_tokenizer_of(tiny_models.grounding_dino),
            ),
        ),
        "zero-shot: OWLv2, base": lambda: (
            hf.Owlv2ForObjectDetection(owlv2),
            hf.Owlv2Processor(
                image_processor=hf.Owlv2ImageProcessor(),
                tokenizer=_tokenizer_of(tiny_models.owlv2),
            ),
        ),
    }


def camera_view() -> Observation:
    """Noise, as large as the camera's image."""
    rgb = np.random.default_rng(0).integers(0, 256, (480, 640, 3), np.uint8)
    camera = PinholeCamera.from_hfov(640, 480, 79.0)
    depth = np.ones((480, 640), np.float32)
    return Observation(rgb, depth, camera, Transform.identity(), Pose2(0.0, 0.0, 0.0))


def opened(name: str, path: str, device: str, dtype: Dtype) -> Callable[[Observation], object]:
    """The network, as a function of what the robot sees."""
    if name.startswith("sam"):
        segmenter = SamSegmenter(path, SamConfig(device=device, dtype=dtype))
        return lambda view: segmenter.segment(view, Box(100.0, 100.0, 300.0, 400.0))
    detector = ZeroShotDetector(path, ZeroShotConfig(device=device, dtype=dtype))
    return lambda view: detector.detect(view, Goal("red sofa"))


def median_ms(look: Callable[[Observation], object], view: Observation, rounds: int) -> float:
    """Median milliseconds of one look; two more warm up."""
    taken = []
    for _ in range(rounds + 2):
        begin = time.perf_counter()
        look(view)
        taken.append(1e3 * (time.perf_counter() - begin))
    return statistics.median(taken[2:])


def main(
    device: Annotated[str, tyro.conf.arg(help="auto, cpu, cuda")] = "auto",
    dtypes: Annotated[tuple[Dtype, ...], tyro.conf.arg(help="number formats")] = (
        "bfloat16",
        "float32",
    ),
    rounds: Annotated[int, tyro.conf.arg(help="measured rounds, two more warm up")] = 15,
) -> None:
    torch = require("torch", extra=EXTRA)
    prepare()
    torch.manual_seed(0)
    view = camera_view()
    cuda = torch.cuda.is_available() and device != "cpu"
    print(torch.cuda.get_device_name() if cuda else device)
    print(f"{'network':34} {'weights':>8} {'format':>9} {'median ms':>10} {'GiB':>5}")
    for name, build in networks().items():
        with TemporaryDirectory() as folder:
            model, processor = build()
            weights = sum(parameter.numel() for parameter in model.parameters()) / 1e6
            model.save_pretrained(folder)
            processor.save_pretrained(folder)
            for dtype in dtypes:
                if cuda:
                    torch.cuda.reset_peak_memory_stats()
                look = opened(name, folder, device, dtype)
                taken = median_ms(look, view, rounds)
                peak = torch.cuda.max_memory_allocated() / GIB if cuda else float("nan")
                print(f"{name:34} {weights:6.0f} M {dtype:>9} {taken:10.1f} {peak:5.1f}")
                del look


if __name__ == "__main__":
    try:
        tyro.cli(main, description=__doc__)
    except HyPerNavError as error:
        sys.exit(f"error: {error}")
