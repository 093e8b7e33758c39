"""Agents that ask a model for every move and make it without looking (native mode).

They have no detector and no planner: a model says whether the robot is at the goal, and which move
to make; that move is then made without looking at images. Source: Goetting, Singh and Loquercio,
"End-to-End Navigation with Vision-Language Models", 2024, and its released code.
"""

import math
from collections import Counter, deque
from dataclasses import dataclass, field
from typing import Any, Protocol, runtime_checkable

import numpy as np
from jaxtyping import Bool

from hypernav.core.components.abilities import Reports, warning_of
from hypernav.core.components.protocols import ArrowReasoner, ChatModel, Explorer
from hypernav.core.embodiment import Action, Embodiment, MotionConfig
from hypernav.core.errors import WorldError
from hypernav.core.events import Event
from hypernav.core.exploring.exploration import Destination, ExplorationView
from hypernav.core.exploring.insight import Insight
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import Ending, ExchangeLog, Mode, ModuleClock, StepTrace
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.memory.floor import Floor
from hypernav.search.memory.memory import Memory
from hypernav.search.perception.exchanges import YesNoAsker, yes_no_question
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from hypernav.search.rivals.arrows.arrow_explorer import VlmnavExplorer
from hypernav.search.rivals.arrows.pivot import PivotExplorer
from hypernav.search.rivals.config import ArrowsConfig, PromptedConfig, StopCheckConfig

_PAPER = MotionConfig()
"""Step and turn that moves are counted in, whatever the robot's own: 0.5 m and 30 degrees."""
_YES_TO_STOP = 2
"""Number of answers in a row, "the robot is at the goal", on which it stops (VLMnav's code)."""
_MORE_YES_THAN_NO = 0.5
_NEAR_M = 1.0
"""Distance up to which `TruthStopCheck` says yes, metres; ours."""


@runtime_checkable
class StopCheck(Protocol):
    """Tells whether the robot is at the goal."""

    def is_here(self, observation: Observation, goal: Goal) -> bool:
        """Whether the image shows the goal right before the robot."""
        ...


@dataclass(eq=False)
class ChatStopCheck(YesNoAsker):
    """Asks a vision-language model.

    Attributes:
        config: Configuration of the question.
    """

    config: StopCheckConfig = field(default_factory=StopCheckConfig)

    count_name = "unsure_stop_checks"

    def is_here(self, observation: Observation, goal: Goal) -> bool:
        """Whether the model says yes; an answer that is neither yes nor no counts as no.

        Raises:
            ModelUnavailableError: The model did not answer within the configured patience.
        """
        text = goal.named_in(self.config.prompt)
        yes = self.ask(yes_no_question("stop", text, observation.rgb), "taken for no")
        return yes is not None and yes >= _MORE_YES_THAN_NO


@dataclass(frozen=True, eq=False)
class TruthStopCheck:
    """Says by true labels and depth whether the goal is near: a stand-in for a model.

    Ours; nothing like it was published.

    Attributes:
        log: Log of all answers, for the trace.
    """

    log: ExchangeLog

    warning = "stops by the truth in view, in place of a vision-language model (--vlm)"

    def is_here(self, observation: Observation, goal: Goal) -> bool:
        """Whether labelled pixels of the goal are within 1 m along the floor.

        Raises:
            LabelsMissingError: The world supplies no labels.
        """
        found = GroundTruthDetector().detect(observation, goal)
        distances = [
            _floor_distance(observation, one.mask) for one in found if one.mask is not None
        ]
        away_m = min(distances, default=np.inf)
        here = bool(away_m <= _NEAR_M)
        seen = f"{away_m:.1f} m away" if np.isfinite(away_m) else "not in view"
        question = f"Is the {goal.thing} within {_NEAR_M:g} m?"
        self.log.note("stop", "truth", question, f"{'yes' if here else 'no'}: {seen}")
        return here


def _floor_distance(observation: Observation, mask: Bool[np.ndarray, "height width"]) -> float:
    """Distance from the robot to the nearest masked pixel with depth, along the floor, metres."""
    rows, columns = np.nonzero(mask & is_measured(observation.depth))
    if not len(rows):
        return np.inf
    at = observation.points_at(rows, columns)[:, :2]
    return float(np.hypot(*(at - np.array(observation.robot.xy)).T).min())


