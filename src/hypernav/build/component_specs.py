"""Who sees and who thinks, as people write it, and which of these go together."""

from dataclasses import dataclass
from typing import Literal

from hypernav.core.errors import ConfigError

AgentName = Literal["hypernav", "frontier"]
PresetName = Literal["default", "paper"]

_EXAMPLE = "--vlm openai:http://localhost:8000/v1"
DETECTORS = "ground-truth, yolox:PATH.onnx, vlm or zero-shot:ID"
REASONERS = "geometric or vlm"
SEGMENTERS = "depth-cut, sam:ID or onnx-sam:ENCODER.onnx,DECODER.onnx"


@dataclass(frozen=True)
class ComponentSpecs:
    """Who sees and thinks. What is None is filled in to fit the rest.

    Attributes:
        agent: How it explores.
        vlm: The chat model: ``openai:URL[#MODEL]``, ``local:ID`` or ``replay:FILE``.
        detector: Who sees the goal: ``ground-truth``, ``yolox:PATH``, ``vlm``, ``zero-shot:ID``.
        reasoner: Who chooses the block to visit: ``geometric`` or ``vlm``.
        segmenter: Who finds the pixels in a box: ``depth-cut``, ``sam:ID``, ``onnx-sam:ENC,DEC``.
    """

    agent: AgentName = "hypernav"
    vlm: str | None = None
    detector: str | None = None
    reasoner: str | None = None
    segmenter: str | None = None


@dataclass(frozen=True)
class ChosenComponents:
    """The same with nothing left open.

    Attributes:
        agent: How it explores.
        vlm: The chat model; None if none is asked anything.
        detector: Who sees the goal.
        reasoner: Who chooses where to look; ``nearest-frontier`` for the agent of that kind.
        segmenter: Who finds the pixels in a box; ``none`` where detections carry their masks.
        presence: Who looks once more at the goal: ``vlm`` or ``none``.
    """

    agent: AgentName
    vlm: str | None
    detector: str
    reasoner: str
    segmenter: str
    presence: Literal["vlm", "none"]


def choose_components(specs: ComponentSpecs, *, presence: bool = True) -> ChosenComponents:
    """Fill in what was left open and refuse what contradicts itself.

    With a chat model it detects, chooses blocks and checks the presence of the goal, unless
    another part was named for one of these.

    Args:
        specs: What was asked for.
        presence: Whether a chat model, if there is one, looks once more at the goal.

    Raises:
        ConfigError: It does not go together; the message says what does.
    """
    model = specs.vlm is not None
    detector = specs.detector or ("vlm" if model else "ground-truth")
    reasoner = _reasoner(specs)
    segmenter = specs.segmenter or ("none" if detector == "ground-truth" else "depth-cut")
    _check_known(detector, reasoner, segmenter)
    for option, value in (("--detector", detector), ("--reasoner", reasoner)):
        if value == "vlm" and not model:
            raise ConfigError(f"{option} vlm needs a chat model; name it, for example {_EXAMPLE}")
    if detector == "ground-truth" and segmenter not in {"none", "depth-cut"}:
        raise ConfigError(
            f"--segmenter {segmenter} would never be asked: ground-truth detections carry their "
            "own masks; choose another --detector or drop --segmenter"
        )
    if model and not presence and "vlm" not in {detector, reasoner}:
        raise ConfigError(
            f"--vlm {specs.vlm} would never be asked: --detector {detector}, --reasoner "
            f"{reasoner}, presence.enabled=false; give it something to do or drop --vlm"
        )
    return ChosenComponents(
        agent=specs.agent,
        vlm=specs.vlm,
        detector=detector,
        reasoner=reasoner,
        segmenter="none" if detector == "ground-truth" else segmenter,
        presence="vlm" if model and presence else "none",
    )


def _reasoner(specs: ComponentSpecs) -> str:
    if specs.agent != "frontier":
        return specs.reasoner or ("vlm" if specs.vlm is not None else "geometric")
    if specs.reasoner is not None:
        raise ConfigError(
            f"--agent frontier asks no reasoner, so --reasoner {specs.reasoner} has no meaning; "
            "drop it or use --agent hypernav"
        )
    return "nearest-frontier"


def _check_known(detector: str, reasoner: str, segmenter: str) -> None:
    kind, _, place = detector.partition(":")
    named = kind in {"yolox", "zero-shot"} and place
    if not named and detector not in {"ground-truth", "vlm"}:
        raise ConfigError(f"unknown detector '{detector}'; use {DETECTORS}")
    if reasoner not in {"geometric", "vlm", "nearest-frontier"}:
        raise ConfigError(f"unknown reasoner '{reasoner}'; use {REASONERS}")
    kind, _, place = segmenter.partition(":")
    encoder, _, decoder = place.partition(",")
    if kind == "onnx-sam" and not (encoder and decoder):
        raise ConfigError(f"--segmenter {segmenter}: expected onnx-sam:ENCODER.onnx,DECODER.onnx")
    if segmenter not in {"none", "depth-cut"} and not (kind in {"sam", "onnx-sam"} and place):
        raise ConfigError(f"unknown segmenter '{segmenter}'; use {SEGMENTERS}")
