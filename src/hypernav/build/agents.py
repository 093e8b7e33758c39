"""The one place that turns a configuration into objects."""

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from hypernav.agents.search import SearchAgent, SearchComponents
from hypernav.build.component_specs import (
    AgentName,
    ChosenComponents,
    ComponentSpecs,
    choose_components,
)
from hypernav.build.components import (
    build_detector,
    build_reasoner,
    build_segmenter,
    component_words,
    wrap_chat,
)
from hypernav.build.presets import HyPerNavConfig, PriceConfig
from hypernav.core.errors import SceneError
from hypernav.core.goal import Goal
from hypernav.core.protocols import BlockReasoner, Detector, PresenceCheck, Segmenter
from hypernav.core.trace import ExchangeLog
from hypernav.houses.generator import BUILTIN_HOUSE
from hypernav.houses.house_cache import cached_house
from hypernav.mapping.top_down_map import TopDownMap
from hypernav.models.chat.ledger import Ledger
from hypernav.models.chat.recording import RecordingChat
from hypernav.models.vision.yolox import YoloxDetector
from hypernav.perception.explorers.block_explorer import BlockExplorer
from hypernav.perception.explorers.geometric_reasoner import GeometricReasoner
from hypernav.perception.explorers.nearest_frontier import NearestFrontierExplorer
from hypernav.perception.explorers.prefetch import PrefetchingExplorer
from hypernav.perception.explorers.vlm_reasoner import VlmReasoner
from hypernav.perception.local.attention import Attention
from hypernav.perception.local.depth_cut import DepthCutSegmenter
from hypernav.perception.local.local_perception import LocalPerception
from hypernav.perception.local.presence import VlmPresenceCheck
from hypernav.perception.local.vlm_detector import VlmDetector
from hypernav.worlds.scenes.loading import load_scene
from hypernav.worlds.scenes.scene import Scene

_HOUSE_DIGITS = 9


@dataclass(frozen=True)
class BuiltAgent:
    """An agent, who in it sees and thinks, and the books about what they were asked.

    Attributes:
        agent: Ready for `reset`.
        detector: What sees the goal.
        chosen: What it was built from.
        detector_words: Who sees the goal, in words.
        reasoner_words: Who chooses where to look, in words.
        segmenter_words: Who finds the pixels, in words.
        ledger: What the chat model was asked; stays at zero without one.
        price: Of its tokens.
        reasoner: Chooses blocks; None for an agent without blocks.
        presence: Looks once more; None if nobody does.
        recording: Where exchanges with the chat model are written; None if nowhere.
    """

    agent: SearchAgent
    detector: Detector
    chosen: ChosenComponents
    detector_words: str
    reasoner_words: str
    segmenter_words: str
    ledger: Ledger
    price: PriceConfig
    reasoner: BlockReasoner | None = None
    presence: PresenceCheck | None = None
    recording: RecordingChat | None = None

    def check_goal(self, goal: Goal) -> None:
        """Refuse a goal that a detector with fixed classes can never see.

        Raises:
            GoalError: It cannot; the message names the nearest classes.
        """
        if isinstance(self.detector, YoloxDetector):
            self.detector.check_goal(goal)

    def take_report(self) -> dict[str, Any]:
        """What the chat model was asked since the last report, for ``result.json``.

        Returns:
            ``ledger``: calls, tokens, seconds and retries per kind of question, and the cost if a
            price is configured. ``fallbacks``: what was done in place of answers that could not
            be used. Empty without a chat model.
        """
        if self.chosen.vlm is None:
            return {}
        ledger = self.ledger.as_dict(
            price_in_per_million=self.price.in_per_million,
            price_out_per_million=self.price.out_per_million,
        )
        self.ledger.clear()
        fallbacks: dict[str, Any] = {}
        if isinstance(self.detector, VlmDetector):
            fallbacks["rejected_boxes"] = dict(sorted(self.detector.rejected.items()))
            self.detector.rejected.clear()
        if isinstance(self.reasoner, VlmReasoner):
            fallbacks["geometric_choices"] = self.reasoner.fallbacks
            self.reasoner.fallbacks = 0
        if isinstance(self.presence, VlmPresenceCheck):
            fallbacks["unsure_presence_checks"] = self.presence.unsure
            self.presence.unsure = 0
        return {"ledger": ledger, "fallbacks": fallbacks}

    def close(self) -> None:
        """End a recording; what was recorded is on disk already."""
        if self.recording is not None:
            self.recording.close()


