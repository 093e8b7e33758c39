"""Who sits the exam: the components of the search, asked exactly as a search asks them."""

import hashlib
import threading
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Bool

from hypernav.build.component_specs import ComponentSpecs
from hypernav.build.construction import asked_by, make, section_of
from hypernav.build.presets import HyPerNavConfig
from hypernav.build.registries import (
    ARROW_REASONERS,
    DETECTORS,
    GUIDES,
    REASONERS,
    SCORERS,
    SEGMENTERS,
    Factory,
)
from hypernav.core.components.door import through_door
from hypernav.core.components.protocols import (
    ArrowReasoner,
    BlockReasoner,
    ChatModel,
    Detector,
    Guide,
    SceneScorer,
    Segmenter,
)
from hypernav.core.components.registry import Choice, Registry
from hypernav.core.episodes.truth import EpisodeTruth
from hypernav.core.errors import ConfigError
from hypernav.core.exploring.overview import BlockChoice, Overview
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.goal import Goal
from hypernav.core.trace import Exchange, ExchangeLog
from hypernav.exam.questions import RIGHT_IOU, Answered, ExamQuestion, Kind
from hypernav.perception.local.presence import VlmPresenceCheck

_OF_A_MODEL = ("block", "boxes", "presence", "near", "arrow", "direction")


@dataclass(frozen=True)
class _Given:
    """What a component answered: an option, boxes or a mask."""

    chosen: str | None = None
    found: tuple[Detection, ...] = ()
    mask: Bool[np.ndarray, "height width"] | None = None
    probability: float | None = None


class _NoBlock:
    """Stands where a reasoner falls back, so that no rule answers for the model."""

    def choose(self, overview: Overview, goal: Goal, excluded: frozenset[int]) -> BlockChoice:
        return BlockChoice(None, "no usable answer")


