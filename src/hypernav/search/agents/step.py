"""One step of a search: what the phases are given, what they decide, and which turns show most."""

import math
from dataclasses import dataclass, field
from enum import Enum, auto
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float64

from hypernav.core.components.abilities import Learns
from hypernav.core.components.protocols import Explorer, PresenceCheck
from hypernav.core.embodiment import Action, Embodiment, MotionConfig
from hypernav.core.exploring.exploration import ExplorationView
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import Ending, ExchangeLog, Mode, ModuleClock
from hypernav.search.agents.config import SearchConfig
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.sight_lines import unseen_by_bearing
from hypernav.search.memory.floor import HeadingsSeen
from hypernav.search.memory.floor_exits import (
    drops_to_look_at,
    known_floors,
    stairs_to_new_floors,
)
from hypernav.search.memory.memory import Memory
from hypernav.search.perception.image_recall import ImageRanking, ImageRecall
from hypernav.search.perception.local.local_perception import LocalPerception
from hypernav.search.planning.config import PlanningConfig
from hypernav.search.planning.navigator import Navigator

_RAYS = 72
_SAME_SPOT_M = 0.1


class Gaze:
    """Chooses turns by the unseen floor that they would show. It has no state of its own.

    Floor that is still unknown in a direction in which the robot has looked is hidden from there.
    """

    def __init__(self, embodiment: Embodiment, least_m2: float) -> None:
        """Create it.

        Args:
            embodiment: Camera, and angle of a turn.
            least_m2: Unseen floor that a look must be able to show, square metres.
        """
        camera = embodiment.camera
        self._half_view = math.radians(camera.hfov_deg) / 2.0
        self._nearest_m, self._farthest_m = camera.floor_from_m, camera.max_depth_m
        self._turn = math.radians(embodiment.motion.turn_angle_deg)
        self._turns_of_a_circle = embodiment.motion.turns_of_a_circle
        self._least_m2 = least_m2
        self._bearings = np.arange(_RAYS) * (2.0 * math.pi / _RAYS)

    def after_image(self, looked: HeadingsSeen | None, robot: Pose2) -> HeadingsSeen:
        """Where the robot has looked from its position, its present image included."""
        if looked is None or robot.distance_to(*looked.spot) > _SAME_SPOT_M:
            looked = HeadingsSeen(robot.xy, np.zeros(_RAYS, dtype=bool))
        return HeadingsSeen(looked.spot, looked.bearings | self._in_view(robot.yaw))

    def worthwhile_turn(
        self, grid: OccupancyGrid, robot: Pose2, looked: HeadingsSeen | None
    ) -> Action | None:
        """The first turn to the heading that shows most per turn; None if none shows enough.

        Args:
            grid: The map.
            robot: Pose of the robot.
            looked: Where it has looked from its position; None if nowhere yet.
        """
        unseen = unseen_by_bearing(
            grid,
            robot.xy,
            self._bearings,
            nearest_m=self._nearest_m,
            farthest_m=self._farthest_m,
        )
        if looked is not None:
            unseen[looked.bearings] = 0.0
        best, most = None, 0.0
        for turns in range(1, self._turns_of_a_circle // 2 + 1):
            for action, sign in ((Action.TURN_LEFT, 1.0), (Action.TURN_RIGHT, -1.0)):
                shown = float(unseen[self._in_view(robot.yaw + sign * turns * self._turn)].sum())
                if shown >= self._least_m2 and shown / turns > most:
                    best, most = action, shown / turns
        return best

    def _in_view(self, yaw: float) -> Bool[np.ndarray, " rays"]:
        """The directions that an image at this heading shows."""
        away: Float64[np.ndarray, " rays"] = np.mod(self._bearings - yaw + math.pi, 2 * math.pi)
        return np.abs(away - math.pi) <= self._half_view


@dataclass(frozen=True, eq=False)
class SearchComponents:
    """The components of a search. Between two steps they keep counts and caches at most.

    Attributes:
        mapping: Configuration of the maps.
        local: Local perception: finds the goal in images and on the floor plan.
        explorer: Explorer: chooses destinations while the goal is out of sight.
        planning: Configuration of planning and path following.
        embodiment: Body, camera, step and turn of the robot.
        presence: Presence check before STOP; None trusts the goal area.
        image_recall: Question about remembered images; None where there is no chat model.
        image_ranking: Ranking of remembered images by their similarity with the goal's words; None
            where no model compares them.
        log: Log of the questions to detectors and reasoners, for the trace.
        config: Configuration of the search, for steps of 0.5 m and turns of 30 degrees.
    """

    mapping: MappingConfig
    local: LocalPerception
    explorer: Explorer
    planning: PlanningConfig
    embodiment: Embodiment
    presence: PresenceCheck | None
    image_recall: ImageRecall | None
    image_ranking: ImageRanking | None
    log: ExchangeLog
    config: SearchConfig

    @cached_property
    def paced(self) -> SearchConfig:
        """The configuration for this robot's steps and turns."""
        return self.config.paced(self.embodiment.motion)

    @cached_property
    def navigator(self) -> Navigator:
        """Navigator that drives the robot."""
        return Navigator(self.planning, self.embodiment)

    @cached_property
    def learner(self) -> Learns | None:
        """The explorer, if it learns from every image; to ask a protocol each time takes long."""
        return self.explorer if isinstance(self.explorer, Learns) else None

    @cached_property
    def gaze(self) -> Gaze | None:
        """Choice of the turns that show unseen floor; None where full circles are turned."""
        least_m2 = self.config.least_unseen_m2
        return None if least_m2 is None else Gaze(self.embodiment, least_m2)


@dataclass(frozen=True, eq=False)
class Step:
    """Everything about the present step except memory and plan; phases add events to it.

    Attributes:
        number: Number of the step in the search, from 0.
        goal: Target of the search.
        observation: Frame of this step, with heights counted from the robot's floor.
        grid: Map of that floor, with this frame integrated and closed areas as obstacles.
        components: Components and configuration of the search.
        clock: Clock of the modules.
        events: What happened in this step, in the words of the trace.
    """

    number: int
    goal: Goal
    observation: Observation
    grid: OccupancyGrid
    components: SearchComponents
    clock: ModuleClock
    events: list[str]

    @property
    def robot(self) -> Pose2:
        """The robot's pose in the ``map`` frame."""
        return self.observation.robot

    @property
    def config(self) -> SearchConfig:
        """Configuration of the search, for this robot's steps and turns."""
        return self.components.paced

    @property
    def motion(self) -> MotionConfig:
        """Length of a step and angle of a turn."""
        return self.components.embodiment.motion

    def exploration_grid(self, memory: Memory) -> OccupancyGrid:
        """The map that exploration goes by: where it looks again, the rest counts as unknown."""
        search = memory.search
        if search.revisits and search.coverage is not None:
            return search.coverage.applied(self.grid)
        return self.grid

    def view(self, memory: Memory) -> ExplorationView:
        """What explorers are told."""
        floor = memory.floor
        looks_for_stairs = self.config.use_stairs and memory.elevation is not None
        return ExplorationView(
            goal=self.goal,
            observation=self.observation,
            grid=self.exploration_grid(memory),
            trajectory=floor.trajectory,
            visits=floor.search.visits,
            things=floor.sightings.things,
            floor=memory.number,
            notes=floor.search.notes,
            ways_out=stairs_to_new_floors(memory) if self.config.use_stairs else (),
            elsewhere=known_floors(memory) if self.config.use_stairs else (),
            drops=drops_to_look_at(memory) if looks_for_stairs else (),
        )


@dataclass(frozen=True)
class Decision:
    """The decision in one step, and its reason.

    Attributes:
        action: Action to take; None ends the search without a claim.
        mode: Mode of the agent, for the trace.
        reason: Reason in one short sentence for people.
        path: Rest of the path, from the robot on, ``(x, y)``, ``map`` frame, metres.
        ending: End of the search, if this is its last step.
    """

    action: Action | None
    mode: Mode
    reason: str
    path: list[tuple[float, float]] = field(default_factory=list)
    ending: Ending | None = None


class Phase(Enum):
    """The phases that a step may be handed on to."""

    EXPLORE = auto()
    APPROACH = auto()
    VERIFY = auto()
    SECOND_LOOK = auto()
    CLIMB = auto()
    GET_FREE = auto()
    END = auto()


def turn_towards(robot: Pose2, point: tuple[float, float], motion: MotionConfig) -> Action | None:
    """The turn towards a point ``(x, y)``, metres; None if it is about ahead."""
    bearing = robot.bearing_to(*point)
    if abs(bearing) <= math.radians(motion.turn_angle_deg) / 2 + 1e-6:
        return None
    return Action.TURN_LEFT if bearing > 0 else Action.TURN_RIGHT