def build_agent(
    config: HyPerNavConfig, specs: ComponentSpecs | None = None, *, record: Path | None = None
) -> BuiltAgent:
    """Put an agent together.

    Args:
        config: Values of the method.
        specs: Who sees and thinks; without a model by default.
        record: Where to write every exchange with the chat model.

    Raises:
        ConfigError: Parts that do not exist, or do not go together.
        ModelError: A model's file cannot be used.
        RecordingError: A recording is missing, broken or in the way.
        MissingExtraError: A part needs a package that is not installed.
    """
    chosen = choose_components(specs or ComponentSpecs(), presence=config.presence.enabled)
    log, ledger = ExchangeLog(), Ledger()
    chat, recording = wrap_chat(chosen, config, ledger, record)
    detector = build_detector(chosen, config, chat, log)
    segmenter = build_segmenter(chosen.segmenter, config)
    ahead = config.prefetch.enabled and chosen.reasoner == "vlm"
    map_log = ExchangeLog() if ahead else log
    reasoner = build_reasoner(chosen, config, chat, map_log)
    presence = None
    if chat is not None and chosen.presence == "vlm":
        presence = VlmPresenceCheck(chat, log, config.presence)
    agent = build_search(
        config,
        detector,
        log,
        agent=chosen.agent,
        segmenter=segmenter,
        reasoner=reasoner,
        presence=presence,
        attention=Attention(log, config.attention) if chosen.detector == "vlm" else None,
        map_log=map_log if ahead else None,
    )
    return BuiltAgent(
        agent=agent,
        detector=detector,
        chosen=chosen,
        detector_words=component_words(chosen.detector, chosen, chat),
        reasoner_words=component_words(chosen.reasoner, chosen, chat),
        segmenter_words=component_words(chosen.segmenter, chosen, chat),
        ledger=ledger,
        price=config.price,
        reasoner=reasoner,
        presence=presence,
        recording=recording,
    )


def build_search(
    config: HyPerNavConfig,
    detector: Detector,
    log: ExchangeLog,
    *,
    agent: AgentName = "hypernav",
    segmenter: Segmenter | None = None,
    reasoner: BlockReasoner | None = None,
    presence: PresenceCheck | None = None,
    attention: Attention | None = None,
    map_log: ExchangeLog | None = None,
) -> SearchAgent:
    """An agent around any detector, for example one of your own.

    Args:
        config: Values of the method.
        detector: Sees the goal.
        log: Where detector and reasoner write what they were asked.
        agent: How it explores.
        segmenter: Finds the pixels in a box; cuts by depth unless given.
        reasoner: Chooses blocks; geometric unless given.
        presence: Looks once more before STOP; nobody unless given.
        attention: Says which images the detector is asked about; all unless given.
        map_log: A log of the reasoner's own: it is asked ahead, while the robot drives.
    """
    embodiment = config.embodiment
    clearances_m = config.planning.clearances_m(embodiment.body)
    if agent == "hypernav":
        reasoner = reasoner or GeometricReasoner(log, config.geometric)
        explorer = BlockExplorer(reasoner, config.overview, config.mapping, clearances_m)
        if map_log is not None:
            explorer = PrefetchingExplorer(explorer, map_log, log, config.prefetch)
    else:
        explorer = NearestFrontierExplorer(log, config.mapping, clearances_m)
    components = SearchComponents(
        new_map=partial(TopDownMap, config.mapping, embodiment),
        local=LocalPerception(
            detector,
            segmenter or DepthCutSegmenter(),
            config.local,
            embodiment.camera,
            cell_size_m=config.mapping.cell_size_m,
            attention=attention,
        ),
        explorer=explorer,
        planning=config.planning,
        embodiment=embodiment,
        presence=presence,
        log=log,
        config=config.search,
    )
    return SearchAgent(components)


def build_scene(spec: str) -> Scene:
    """A scene by name.

    Args:
        spec: ``builtin``, ``houses:N`` for the generated house of number N, or the path of a GLB.

    Raises:
        SceneError: The file cannot be used, or there is no such house.
    """
    if spec == "builtin":
        return cached_house(BUILTIN_HOUSE)
    kind, colon, number = spec.partition(":")
    if colon and kind == "houses":
        return cached_house(house_number(number))
    return load_scene(Path(spec))


def house_number(text: str) -> int:
    """The number of a house, as people write it.

    Raises:
        SceneError: It is none.
    """
    if not (text.isascii() and text.isdecimal() and len(text) <= _HOUSE_DIGITS):
        raise SceneError(
            f"there is no house '{text}'; expected a whole number of at most {_HOUSE_DIGITS} "
            "digits, for example houses:1234"
        )
    return int(text)