class Examinee:
    """The components that are examined. Safe to share between threads."""

    def __init__(
        self, config: HyPerNavConfig, specs: ComponentSpecs, chat: ChatModel | None
    ) -> None:
        """Choose the components.

        Args:
            config: Values of the questions.
            specs: Components; what none is named for is answered by the model, if there is one.
            chat: The model; None if none is examined.

        Raises:
            ConfigError: There is nothing to examine, or a component needs a model.
        """
        self._config, self._chat, self._specs = config, chat, specs
        model = None if chat is None else "vlm"
        named: dict[Kind, tuple[Registry[Factory], str | None, type]] = {
            "block": (REASONERS, specs.reasoner or model, BlockReasoner),
            "boxes": (DETECTORS, specs.detector or model, Detector),
            "mask": (SEGMENTERS, specs.segmenter, Segmenter),
            "near": (SCORERS, model, SceneScorer),
            "arrow": (ARROW_REASONERS, model, ArrowReasoner),
            "direction": (GUIDES, model, Guide),
        }
        self._choices: dict[Kind, tuple[Choice[Factory], type]] = {
            kind: (registry.find(spec), protocol)
            for kind, (registry, spec, protocol) in named.items()
            if spec is not None
        }
        if not self._choices:
            raise ConfigError(
                "name what is examined: --vlm openai:http://localhost:8000/v1, --detector, "
                "--segmenter or --reasoner"
            )
        for choice, _ in self._choices.values():
            if chat is None and asked_by(choice).get("chat", False):
                raise ConfigError(f"{choice.spec} needs a chat model; name it with --vlm")
        self._kept: dict[Kind, Any] = {}
        self._one_at_a_time = threading.Lock()

    @property
    def kinds(self) -> tuple[Kind, ...]:
        """The types of questions that it is asked."""
        return (*self._choices, *(("presence",) if self._chat else ()))

    @property
    def by_model(self) -> tuple[Kind, ...]:
        """Those that the chat model answers."""
        own = {kind for kind, (choice, _) in self._choices.items() if "chat" in asked_by(choice)}
        return tuple(k for k in self.kinds if k in own or k == "presence")

    def detector(self) -> object:
        """The detector, for its optional abilities; None if none is examined."""
        choice = self._choices.get("boxes")
        return None if choice is None else self._made("boxes", ExchangeLog(), EpisodeTruth())

    def words(self, kind: Kind) -> str:
        """Name of the component that answers a type of question."""
        return "vlm" if kind == "presence" else self._choices[kind][0].spec

    def ask(self, question: ExamQuestion) -> Answered:
        """Ask one question, and mark the answer.

        Raises:
            ModelUnavailableError: The model did not answer within the configured patience.
            ComponentError: A component of a user's own failed.
        """
        log = ExchangeLog()
        if question.kind in self.by_model:
            given = self._given(question, log)
        else:  # a network in this process, or a rule: nobody says that two threads may use it
            with self._one_at_a_time:
                given = self._given(question, log)
        return _marked(question, given, log.drain())

    def _given(self, question: ExamQuestion, log: ExchangeLog) -> _Given:
        goal, subject = question.goal, question.subject
        use: Any = self._component(question, log)
        match question.kind:
            case "block":
                number = use.choose(subject, goal, frozenset()).number
                return _Given(None if number is None else str(number))
            case "arrow":
                numbers = use.choose(subject, goal).numbers
                return _Given(str(numbers[0]) if numbers else None)
            case "direction":
                return _Given(str(use.direct(subject, goal).direction))
            case "boxes":
                found = tuple(use.detect(subject, goal))
                best = max((one.score for one in found), default=None)
                return _Given(found=found, probability=best)
            case "mask":
                return _Given(mask=use.segment(subject, question.boxes[0]))
            case "presence":
                return _Given("yes" if use.is_present(subject, goal) else "no")
            case "near":
                return _Given("yes" if use.score(subject, goal) >= 0.5 else "no")

    def _component(self, question: ExamQuestion, log: ExchangeLog) -> Any:
        """The component for a question: a fresh one with this log, unless it keeps weights."""
        if question.kind == "presence":
            assert self._chat is not None
            return VlmPresenceCheck(self._chat, log, self._config.presence)
        return self._made(question.kind, log, _truth(question))

    def _made(self, kind: Kind, log: ExchangeLog, truth: EpisodeTruth) -> Any:
        if kind in self._kept:
            return self._kept[kind]
        choice, protocol = self._choices[kind]
        asked = asked_by(choice)
        offers: dict[str, Any] = {
            "log": log,
            "embodiment": self._config.embodiment,
            "mapping": self._config.mapping,
            "fallback": _NoBlock(),
            "truth": truth,
        }
        offers |= {} if self._chat is None else {"chat": self._chat}
        option = {"boxes": "detector", "mask": "segmenter"}.get(kind, "reasoner")
        section = section_of(choice, option, self._config)
        offers |= {} if section is None else {"config": section}
        made = through_door(make(choice, offers), protocol, f"--{option} {choice.spec}")
        if not asked.keys() & {"chat", "truth", "log"}:
            self._kept[kind] = made
        return made


def _truth(question: ExamQuestion) -> EpisodeTruth:
    """The truth about one question, for stand-ins."""
    truth, left_m = EpisodeTruth(), dict[tuple[float, float], float]()
    if isinstance(question.subject, Overview):
        left_m = {
            block.destination: question.costs[str(block.number)] - block.travel_m
            for block in question.subject.blocks
            if str(block.number) in question.costs
        }
    seed = int.from_bytes(hashlib.sha256(question.id.encode()).digest()[:8])
    truth.tell(rng=np.random.default_rng(seed), path_left_m=lambda x, y: left_m[x, y])
    return truth