class PromptedAgent:
    """Asks whether it is at the goal, then which move to make; makes it, and asks again."""

    def __init__(
        self,
        explorer: Explorer,
        stop: StopCheck,
        embodiment: Embodiment,
        mapping: MappingConfig,
        log: ExchangeLog,
        config: PromptedConfig,
    ) -> None:
        """Begin with no search under way.

        Args:
            explorer: Explorer that chooses the moves from images.
            stop: Check whether the robot is at the goal.
            embodiment: What the robot is.
            mapping: Cells of the map, which the agent draws and hands to its explorer.
            log: Log of all questions, for the trace.
            config: Budget and stop.
        """
        self._explorer = explorer
        self._stop = stop
        self._embodiment = embodiment
        self._mapping = mapping
        self._log = log
        self._config = config
        self._floor: Floor | None = None
        self._trace: StepTrace | None = None
        self._moves = self._spent = 0
        self._untold = Counter[str]()

    @property
    def embodiment(self) -> Embodiment:
        """The robot that the agent was built for."""
        return self._embodiment

    @property
    def warning(self) -> str:
        """Warning of what replaces the stop question, shown before a search; empty if nothing."""
        return warning_of(self._stop)

    def reset(self, goal: Goal) -> None:
        """Forget everything and begin a new search."""
        self._goal = goal
        self._log.drain()
        self._floor = Memory(self._mapping, self._embodiment).floor
        self._yes_in_a_row = 0
        self._left = deque[Action]()
        self._destination: Destination | None = None
        self._trace = None
        self._moves = self._spent = 0

    def act(self, observation: Observation) -> Action | None:
        """Go on with the move, or choose the next one.

        Raises:
            ModelUnavailableError: The model did not answer.
        """
        floor, clock, events = self._known, ModuleClock(), list[str]()
        action: Action | None
        insight = None
        if self._left:
            floor.trajectory.append(observation.robot.xy)
            action = self._left.popleft()
            reason = self._destination.reason if self._destination else ""
        else:
            with clock("map"):
                floor.integrate(observation)
            with clock("global"):
                action, reason, insight = self._choose(observation, events)
        ending = Ending.of(action)
        self._trace = StepTrace(
            step=len(floor.trajectory) - 1,
            pose=(observation.robot.x, observation.robot.y, observation.robot.yaw),
            z=self._embodiment.camera.base_z(observation.camera_to_map),
            action=action,
            mode=Mode.EXPLORE if ending is None else Mode.STOP,
            reason=reason,
            destination=self._destination.xy if self._destination and ending is None else None,
            exchanges=self._log.drain(),
            events=events,
            insight=insight,
            ending=ending,
            seconds=clock.seconds,
        )
        return action

    def _choose(
        self, observation: Observation, events: list[str]
    ) -> tuple[Action | None, str, Insight | None]:
        """First action of the next move or end of the search, the reason, what the explorer saw."""
        config, robot, floor = self._config, observation.robot, self._known
        here = self._stop.is_here(observation, self._goal)
        self._yes_in_a_row = self._yes_in_a_row + 1 if here else 0
        if self._yes_in_a_row >= _YES_TO_STOP:
            events.append(Event.GOAL_REACHED)
            return Action.STOP, f"here is {self._goal.in_sentence}", None
        if self._moves >= config.most_moves:
            return None, f"{config.most_moves} moves are made", None
        if self._spent >= config.most_actions:
            return None, f"the moves made are worth {config.most_actions} actions", None
        if here:
            events.append(Event.SAID_TO_BE_AT_GOAL)
        view = ExplorationView(
            goal=self._goal,
            observation=observation,
            grid=floor.map.grid,
            trajectory=floor.trajectory,
            notes=floor.search.notes,
            may_be_here=here,
        )
        destination = self._explorer.next_destination(view)
        if not isinstance(destination, Destination):  # it is shown no stairs
            return None, "no move is left", None
        self._destination = destination
        spent = paper_actions(destination, robot)
        self._moves += 1
        self._spent += spent
        self._untold.update(moves=1, actions_of_half_a_metre=spent)
        self._left.extend(actions_to(destination, robot, self._embodiment.motion))
        return self._left.popleft(), destination.reason, destination.insight

    def take_report(self) -> dict[str, Any]:
        """Moves since the last call, the actions of 0.5 m and 30° they are worth, and faults."""
        report = {key: self._untold[key] for key in ("moves", "actions_of_half_a_metre")}
        self._untold.clear()
        return report | (self._stop.take_report() if isinstance(self._stop, Reports) else {})

    @property
    def last_step(self) -> StepTrace:
        """The trace of the latest `act`."""
        if self._trace is None:
            raise WorldError("the agent has not acted yet; call reset(goal), then act(observation)")
        return self._trace

    @property
    def grid(self) -> OccupancyGrid:
        """The map drawn so far, from the images that moves were chosen from."""
        return self._known.map.grid

    @property
    def _known(self) -> Floor:
        if self._floor is None:
            raise WorldError("no search is under way; call reset(goal) first")
        return self._floor


