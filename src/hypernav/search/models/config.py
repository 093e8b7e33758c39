"""Configuration of the neural networks but for chat models."""

from typing import Literal

from pydantic import Field

from hypernav.core.config import MOST_THREADS, RoomConfig
from hypernav.search.models.closed_set import COCO_CLASSES


class OnnxDetectorConfig(RoomConfig):
    """How an exported detector is used.

    Attributes:
        score_threshold: Score below which detections are dropped; measured with YOLOX-nano alone.
        classes: Names in the order of the network's outputs.
    """

    score_threshold: float = Field(default=0.1, ge=0.0, le=1.0)
    classes: tuple[str, ...] = COCO_CLASSES


class ZeroShotConfig(RoomConfig):
    """How an open-vocabulary detector is used.

    Attributes:
        score_threshold: Score below which detections are dropped.
        device: "auto", "cpu", "cuda", "mps".
        dtype: "auto" is bfloat16 on NVIDIA GPUs with it.
    """

    score_threshold: float = Field(default=0.3, ge=0.0, le=1.0)
    device: str = "auto"
    dtype: Literal["auto", "bfloat16", "float16", "float32"] = "auto"


class SamConfig(RoomConfig):
    """How a SAM model is used.

    Attributes:
        device: "auto", "cpu", "cuda", "mps".
        dtype: "auto" is bfloat16 on NVIDIA GPUs with it.
    """

    device: str = "auto"
    dtype: Literal["auto", "bfloat16", "float16", "float32"] = "auto"


class OnnxSamConfig(RoomConfig):
    """How an exported SAM is used.

    Attributes:
        side_px: Longest side of the images that the encoder was trained on.
        threads: Threads of onnxruntime.
    """

    side_px: int = Field(default=1024, ge=64, le=4096)
    threads: int = Field(default=2, ge=1, le=MOST_THREADS)


class SimilarityConfig(RoomConfig):
    """How the model is used.

    Attributes:
        device: "auto", "cpu", "cuda", "mps".
        dtype: "auto" is bfloat16 on NVIDIA GPUs with it.
        head: Head of BLIP-2: "itm", matching, whose probability saturates at 0 or 1, or "itc",
            contrast, whose cosine is graded, and which alone has vectors; other models have only
            one.
    """

    device: str = "auto"
    dtype: Literal["auto", "bfloat16", "float16", "float32"] = "auto"
    head: Literal["itm", "itc"] = "itm"


class SimilarityScorerConfig(RoomConfig):
    """The sentence that images are compared with, and the model's use.

    Attributes:
        prompt: Sentence; ``{goal}`` is filled in. In substance VLFM's, in our words.
        similarity: Device, dtype and head of the model. VLFM takes the cosine of BLIP-2's
            contrastive head.
    """

    prompt: str = "It looks as if a {goal} is close by."
    similarity: SimilarityConfig = Field(default=SimilarityConfig(head="itc"))