def _marked(question: ExamQuestion, given: _Given, exchanges: list[Exchange]) -> Answered:
    unusable = _unusable(question, given, exchanges)
    chosen = None if unusable and question.kind != "boxes" else given.chosen
    costs = {key: cost for key, cost in question.costs.items() if np.isfinite(cost)}
    options = list(question.costs) or (["yes", "no"] if question.right else [])
    overlap = _overlap(question, given)
    score = _score(question, chosen, given, overlap) if not unusable else 0.0
    image = getattr(question.subject, "rgb", None)
    texts = [one.answer for one in exchanges if one.kind == "ground"]
    return Answered(
        id=question.id,
        kind=question.kind,
        stratum=question.stratum,
        scene=question.scene,
        goal=question.goal.text,
        conditions={k: round(v, 3) for k, v in question.conditions.items() if np.isfinite(v)},
        options=options,
        right=sorted(question.right),
        costs={key: round(cost, 3) for key, cost in costs.items()},
        chosen=chosen,
        rule=question.rule,
        true_boxes=[_corners(box) for box in question.boxes],
        boxes=[_corners(one.box) for one in _best_first(given.found)],
        raw_boxes=bool(given.found) or any("[" in text.strip("[] \n`json") for text in texts),
        image_size=(0, 0) if image is None else (image.shape[1], image.shape[0]),
        score=score,
        chance=len(question.right) / len(options) if options else 0.0,
        rule_score=float(question.rule in question.right) if question.rule else None,
        overlap=overlap,
        probability=_probability(question, chosen, given, exchanges),
        unusable=unusable,
        exchanges=exchanges,
    )


def _score(
    question: ExamQuestion, chosen: str | None, given: _Given, overlap: float | None
) -> float:
    if question.kind == "mask" or question.boxes:
        return float(overlap is not None and overlap >= RIGHT_IOU)
    if question.kind == "boxes":
        return float(not given.found)
    return float(chosen in question.right)


def _overlap(question: ExamQuestion, given: _Given) -> float | None:
    """Overlap with the truth: of the mask, or of the best box with the true one it fits best."""
    if question.mask is not None and given.mask is not None:
        both = np.count_nonzero(question.mask & given.mask)
        return both / max(np.count_nonzero(question.mask | given.mask), 1)
    if question.kind != "boxes" or not question.boxes:
        return None
    first = _best_first(given.found)[:1]
    return max((true.iou(one.box) for one in first for true in question.boxes), default=0.0)


def _unusable(question: ExamQuestion, given: _Given, exchanges: list[Exchange]) -> str:
    """Why an answer can't be used; empty if it can, or if no model gave it."""
    asked = [one for one in exchanges if one.by_model]
    if not asked:
        return ""
    main = next((one for one in asked if one.kind != "crop"), asked[0])
    reason = main.fault or next(iter(main.remarks), "")
    if question.kind == "boxes":
        return "" if given.found or not _is_unread(main) else reason
    if question.kind in ("block", "arrow"):
        return "" if given.chosen is not None else reason or "it names none of the options"
    return main.fault and (reason or main.fault)


def _is_unread(exchange: Exchange) -> bool:
    """Whether no box could be read and the answer doesn't say that there is none."""
    return bool(exchange.fault) or any(
        remark == "no box in the answer" or remark.startswith(tuple("123456789"))
        for remark in exchange.remarks
    )


def _probability(
    question: ExamQuestion, chosen: str | None, given: _Given, exchanges: list[Exchange]
) -> float | None:
    """What the model says how sure it is of its answer."""
    told: list[Mapping[str, float]] = [one.probabilities for one in exchanges if one.probabilities]
    if question.kind == "boxes":
        return given.probability
    if chosen is None or not told:
        return None
    return told[-1].get(chosen)


def _best_first(found: tuple[Detection, ...]) -> list[Detection]:
    return sorted(found, key=lambda one: -one.score)


def _corners(box: Box) -> tuple[float, float, float, float]:
    return (round(box.x_min, 1), round(box.y_min, 1), round(box.x_max, 1), round(box.y_max, 1))
