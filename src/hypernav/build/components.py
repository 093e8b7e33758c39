"""Who sees and thinks, from specifications to objects."""

from collections.abc import Callable
from pathlib import Path

from hypernav.build.component_specs import ChosenComponents
from hypernav.build.presets import HyPerNavConfig
from hypernav.core.errors import ConfigError
from hypernav.core.protocols import BlockReasoner, ChatModel, Detector, Segmenter
from hypernav.core.trace import ExchangeLog
from hypernav.models.chat.ledger import Ledger, LedgerChat
from hypernav.models.chat.recording import RecordingChat
from hypernav.models.chat.vlm_spec import VlmSpec, open_chat, parse_vlm_spec
from hypernav.models.vision.sam import SamSegmenter
from hypernav.models.vision.sam_onnx import OnnxSamSegmenter
from hypernav.models.vision.yolox import YoloxDetector
from hypernav.models.vision.zero_shot import ZeroShotDetector
from hypernav.perception.explorers.geometric_reasoner import GeometricReasoner
from hypernav.perception.explorers.vlm_reasoner import VlmReasoner
from hypernav.perception.local.depth_cut import DepthCutSegmenter
from hypernav.perception.local.ground_truth import GroundTruthDetector
from hypernav.perception.local.vlm_detector import VlmDetector

_WORDS = {
    "ground-truth": "ground truth",
    "geometric": "geometric",
    "nearest-frontier": "nearest frontier",
    "depth-cut": "depth cut",
    "none": "none",
}


def wrap_chat(
    chosen: ChosenComponents, config: HyPerNavConfig, ledger: Ledger, record: Path | None
) -> tuple[ChatModel | None, RecordingChat | None]:
    """The chat model with its books, and the recording if there is one.

    Raises:
        ConfigError: There is nothing to record.
        ModelError: A model in this process has no weights here.
        RecordingError: A recording is missing, broken or in the way.
        MissingExtraError: The model needs packages that are not installed.
    """
    if chosen.vlm is None:
        if record is not None:
            raise ConfigError(f"--record {record} has nothing to record; name a model with --vlm")
        return None, None
    spec = parse_vlm_spec(chosen.vlm)
    if spec.kind == "replay" and record is not None:
        raise ConfigError(
            f"--record {record} would only copy the recording {spec.target}; drop --record"
        )
    chat, recording = open_chat(spec, config.chat), None
    if record is not None:
        chat = recording = RecordingChat(chat, record)
    return LedgerChat(chat, ledger), recording


def build_detector(
    chosen: ChosenComponents, config: HyPerNavConfig, chat: ChatModel | None, log: ExchangeLog
) -> Detector:
    """Who sees the goal.

    Raises:
        ConfigError: There is no such detector, or it needs a chat model, or it is not known in
            which coordinates that model answers.
    """
    kind, _, place = chosen.detector.partition(":")
    match kind:
        case "ground-truth":
            return GroundTruthDetector()
        case "yolox":
            return YoloxDetector(Path(place), config.yolox)
        case "zero-shot":
            return ZeroShotDetector(place, config.zero_shot)
        case "vlm" if chat is not None and chosen.vlm is not None:
            detector = VlmDetector(chat, log, config.grounding)
            if _is_named(parse_vlm_spec(chosen.vlm)):
                _ = detector.family  # better refused now than at the first step
            return detector
    raise ConfigError(f"no detector '{chosen.detector}' can be built here")


def build_segmenter(spec: str, config: HyPerNavConfig) -> Segmenter:
    """A segmenter by its specification; the depth cut where none is needed."""
    kind, _, place = spec.partition(":")
    if kind == "sam":
        return SamSegmenter(place, config.sam)
    if kind == "onnx-sam":
        encoder, _, decoder = place.partition(",")
        return OnnxSamSegmenter(encoder, decoder, config.onnx_sam)
    return DepthCutSegmenter(config.depth_cut)


def build_reasoner(
    chosen: ChosenComponents, config: HyPerNavConfig, chat: ChatModel | None, log: ExchangeLog
) -> BlockReasoner | None:
    """Who chooses blocks; None for an agent without blocks."""
    if chosen.agent != "hypernav":
        return None
    geometric = GeometricReasoner(log, config.geometric)
    if chosen.reasoner == "vlm" and chat is not None:
        return VlmReasoner(chat, log, geometric, config.block_choice)
    return geometric


def component_words(part: str, chosen: ChosenComponents, chat: ChatModel | None) -> str:
    """A part for people."""
    kind, _, place = part.partition(":")
    if part == "vlm" and chosen.vlm is not None and chat is not None:
        return _model_words(parse_vlm_spec(chosen.vlm), chat.identify)
    if kind == "yolox":
        return f"YOLOX ({Path(place).name})"
    if place:
        return f"{kind} {' + '.join(Path(one).name for one in place.split(','))}"
    return _WORDS[part]


def _is_named(spec: VlmSpec) -> bool:
    """Whether the model's name is known without asking a server that may not be up yet."""
    return spec.kind != "openai" or spec.model is not None


def _model_words(spec: VlmSpec, identify: Callable[[], str]) -> str:
    """The model's name, as far as it is known."""
    match spec.kind:
        case "openai":
            return spec.model or f"the model at {spec.target}"
        case "local":
            path = Path(spec.target).expanduser()
            return path.name if path.is_dir() else spec.target
        case "replay":
            return f"{identify()} (replayed)"
