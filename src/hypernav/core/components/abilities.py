"""Optional abilities of components, besides their protocols."""

from collections.abc import Collection, Mapping, Sequence
from inspect import getattr_static, signature
from typing import Any, Protocol, TypeGuard, runtime_checkable

import numpy as np
from jaxtyping import Bool

from hypernav.core.components.protocols import Agent, Remembers
from hypernav.core.config import Curve
from hypernav.core.embodiment import Embodiment
from hypernav.core.errors import ConfigError
from hypernav.core.exploring.exploration import ExplorationView
from hypernav.core.exploring.floors import SeenThing
from hypernav.core.exploring.operator_place import OperatorPlace
from hypernav.core.geometry.boxes import Detection
from hypernav.core.geometry.closed_area import ClosedArea
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.score_weights import MISSED

_MISSING = object()


@runtime_checkable
class BuiltForRobot(Protocol):
    """An agent that only drives the robot that it was built for."""

    @property
    def embodiment(self) -> Embodiment:
        """What that robot is."""
        ...


@runtime_checkable
class BeginsMemory(Protocol):
    """An agent that learns more where it is told that its memory will last."""

    def new_memory(self) -> Any:
        """An empty memory, for the first of several searches."""
        ...


@runtime_checkable
class PlansSteps(Protocol):
    """An agent that plans with the steps that it has, for example for a last chance."""

    def allow_steps(self, most: int) -> None:
        """Tell it how many steps its next searches have at most; called before `reset`."""
        ...


@runtime_checkable
class KeepsOut(Protocol):
    """An agent that can be told during a search where its robot is not to go."""

    def keep_out_of(self, areas: Sequence[ClosedArea]) -> None:
        """Enter none of these areas from the next `act` on; those of before count no longer.

        Args:
            areas: All areas of all floors, in the ``map`` frame of the search.
        """
        ...


@runtime_checkable
class GoesWhereSent(Protocol):
    """An agent that can be sent to a place during a search.

    From the next `act` on it drives there instead of to a destination of its own. Its trace says by
    `PlaceState.event` when that has ended; then the search goes on by itself.
    """

    def go_to(self, place: OperatorPlace | None) -> None:
        """Go to this place, and no longer to another; the same one again changes nothing.

        Args:
            place: The place, in the ``map`` frame of the search; None to go on searching.
        """
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
    """A component that counts something for the results."""

    def take_report(self) -> dict[str, Any]:
        """Counts since the last call, as JSON values; all counts are reset."""
        ...


@runtime_checkable
class Closes(Protocol):
    """A component that holds a thread, a process or a file."""

    def close(self) -> None:
        """Release it; the component is not used afterwards."""
        ...


@runtime_checkable
class Learns(Protocol):
    """An explorer that learns from every image, not only from those at which it is asked."""

    def learn(self, view: ExplorationView) -> None:
        """Note in `ExplorationView.notes` what the present image tells; called at every step."""
        ...


@runtime_checkable
class SegmentsPoints(Protocol):
    """A segmenter that needs no box: a point on the object is enough."""

    def segment_point(
        self, observation: Observation, x: float, y: float
    ) -> Bool[np.ndarray, "height width"]:
        """Mask of the object at a point of the image, pixels; all False if there is none."""
        ...


@runtime_checkable
class NamesThings(Protocol):
    """A detector that can name whatever is in an image, not only the goal."""

    def name_things(
        self, observation: Observation, *, besides: Collection[int]
    ) -> Mapping[int, SeenThing]:
        """Things with their positions, by permanent numbers; only those not yet named."""
        ...


@runtime_checkable
class SeesAllThings(Protocol):
    """A detector that finds, at no extra cost, all things in an image that it has names for."""

    def things_in(
        self, observation: Observation, detections: Sequence[Detection]
    ) -> list[Detection]:
        """All things in an image, the goal included.

        Args:
            observation: The image.
            detections: What `detect` found in it.
        """
        ...


def remembers(agent: Agent) -> TypeGuard[Remembers]:
    """Whether an agent keeps what it knows of a building, asked also before its first search.

    It has an attribute ``memory``, and its ``reset`` takes one: an attribute of that name alone may
    be anything of its own.
    """
    if getattr_static(agent, "memory", _MISSING) is _MISSING:
        return False
    try:
        signature(agent.reset).bind(None, None)
    except TypeError:
        return False
    except ValueError:  # compiled code may have no signature
        return True
    return True


def check_remembers(agent: Agent) -> None:
    """Refuse to give a memory to an agent that has no use for one.

    Raises:
        ConfigError: It keeps no memory.
    """
    if not remembers(agent):
        raise ConfigError(
            f"{type(agent).__name__} keeps no memory of a building: it lacks an attribute memory "
            "or a reset(goal, memory); use an agent that searches on a map, such as hypernav or "
            "frontier, or leave the memory out"
        )


def looks_at_colours(component: object) -> bool:
    """Whether a component uses the colours of an image; True unless it says otherwise.

    A simulated world need not draw colours that nothing uses: drawing is most of its work.
    """
    return bool(getattr(component, "looks_at_colours", True))


def warning_of(component: object) -> str:
    """A component's warning for people before a search; empty if there is none."""
    return str(getattr(component, "warning", ""))


def wants_named_things(explorer: object) -> bool:
    """Whether an explorer says that it uses whatever the detector can name in the images."""
    return bool(getattr(explorer, "wants_named_things", False))


def gives_masks(detector: object) -> bool:
    """Whether a detector, or its class, says that all its detections carry their masks."""
    return bool(getattr(detector, "gives_masks", False))


def looks_closer(detector: object) -> bool:
    """Whether a detector's score in an enlarged part of the image is further evidence.

    So it is with networks, and taken to be with every detector that says nothing else. A stand-in's
    errors know nothing of enlargement.
    """
    return bool(getattr(detector, "looks_closer", True))


def score_weights_of(detector: object) -> Curve:
    """What a detector's scores are worth, as it says; empty if it doesn't (`score_weights`)."""
    return tuple(getattr(detector, "score_weights", ()))


def missed_weight_of(detector: object) -> float:
    """What it is worth that a detector doesn't see a candidate (`hypernav.core.score_weights`)."""
    return float(getattr(detector, "missed_weight", MISSED))


def answers_at_once(component: object) -> bool:
    """Whether a component says that a question takes only milliseconds and costs nothing.

    It may then be asked repeatedly on the way, as new things come into view.
    """
    return bool(getattr(component, "answers_at_once", False))
