"""Names and warnings for components that replace a network of the published method."""

import re
from dataclasses import dataclass

from hypernav.app.build.components.choosing import ChosenComponents
from hypernav.core.components.abilities import score_weights_of
from hypernav.search.models.onnx_detector import OnnxDetector
from hypernav.search.perception.config import LocalConfig


@dataclass(frozen=True)
class SegmenterWords:
    """The segmenter's name, and a warning if it only replaces the published one.

    Attributes:
        words: Name of the segmenter for people.
        warning: Sentence to show before a search; empty if nothing is replaced.
    """

    words: str
    warning: str = ""


def segmenter_words(
    chosen: ChosenComponents, published: str, *, detector_words: str, model: str
) -> SegmenterWords:
    """Name the segmenter.

    Args:
        chosen: Components in use. A segmenter is the published one if its specification says so:
            ``onnx-sam:mobile_sam_encoder.onnx,…`` is MobileSAM.
        published: Segmenter that the configuration asks for; empty if it asks for none.
        detector_words: Name of the detector, whose detections may carry their masks.
        model: Name of the chat model.
    """
    if chosen.segmenter is None:
        if chosen.is_whole_agent or not published:
            return SegmenterWords("none")
        words = f"masks of {detector_words}, in place of {published}"
        return SegmenterWords(words, f"segments with {words}")
    words = chosen.segmenter.words(model=model)
    if _letters(published) in _letters(chosen.segmenter.spec):
        return SegmenterWords(words)
    words += f", in place of {published}"
    remedy = "with weights of it: --segmenter onnx-sam:ENCODER.onnx,DECODER.onnx"
    return SegmenterWords(words, f"segments with {words}; {remedy}")


def beside_published(chosen: ChosenComponents, published: str, model: str) -> str:
    """The chat model's name for people, beside that of the published method if it is another.

    Args:
        chosen: Components in use.
        published: Model that the configuration asks for; empty if it asks for none.
        model: Name of the chat model; empty without one.
    """
    words = model or "none"
    if chosen.is_whole_agent or not published or _is_named(published, model):
        return words
    return f"{words}; the published one is {published}"


def _is_named(published: str, model: str) -> bool:
    """Whether a model's name has family and size of another: Qwen2.5-VL-7B-Instruct, QwenVL-7B."""
    family, _, size = published.lower().rpartition("-")
    said = model.lower()
    has_size = re.search(rf"(?<![\d.]){re.escape(size)}(?![a-z\d])", said) is not None
    return has_size and family in re.sub(r"[^a-z]", "", said)


def labels_warning(chosen: ChosenComponents) -> str:
    """Sentence to show before a search that is told what its images show; else empty."""
    is_told = chosen.detector is not None and chosen.detector.spec == "ground-truth"
    return "no detector runs: the simulator gives true labels" if is_told else ""


def unmeasured(chosen: ChosenComponents, detector: object, local: LocalConfig) -> str:
    """Sentence to show before a search with a detector whose scores were never measured."""
    is_weighed = local.target == "candidates" and not chosen.is_whole_agent
    if chosen.detector is None or local.score_weights or not is_weighed:
        return ""
    parts = getattr(detector, "parts", (detector,))
    choices = chosen.detector.parts or (chosen.detector,)
    for part, choice in zip(parts, choices, strict=True):
        if not score_weights_of(part):
            command = f"hypernav exam --detector {choice.spec}"
            command += " --calibrate" if isinstance(part, OnnxDetector) else ", for --exam"
            return (
                f"nobody measured how far the scores of {choice.words(model='')} can be trusted, "
                f"so they count little; measure it: {command}"
            )
    return ""


def reasoner_warning(chosen: ChosenComponents) -> str:
    """Sentence to show before a search whose reasoner only replaces a model; else empty."""
    if chosen.reasoner is None:
        return ""
    stands_in_for = getattr(chosen.reasoner.load(), "stands_in_for", "")
    if not stands_in_for:
        return ""
    return f"reasons by {chosen.reasoner.words(model='')}, in place of {stands_in_for}"


def _letters(name: str) -> str:
    return "".join(letter for letter in name.lower() if letter.isalnum())
