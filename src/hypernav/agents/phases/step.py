"""One step of a search as the phases see it, and the decision that they make."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import Enum, auto
from typing import Protocol

from hypernav.core.actions import Action
from hypernav.core.clock import ModuleClock
from hypernav.core.embodiment import MotionConfig
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.observation import Observation
from hypernav.core.trace import Ending, Mode


@dataclass(frozen=True, eq=False)
class Step:
    """Everything that a phase may know about the present step, and where it notes what happened.

    Attributes:
        observation: Frame of this step.
        grid: Map, with this frame in it.
        trajectory: Positions of the robot so far, this one included; ``map`` frame, metres.
        motion: Length of a step and angle of a turn.
        clock: Clock of the modules.
        events: Events worth finding again, for the trace.
    """

    observation: Observation
    grid: OccupancyGrid
    trajectory: Sequence[tuple[float, float]]
    motion: MotionConfig
    clock: ModuleClock
    events: list[str]

    @property
    def robot(self) -> Pose2:
        """The robot's pose in the ``map`` frame."""
        return self.observation.robot


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


class PhaseName(Enum):
    """Names of the phases, for handing a step on from one to another."""

    LOOK_AROUND = auto()
    EXPLORE = auto()
    APPROACH = auto()
    VERIFY = auto()
    SECOND_LOOK = auto()
    END = auto()


class Phase(Protocol):
    """One phase of a search."""

    def act(self, step: Step) -> Decision | PhaseName:
        """Decide this step, or name the phase that has to."""
        ...


def turn_towards(robot: Pose2, point: tuple[float, float], motion: MotionConfig) -> Action | None:
    """The turn that brings a point ``(x, y)``, metres, ahead; None if it is as good as ahead."""
    bearing = robot.bearing_to(*point)
    if abs(bearing) <= math.radians(motion.turn_angle_deg) / 2 + 1e-6:
        return None
    return Action.TURN_LEFT if bearing > 0 else Action.TURN_RIGHT
