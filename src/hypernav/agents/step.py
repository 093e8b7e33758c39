"""One step of a search as the phases see it, and what they decide."""

import math
from dataclasses import dataclass, field
from enum import Enum, auto

from hypernav.agents.components import SearchComponents
from hypernav.agents.config import SearchConfig
from hypernav.core.actions import Action
from hypernav.core.clock import ModuleClock
from hypernav.core.embodiment import MotionConfig
from hypernav.core.exploring.exploration import ExplorationView
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import Ending, Mode
from hypernav.mapping.memory.memory import Memory


@dataclass(frozen=True, eq=False)
class Step:
    """Everything about the present step but memory and plan, and where phases note what happened.

    Attributes:
        number: Number of the step in the search, from 0.
        goal: Target of the search.
        observation: Frame of this step, with heights counted from the floor.
        grid: Map of the floor, with this frame in it.
        use: Components and configuration of the search.
        clock: Clock of the modules.
        events: Events worth finding again, for the trace.
    """

    number: int
    goal: Goal
    observation: Observation
    grid: OccupancyGrid
    use: SearchComponents
    clock: ModuleClock
    events: list[str]

    @property
    def robot(self) -> Pose2:
        """The robot's pose in the ``map`` frame."""
        return self.observation.robot

    @property
    def config(self) -> SearchConfig:
        """Conditions of the search, for steps of this robot."""
        return self.use.paced

    @property
    def motion(self) -> MotionConfig:
        """Length of a step and angle of a turn."""
        return self.use.embodiment.motion

    def view(self, memory: Memory) -> ExplorationView:
        """What explorers may know."""
        floor = memory.floor
        return ExplorationView(
            goal=self.goal,
            observation=self.observation,
            grid=self.grid,
            trajectory=floor.trajectory,
            visits=floor.search.visits,
            things=floor.sightings.things,
            floor=memory.number,
            notes=floor.search.notes,
        )


@dataclass(frozen=True)
class Decision:
    """The decision in one step, and its reason.

    Attributes:
        action: Action to take; None ends the search without a claim.
        mode: Mode of the agent, for the trace.
        reason: Reason in one short sentence for people.
        path: Rest of the path, from the robot on, ``(x, y)``, metres.
        ending: End of the search, if this is its last step.
    """

    action: Action | None
    mode: Mode
    reason: str
    path: list[tuple[float, float]] = field(default_factory=list)
    ending: Ending | None = None


class Phase(Enum):
    """The phases of a search, for handing a step on from one to another."""

    LOOK_AROUND = auto()
    EXPLORE = auto()
    APPROACH = auto()
    VERIFY = auto()
    SECOND_LOOK = auto()
    END = auto()


def turn_towards(robot: Pose2, point: tuple[float, float], motion: MotionConfig) -> Action | None:
    """The turn that brings a point ``(x, y)``, metres, ahead; None if it is as good as ahead."""
    bearing = robot.bearing_to(*point)
    if abs(bearing) <= math.radians(motion.turn_angle_deg) / 2 + 1e-6:
        return None
    return Action.TURN_LEFT if bearing > 0 else Action.TURN_RIGHT
