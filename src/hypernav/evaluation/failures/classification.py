"""Why an episode failed, decided by written rules.

The classes are those of the paper's failure analysis. What the rules look at is gathered from trace
and truth by `hypernav.evaluation.failures.failure_evidence`. They are asked in the order in which
they stand in `RULES`, and the first that holds decides:

=================== ============================================================================
model unavailable   A model stayed away for longer than the patience. Apart: not counted.
simulator error     The world, or the process that ran it, failed. Apart: not counted.
unreachable         The scene holds the goal, but no way leads there from the start.
language            What the robot took for the goal comes near it by name: a shower curtain for a
                    window curtain.
false detection     What it took for the goal is neither the goal nor near it by name.
map quality         It took the goal for the goal, but its map is wrong: the goal area lies more
                    than `MISPLACED_M` beside the object; or the map closes off what is open.
target surrounded   It took the goal for the goal, but around the goal area there is no place where
                    a robot could stand within its stop distance.
stopped too far     It took the goal for the goal and stopped, but beyond the success distance.
path planning       It took the goal for the goal and its map has a way there, but it didn't arrive.
seen but missed     The goal was in the image, but the robot ended without a goal area.
never seen          The goal was never in the image.
=================== ============================================================================

"What the robot took for the goal" is the goal area that it held when the episode ended; a robot
that explains nothing and stops is taken to mean the thing beside it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

from hypernav.core.episode import Outcome

MISPLACED_M = 1.0
"""A goal area this far beside the object that gave it is the map's fault."""


class Failure(StrEnum):
    """Why an episode failed."""

    FALSE_DETECTION = "false_detection"
    LANGUAGE = "language"
    MAP_QUALITY = "map_quality"
    TARGET_SURROUNDED = "target_surrounded"
    PATH_PLANNING = "path_planning"
    NEVER_SEEN = "never_seen"
    SEEN_BUT_MISSED = "seen_but_missed"
    STOPPED_TOO_FAR = "stopped_too_far"
    UNREACHABLE = "unreachable"
    MODEL_UNAVAILABLE = "model_unavailable"
    SIMULATOR_ERROR = "simulator_error"

    @property
    def is_apart(self) -> bool:
        """Whether it says nothing about navigation and is left out of all rates."""
        return self in (Failure.MODEL_UNAVAILABLE, Failure.SIMULATOR_ERROR)

    @property
    def words(self) -> str:
        """For people."""
        return _WORDS.get(self, self.value.replace("_", " "))


_WORDS = {
    Failure.NEVER_SEEN: "not found: never seen",
    Failure.SEEN_BUT_MISSED: "not found: seen but missed",
}


class Belief(StrEnum):
    """What that which the robot took for the goal really is."""

    GOAL = "the goal"
    NEAR_MISS = "a near miss"
    OTHER = "something else"


@dataclass(frozen=True)
class Held:
    """What the robot took for the goal when the episode ended.

    Attributes:
        belief: What it really is.
        name: Of the object, for people.
        offset_m: From the middle of the goal area to the object's box, horizontally.
        is_surrounded: Whether in truth no place within the stop distance can be stood on.
        map_leads_there: Whether the robot's map has a way to within the stop distance; None if it
            has no map.
    """

    belief: Belief
    name: str
    offset_m: float = 0.0
    is_surrounded: bool = False
    map_leads_there: bool | None = None


@dataclass(frozen=True)
class Facts:
    """All that the rules look at.

    Attributes:
        outcome: How the episode ended.
        stopped: Whether the robot said that it is there.
        gave_up: Whether it said that nothing is left to explore.
        distance_to_goal_m: Geodesic, at the end.
        success_distance_m: What would have been near enough.
        sights: Steps in which the goal was in the image.
        held: What it took for the goal at the end; None if nothing.
        trouble: What broke, if something did.
    """

    outcome: Outcome
    stopped: bool = False
    gave_up: bool = False
    distance_to_goal_m: float = 0.0
    success_distance_m: float = 0.1
    sights: int = 0
    held: Held | None = None
    trouble: str = ""

    @property
    def held_goal(self) -> Held | None:
        """The same, if it was the goal."""
        return self.held if self.held is not None and self.held.belief is Belief.GOAL else None

    @property
    def ending(self) -> str:
        """How it ended, for people."""
        if self.stopped:
            return "it stopped"
        return "it gave up" if self.gave_up else "it ran out of steps"