class NativeVlmnav(PromptedAgent):
    """VLMnav with its own stop and moves."""

    def __init__(
        self,
        arrow_reasoner: ArrowReasoner,
        embodiment: Embodiment,
        mapping: MappingConfig,
        clearances_m: tuple[float, ...],
        log: ExchangeLog,
        prompted: PromptedConfig,
        chat: ChatModel | None = None,
        config: ArrowsConfig | None = None,
    ) -> None:
        """Put it together; see `VlmnavExplorer` and `PromptedAgent`.

        Without a ``chat`` model for the stop question it stops by the truth.
        """
        explorer = VlmnavExplorer(
            arrow_reasoner, embodiment, mapping, clearances_m, config or ArrowsConfig()
        )
        stop = _stop_check(chat, log, prompted.stop)
        super().__init__(explorer, stop, embodiment, mapping, log, prompted)


class NativePivot(PromptedAgent):
    """PIVOT with VLMnav's stop and moves."""

    def __init__(
        self,
        arrow_reasoner: ArrowReasoner,
        embodiment: Embodiment,
        mapping: MappingConfig,
        log: ExchangeLog,
        prompted: PromptedConfig,
        chat: ChatModel | None = None,
        config: ArrowsConfig | None = None,
    ) -> None:
        """Put it together; see `PivotExplorer` and `PromptedAgent`.

        Without a ``chat`` model for the stop question it stops by the truth.
        """
        explorer = PivotExplorer(arrow_reasoner, embodiment, config or ArrowsConfig())
        stop = _stop_check(chat, log, prompted.stop)
        super().__init__(explorer, stop, embodiment, mapping, log, prompted)


def _stop_check(chat: ChatModel | None, log: ExchangeLog, config: StopCheckConfig) -> StopCheck:
    return TruthStopCheck(log) if chat is None else ChatStopCheck(chat, log, config)


def actions_to(destination: Destination, robot: Pose2, motion: MotionConfig) -> list[Action]:
    """The actions of a move: a turn, then straight ahead; as exactly as the robot's actions allow.

    Args:
        destination: End of the move, or a heading to turn to on the spot.
        robot: Pose of the robot.
        motion: Effect of its actions.
    """
    turn, length_m = _move(destination, robot)
    turns = round(math.degrees(abs(turn)) / motion.turn_angle_deg)
    side = Action.TURN_LEFT if turn > 0 else Action.TURN_RIGHT
    actions = [side] * turns + [Action.MOVE_FORWARD] * round(length_m / motion.forward_m)
    return actions or [Action.MOVE_FORWARD]


def paper_actions(destination: Destination, robot: Pose2) -> int:
    """Number of actions of 0.5 m and 30 degrees that a move stands for: 3 + 3 for 90° and 1.5 m."""
    turn, length_m = _move(destination, robot)
    turns = math.ceil(math.degrees(abs(turn)) / _PAPER.turn_angle_deg - 1e-6)
    return max(turns + math.ceil(length_m / _PAPER.forward_m - 1e-6), 1)


def _move(destination: Destination, robot: Pose2) -> tuple[float, float]:
    """Turn, radians, positive to the left, and length of the path straight ahead, metres."""
    length_m = robot.distance_to(*destination.xy)
    if destination.face is None:
        return robot.bearing_to(*destination.xy), length_m
    return math.remainder(destination.face - robot.yaw, math.tau), length_m
