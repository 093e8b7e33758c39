"""The one place that turns a configuration into objects."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from hypernav.agents.config import SearchConfig
from hypernav.agents.search import SearchAgent
from hypernav.core.config import RoomConfig
from hypernav.core.errors import ConfigError, SceneError
from hypernav.core.goal import Goal
from hypernav.core.protocols import Detector
from hypernav.core.trace import ExchangeLog
from hypernav.mapping import MappingConfig, TopDownMap
from hypernav.models.yolox import YoloxDetector
from hypernav.perception.depth_cut import DepthCutSegmenter
from hypernav.perception.geometric import GeometricConfig, GeometricReasoner
from hypernav.perception.ground_truth import GroundTruthDetector
from hypernav.perception.local import LocalConfig, LocalPerception
from hypernav.perception.nearest_frontier import NearestFrontierExplorer
from hypernav.perception.overview import BlockExplorer, OverviewConfig
from hypernav.planning import Navigator, PlanningConfig
from hypernav.worlds import Scene, SimulationConfig, load_scene
from hypernav.worlds.houses import BUILTIN_HOUSE, cached_house

AgentName = Literal["hypernav", "frontier"]
PresetName = Literal["default", "paper"]

_HOUSE_DIGITS = 9


class HyPerNavConfig(RoomConfig):
    """Everything that can be set, one section a room.

    Attributes:
        world: The simulated robot, its camera and its actions.
        mapping: How the map is drawn.
        local: How a detection becomes a goal area.
        overview: How the map question is asked.
        geometric: How blocks are weighed without a model.
        planning: How the robot drives.
        search: When to look, when to stop, when to think again.
    """

    world: SimulationConfig = SimulationConfig()
    mapping: MappingConfig = MappingConfig()
    local: LocalConfig = LocalConfig()
    overview: OverviewConfig = OverviewConfig()
    geometric: GeometricConfig = GeometricConfig()
    planning: PlanningConfig = PlanningConfig()
    search: SearchConfig = SearchConfig()


def preset(name: PresetName) -> HyPerNavConfig:
    """A named configuration: the published method, or the one that we measured to be better."""
    if name == "default":
        return HyPerNavConfig()
    return HyPerNavConfig(
        local=LocalConfig(
            target="latest",
            pick="first",
            max_missed_share=1.0,
            min_mean_score=0.0,
            largest_cluster_only=False,
        ),
        planning=PlanningConfig(
            comfort_cost=0.0,
            targets="nearest-straight",
            steering="waypoint",
            replan_every_steps=10,
        ),
        search=SearchConfig(look_around_at_start=False, drop_explored=False, verify_view="current"),
    )


_REASONER_WORDS: dict[AgentName, str] = {
    "hypernav": "geometric",
    "frontier": "nearest frontier",
}


@dataclass(frozen=True)
class AgentParts:
    """An agent, and who in it sees and thinks, in words for people.

    Attributes:
        agent: Ready for `reset`.
        detector: What sees the goal.
        detector_words: The same in words.
        reasoner_words: Who chooses where to look, in words.
    """

    agent: SearchAgent
    detector: Detector
    detector_words: str
    reasoner_words: str

    def check_goal(self, goal: Goal) -> None:
        """Refuse a goal that a detector with fixed classes can never see.

        Raises:
            GoalError: It cannot; the message names the nearest classes.
        """
        if isinstance(self.detector, YoloxDetector):
            self.detector.check_goal(goal)


def build_agent(
    config: HyPerNavConfig, *, agent: AgentName = "hypernav", detector: str = "ground-truth"
) -> AgentParts:
    """Put an agent together.

    Args:
        config: Values of the method.
        agent: How it explores.
        detector: ``ground-truth``, or ``yolox:PATH.onnx``.

    Raises:
        ConfigError: There is no such detector.
        ModelError: Its file cannot be used.
        MissingExtraError: It needs a package that is not installed.
    """
    log = ExchangeLog()
    seer, seer_words = build_detector(detector)
    search = build_search(config, seer, log, agent=agent)
    return AgentParts(search, seer, seer_words, _REASONER_WORDS[agent])


def build_search(
    config: HyPerNavConfig, detector: Detector, log: ExchangeLog, *, agent: AgentName = "hypernav"
) -> SearchAgent:
    """An agent around any detector, for example one of your own.

    Args:
        config: Values of the method.
        detector: Sees the goal.
        log: Where detector and reasoner write what they were asked.
        agent: How it explores.
    """
    if agent == "hypernav":
        reasoner = GeometricReasoner(log, config.geometric)
        explorer = BlockExplorer(reasoner, config.overview, config.mapping)
    else:
        explorer = NearestFrontierExplorer(log, config.mapping)
    return SearchAgent(
        world_map=TopDownMap(config.mapping),
        local=LocalPerception(
            detector, DepthCutSegmenter(), config.local, cell_size_m=config.mapping.cell_size_m
        ),
        explorer=explorer,
        navigator=Navigator(config.planning),
        presence=None,
        log=log,
        config=config.search,
    )


def build_detector(spec: str) -> tuple[Detector, str]:
    """A detector and its name in words.

    Raises:
        ConfigError: The specification is not understood.
    """
    kind, _, place = spec.partition(":")
    if spec == "ground-truth":
        return GroundTruthDetector(), "ground truth"
    if kind == "yolox" and place:
        detector = YoloxDetector(Path(place))
        return detector, f"YOLOX ({Path(place).name})"
    raise ConfigError(f"unknown detector '{spec}'; use ground-truth or yolox:PATH.onnx")


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