@dataclass(frozen=True)
class Verdict:
    """Why an episode failed, and the rule's reason in a sentence."""

    failure: Failure
    why: str


def classify(facts: Facts) -> Verdict | None:
    """Why an episode failed; None for a success."""
    if facts.outcome is Outcome.FOUND:
        return None
    for failure, rule in RULES:
        if (why := rule(facts)) is not None:
            return Verdict(failure, why)
    raise AssertionError("the last rule always holds")


def _model_unavailable(facts: Facts) -> str | None:
    return facts.trouble if facts.outcome is Outcome.MODEL_UNAVAILABLE else None


def _simulator_error(facts: Facts) -> str | None:
    return facts.trouble if facts.outcome is Outcome.SIMULATOR_ERROR else None


def _unreachable(facts: Facts) -> str | None:
    if facts.outcome is not Outcome.UNREACHABLE:
        return None
    return "no way leads from the start to the goal"


def _language(facts: Facts) -> str | None:
    held = facts.held
    if held is None or held.belief is not Belief.NEAR_MISS:
        return None
    return f"it took the {held.name}, a near miss by name, for the goal; {facts.ending}"


def _false_detection(facts: Facts) -> str | None:
    held = facts.held
    if held is None or held.belief is not Belief.OTHER:
        return None
    return f"it took the {held.name} for the goal; {facts.ending}"


def _map_quality(facts: Facts) -> str | None:
    held = facts.held_goal
    if held is None:
        return None
    if held.offset_m > MISPLACED_M:
        return f"its goal area lay {held.offset_m:.1f} m beside the {held.name}"
    if not facts.stopped and held.map_leads_there is False and not held.is_surrounded:
        return f"its map showed no way to the {held.name}, though there is one; {facts.ending}"
    return None


def _target_surrounded(facts: Facts) -> str | None:
    held = facts.held_goal
    if held is None or not held.is_surrounded:
        return None
    return f"no place near its goal area on the {held.name} can be stood on; {facts.ending}"


def _stopped_too_far(facts: Facts) -> str | None:
    if facts.held_goal is None or not facts.stopped:
        return None
    return (
        f"it stopped at the {facts.held_goal.name}, {facts.distance_to_goal_m:.2f} m from where "
        f"it counts as reached (within {facts.success_distance_m:g} m)"
    )


def _path_planning(facts: Facts) -> str | None:
    if facts.held_goal is None:
        return None
    return (
        f"it held the {facts.held_goal.name} for the goal, rightly, and {facts.ending} "
        f"{facts.distance_to_goal_m:.2f} m away from it"
    ).replace("and it ", "and ")


def _seen_but_missed(facts: Facts) -> str | None:
    if facts.sights == 0:
        return None
    steps = "step" if facts.sights == 1 else "steps"
    return f"the goal was in the picture in {facts.sights} {steps}; {facts.ending} without it"


def _never_seen(facts: Facts) -> str:
    return f"the goal was never in the picture; {facts.ending}"


RULES: tuple[tuple[Failure, Callable[[Facts], str | None]], ...] = (
    (Failure.MODEL_UNAVAILABLE, _model_unavailable),
    (Failure.SIMULATOR_ERROR, _simulator_error),
    (Failure.UNREACHABLE, _unreachable),
    (Failure.LANGUAGE, _language),
    (Failure.FALSE_DETECTION, _false_detection),
    (Failure.MAP_QUALITY, _map_quality),
    (Failure.TARGET_SURROUNDED, _target_surrounded),
    (Failure.STOPPED_TOO_FAR, _stopped_too_far),
    (Failure.PATH_PLANNING, _path_planning),
    (Failure.SEEN_BUT_MISSED, _seen_but_missed),
    (Failure.NEVER_SEEN, _never_seen),
)
"""The classes with their rules, in the order in which they are asked."""
