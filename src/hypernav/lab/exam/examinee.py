"""The examinee: the components of a search, asked exactly as a search asks them."""

import hashlib
import threading
from typing import Any, cast

import numpy as np

from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.components.construction import asked_by, build
from hypernav.app.build.components.registries import (
    ARROW_REASONERS,
    DETECTORS,
    GUIDES,
    REASONERS,
    SCORERS,
    SEGMENTERS,
    Factory,
)
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.components.abilities import ChecksGoal, ChecksModel
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
from hypernav.core.episode import EpisodeTruth
from hypernav.core.errors import ConfigError, GoalError
from hypernav.core.exploring.overview import BlockChoice, Overview
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog
from hypernav.lab.exam.marking import Given, marked
from hypernav.lab.exam.questions import NO_IMAGE, Answered, ExamQuestion, Kind
from hypernav.search.perception.image_recall import ImageRecall
from hypernav.search.perception.local.second_look import detect_twice
from hypernav.search.perception.local.yes_no_checks import VlmPresenceCheck

_OF_CHAT: tuple[Kind, ...] = ("presence", "images")
"""Types that the chat model alone is asked, whatever components are named."""


class _NoBlock:
    """The fallback of the examined reasoner, so that no rule answers for the model."""

    def choose(self, overview: Overview, goal: Goal, excluded: frozenset[int]) -> BlockChoice:
        return BlockChoice(None, "no usable answer")


class Examinee:
    """The components that are examined. Safe to share between threads."""

    def __init__(
        self, config: HyPerNavConfig, specs: ComponentSpecs, chat: ChatModel | None
    ) -> None:
        """Choose the components.

        Args:
            config: Configuration of robot, map and components.
            specs: Components; the model answers where no reasoner or detector is named.
            chat: The chat model; None if none is examined.

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
        check_named(specs)
        for choice, _ in self._choices.values():
            if chat is None and asked_by(choice).get("chat", False):
                raise ConfigError(f"{choice.spec} needs a chat model; name it with --vlm")
        self.detector: Detector | None = None
        """The detector, once it was made by `check`; None if none is examined."""
        self._kept: dict[Kind, Any] = {}
        self._one_at_a_time = threading.Lock()

    @property
    def kinds(self) -> tuple[Kind, ...]:
        """The types of questions that it is asked."""
        return (*self._choices, *(_OF_CHAT if self._chat else ()))

    @property
    def by_model(self) -> tuple[Kind, ...]:
        """Those that the chat model answers."""
        own = {kind for kind, (choice, _) in self._choices.items() if "chat" in asked_by(choice)}
        return tuple(k for k in self.kinds if k in own or k in _OF_CHAT)

    def check(self) -> None:
        """Make every component once, so that errors are raised before the first question.

        Raises:
            HyPerNavError: A component can't be made, or its model's coordinates are not known.
        """
        for kind in self._choices:
            made: Any = self._made(kind, ExchangeLog(), EpisodeTruth())
            if kind == "boxes":
                self.detector = made
            if isinstance(made, ChecksModel):
                made.check_model()

    def can_name(self, question: ExamQuestion) -> bool:
        """Whether its detector has a name for what it is to find; one with a closed list may not.

        Of all other questions it is true.
        """
        if question.kind != "boxes" or not isinstance(self.detector, ChecksGoal):
            return True
        try:
            self.detector.check_goal(question.goal)
        except GoalError:
            return False
        return True

    def words(self, kind: Kind) -> str:
        """Specification of the component that answers a type of question."""
        return "vlm" if kind in _OF_CHAT else self._choices[kind][0].spec

    def ask(self, question: ExamQuestion) -> Answered:
        """Ask one question, and mark the answer.

        Raises:
            ModelUnavailableError: The model did not answer within the configured patience.
            ComponentError: A component of a user's own failed.
        """
        log = ExchangeLog()
        if question.kind in self.by_model:
            given = self._given(question, log)
        else:  # a network in this process, or a rule: it may not be safe for two threads
            with self._one_at_a_time:
                given = self._given(question, log)
        return marked(question, given, log.drain())

    def _given(self, question: ExamQuestion, log: ExchangeLog) -> Given:
        goal, subject = question.goal, cast("Any", question.subject)
        use: Any = self._component(question, log)
        match question.kind:
            case "block":
                number = use.choose(subject, goal, frozenset()).number
                return Given(None if number is None else str(number))
            case "arrow":
                numbers = use.choose(subject, goal).numbers
                return Given(str(numbers[0]) if numbers else None)
            case "direction":
                return Given(str(use.direct(subject, goal).direction))
            case "boxes":
                below = self._config.local.look_closer_below
                told = detect_twice(use, subject, goal, below)
                found = tuple(one for one in told if one.is_goal)
                best = max((one.score for one in found), default=None)
                return Given(found=found, probability=best)
            case "mask":
                return Given(mask=use.segment(subject, question.boxes[0]))
            case "presence":
                return Given("yes" if use.is_present(subject, goal) else "no")
            case "near":
                return Given("yes" if use.score(subject, goal) >= 0.5 else "no")
            case "images":
                assert isinstance(subject, tuple)
                named = use.shown_in([one.rgb for one in subject], goal)
                return Given(", ".join(str(k + 1) for k in named) or NO_IMAGE)

    def _component(self, question: ExamQuestion, log: ExchangeLog) -> Any:
        """The component for a question: a new one, unless it uses neither log, model nor truth."""
        if question.kind in _OF_CHAT:
            assert self._chat is not None
            if question.kind == "images":
                return ImageRecall(self._chat, log, self._config.image_recall)
            return VlmPresenceCheck(self._chat, log, self._config.presence)
        return self._made(question.kind, log, truth_of(question))

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
        made = build(choice, option, protocol, self._config, offers)
        if not asked.keys() & {"chat", "truth", "log"}:
            self._kept[kind] = made
        return made


def check_named(specs: ComponentSpecs) -> None:
    """Refuse an exam of nobody.

    Raises:
        ConfigError: Neither a model nor a component is named.
    """
    if not (specs.vlm or specs.detector or specs.segmenter or specs.reasoner):
        raise ConfigError(
            "name what is examined: --vlm openai:http://localhost:8000/v1, --detector, "
            "--segmenter or --reasoner"
        )


def truth_of(question: ExamQuestion) -> EpisodeTruth:
    """The truth about one question, for stand-ins that know it."""
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
