"""The options of `hypernav exam`."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal

import tyro

from hypernav.build.component_specs import PresetName


@dataclass(frozen=True)
class Options:
    """Who is examined, with which questions, and where the results go."""

    vlm: str | None = None
    """Model to examine: openai:URL[#MODEL], local:PATH_OR_ID or replay:FILE."""
    detector: str | None = None
    """Detector to examine in the model's place, or alone: yolox:PATH.onnx, zero-shot:ID, …"""
    segmenter: str | None = None
    """Segmenter to examine: depth-cut, sam:ID or onnx-sam:ENC.onnx,DEC.onnx."""
    reasoner: str | None = None
    """What chooses blocks, in the model's place, or alone: geometric, noisy:P, …"""
    size: Literal["quick", "full"] = "quick"
    """quick: 203 questions; full: 1,015."""
    bank: Literal["val", "train"] = "val"
    """val, which nothing is tuned on; train for work on prompts."""
    preset: PresetName = "default"
    """Values of the method, which hold the words of its questions."""
    config: Path | None = None
    """YAML file with sections like those of result.json's config; only values that differ."""
    predict: int = 40
    """Number of episodes in which stand-ins that err like the model search, to predict what it
    reaches: minutes, without the model. 0 predicts nothing."""
    compare: tuple[Path, Path] | None = None
    """Two such files: the model answers the same questions with both, and they are compared."""
    set: Annotated[tuple[str, ...], tyro.conf.arg(metavar="SECTION.KEY=VALUE")] = field(
        default_factory=tuple
    )
    """Single values that override the configuration, for example price.in_per_million=0.2."""
    at_once: int | None = None
    """Number of questions at a time; by default 4 to a server, else 1."""
    out: Path | None = None
    """Folder of the results; runs/exam-<model> by default. One that was begun is continued."""
