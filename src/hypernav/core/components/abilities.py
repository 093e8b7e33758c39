"""Optional abilities of components beside their protocol: asked for, never demanded."""

from collections.abc import Collection, Mapping, Sequence
from typing import Any, Protocol, runtime_checkable

from hypernav.core.destination import Destination
from hypernav.core.embodiment import Embodiment
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.insight import Insight
from hypernav.core.observation import Observation
from hypernav.core.sightings import SeenThing


@runtime_checkable
class BuiltForRobot(Protocol):
    """An agent that only drives the robot that it was built for."""

    @property
    def embodiment(self) -> Embodiment:
        """What that robot is."""
        ...


@runtime_checkable
class ChecksGoal(Protocol):
    """A component that knows which goals it can't find, a detector of fixed classes for example."""

    def check_goal(self, goal: Goal) -> object:
        """Refuse a goal before the search begins.

        Raises:
            GoalError: The goal can never be seen; the message says which goals can.
        """
        ...


@runtime_checkable
class ChecksModel(Protocol):
    """A component that can't work with every chat model."""

    def check_model(self) -> object:
        """Refuse the model before the search begins, if its name is known without asking it.

        Raises:
            ConfigError: The model can't be used; the message says what to configure.
        """
        ...


@runtime_checkable
class Reports(Protocol):
    """A component that keeps counts for the results."""

    def take_report(self) -> dict[str, Any]:
        """Counts since the last call, as JSON values; counting begins anew."""
        ...


@runtime_checkable
class Closes(Protocol):
    """A component that holds a thread, a process or a file."""

    def close(self) -> None:
        """Release it; the component isn't used again."""
        ...


@runtime_checkable
class Prefetches(Protocol):
    """An explorer that can choose the next destination while the robot drives to this one."""

    def prefetch(
        self,
        grid: OccupancyGrid,
        robot: Pose2,
        trajectory: Sequence[tuple[float, float]],
        destination: Destination,
    ) -> None:
        """Begin to choose, if it is time; called at every step of the path to a destination."""
        ...


@runtime_checkable
class Watches(Protocol):
    """An explorer that looks at images itself, not only at the map that is drawn from them."""

    def watch(self, observation: Observation, grid: OccupancyGrid) -> None:
        """Look at the image of a step; called at every step, before anything is decided in it.

        Args:
            observation: Frame of this step.
            grid: The map with this frame in it, which changes with the next one.
        """
        ...


@runtime_checkable
class Explains(Protocol):
    """An explorer that can show what it looked at when it chose."""

    def take_insight(self) -> Insight | None:
        """What it looked at since the last call; None if it made no choice."""
        ...


@runtime_checkable
class NamesThings(Protocol):
    """A detector that can name whatever is in an image, not only the goal."""

    def name_things(
        self, observation: Observation, *, besides: Collection[int]
    ) -> Mapping[int, SeenThing]:
        """Things with their positions, by numbers that stay theirs; only those not yet named."""
        ...


def looks_at_colours(component: object) -> bool:
    """Whether a component uses the colours of an image; one that doesn't says so.

    A simulated world need not draw colours that nobody looks at: drawing is most of its work.
    """
    return bool(getattr(component, "looks_at_colours", True))


def warning_of(component: object) -> str:
    """What a component says of itself that people must know before a search; empty if nothing."""
    return str(getattr(component, "warning", ""))


def gives_masks(detector: object) -> bool:
    """Whether a detector, or its class, says that all its detections carry their masks."""
    return bool(getattr(detector, "gives_masks", False))


def answers_at_once(component: object) -> bool:
    """Whether a component says that a question costs it a few milliseconds, and no money.

    It may then be asked again and again on the way, as new things come into view.
    """
    return bool(getattr(component, "answers_at_once", False))
