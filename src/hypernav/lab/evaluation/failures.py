"""The classification of failed episodes by written rules.

The classes are finer than those of the paper's failure analysis: every one of them but outages
belongs to exactly one of these, by the paper's own definitions (`PaperFailure`). The evidence is
gathered from trace and ground truth by `hypernav.lab.evaluation.failure_evidence`. The rules
are applied in the order of `RULES`, and the first that holds decides; `report_text.RULES_IN_WORDS`
says them for people.

"What the robot took for the goal" is the object at its goal area when the episode ended. A robot
without a trace that stops is assumed to mean the object beside it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

from hypernav.core.episode import Outcome

MISPLACED_M = 1.0
"""Distance between a goal area and its object beyond which the map is at fault, metres."""


class PaperFailure(StrEnum):
    """Classes of the HyPerNav paper's failure analysis, by its definitions."""

    DETECTION = "detection"
    """False positives, due to poor viewpoints or limits of detection."""
    MAP_QUALITY = "map quality"
    """Missing RGB-D data in simulation, so that a wrong path is planned."""
    NOT_FOUND = "not found"
    """The robot fails to reach or observe the target within its steps."""
    TARGET_SURROUNDED = "target surrounded"
    """Obstacles enclose the goal area, so that no path is found."""
    PATH_PLANNING = "path planning"
    """A wrong path, or one that is not updated: position or goal area are mostly inaccurate."""
    LANGUAGE_UNDERSTANDING = "language understanding"
    """The robot finds an object of a similar name."""


class Failure(StrEnum):
    """Classes of failures."""

    FALSE_DETECTION = "false_detection"
    LANGUAGE = "language"
    WRONG_MAP = "wrong_map"
    TARGET_SURROUNDED = "target_surrounded"
    MISSING_DATA = "missing_data"
    SEEN_TOO_LATE = "seen_too_late"
    PATH_PLANNING = "path_planning"
    NEVER_SEEN = "never_seen"
    SEEN_BUT_MISSED = "seen_but_missed"
    STOPPED_TOO_FAR = "stopped_too_far"
    UNREACHABLE = "unreachable"
    MODEL_UNAVAILABLE = "model_unavailable"
    SIMULATOR_ERROR = "simulator_error"

    @property
    def is_apart(self) -> bool:
        """Whether the class says nothing about navigation and is excluded from all rates."""
        return self in (Failure.MODEL_UNAVAILABLE, Failure.SIMULATOR_ERROR)

    @property
    def words(self) -> str:
        """The name of the class for people."""
        words = self.value.replace("_", " ")
        return f"not found: {words}" if self.in_paper is PaperFailure.NOT_FOUND else words

    @property
    def in_paper(self) -> PaperFailure | None:
        """The class of the paper that it belongs to; None for outages, which the paper lacks."""
        return _IN_PAPER.get(self)

    @classmethod
    def _missing_(cls, value: object) -> "Failure | None":
        return cls.WRONG_MAP if value == "map_quality" else None  # in records of earlier versions


_IN_PAPER = {
    Failure.FALSE_DETECTION: PaperFailure.DETECTION,
    Failure.LANGUAGE: PaperFailure.LANGUAGE_UNDERSTANDING,
    Failure.MISSING_DATA: PaperFailure.MAP_QUALITY,
    Failure.TARGET_SURROUNDED: PaperFailure.TARGET_SURROUNDED,
    Failure.WRONG_MAP: PaperFailure.PATH_PLANNING,
    Failure.STOPPED_TOO_FAR: PaperFailure.PATH_PLANNING,
    Failure.PATH_PLANNING: PaperFailure.PATH_PLANNING,
    Failure.SEEN_TOO_LATE: PaperFailure.NOT_FOUND,
    Failure.SEEN_BUT_MISSED: PaperFailure.NOT_FOUND,
    Failure.NEVER_SEEN: PaperFailure.NOT_FOUND,
    Failure.UNREACHABLE: PaperFailure.NOT_FOUND,
}


class TargetKind(StrEnum):
    """What the object that the robot took for the goal really is."""

    GOAL = "the goal"
    NEAR_MISS = "a near miss"
    OTHER = "something else"


@dataclass(frozen=True)
class BelievedTarget:
    """The object that the robot took for the goal when the episode ended.

    Attributes:
        kind: What the object really is.
        name: Name of the object, for people.
        offset_m: Horizontal distance of the goal area's middle to the object's box, metres.
        is_surrounded: Whether in truth there is no position to stand within the stop distance.
        map_leads_there: Whether the robot's map has a path to within the stop distance; None if it
            has no map.
        lacks_data: Whether that path leads where nobody can really stand, and images lacked data.
        short_m: Length by which the shortest path from where the robot began to believe in it was
            longer than its steps since then; 0 or less where they were enough.
    """

    kind: TargetKind
    name: str
    offset_m: float = 0.0
    is_surrounded: bool = False
    map_leads_there: bool | None = None
    lacks_data: bool = False
    short_m: float = 0.0


@dataclass(frozen=True)
class Facts:
    """The evidence about an episode that the rules look at.

    Attributes:
        outcome: How the episode ended.
        stopped: Whether the robot took STOP.
        gave_up: Whether the robot gave up.
        distance_to_goal_m: Geodesic distance to the nearest view point at the end, metres.
        success_distance_m: Greatest distance that counts as success, metres.
        goal_sightings: Number of steps in which the goal was in the image.
        target: The object that the robot took for the goal at the end; None if there was none.
        error: Message of the outage or of the simulator's error; empty if there was none.
    """

    outcome: Outcome
    stopped: bool = False
    gave_up: bool = False
    distance_to_goal_m: float = 0.0
    success_distance_m: float = 0.1
    goal_sightings: int = 0
    target: BelievedTarget | None = None
    error: str = ""

    @property
    def correct_target(self) -> BelievedTarget | None:
        """The object that the robot took for the goal if it really was the goal, else None."""
        is_goal = self.target is not None and self.target.kind is TargetKind.GOAL
        return self.target if is_goal else None

    @property
    def ending(self) -> str:
        """How the episode ended, for people."""
        if self.stopped:
            return "it stopped"
        return "it gave up" if self.gave_up else "it ran out of steps"


@dataclass(frozen=True)
class Verdict:
    """The class of a failure, and the rule's reason in a sentence."""

    failure: Failure
    why: str


def classify(facts: Facts) -> Verdict | None:
    """The class of an episode's failure; None for a success."""
    if facts.outcome is Outcome.FOUND:
        return None
    for failure, rule in RULES:
        if (why := rule(facts)) is not None:
            return Verdict(failure, why)
    raise AssertionError("the last rule always holds")


def _model_unavailable(facts: Facts) -> str | None:
    return facts.error if facts.outcome is Outcome.MODEL_UNAVAILABLE else None


def _simulator_error(facts: Facts) -> str | None:
    return facts.error if facts.outcome is Outcome.SIMULATOR_ERROR else None


def _unreachable(facts: Facts) -> str | None:
    if facts.outcome is not Outcome.UNREACHABLE:
        return None
    return "no path leads from the start to the goal"


def _language(facts: Facts) -> str | None:
    target = facts.target
    if target is None or target.kind is not TargetKind.NEAR_MISS:
        return None
    return f"it took the {target.name}, a near miss by name, for the goal; {facts.ending}"


def _false_detection(facts: Facts) -> str | None:
    target = facts.target
    if target is None or target.kind is not TargetKind.OTHER:
        return None
    return f"it took the {target.name} for the goal; {facts.ending}"


def _wrong_map(facts: Facts) -> str | None:
    target = facts.correct_target
    if target is None:
        return None
    if target.offset_m > MISPLACED_M:
        return f"its goal area lay {target.offset_m:.1f} m beside the {target.name}"
    if not facts.stopped and target.map_leads_there is False and not target.is_surrounded:
        return f"its map showed no path to the {target.name}, though there is one; {facts.ending}"
    return None


def _target_surrounded(facts: Facts) -> str | None:
    target = facts.correct_target
    if target is None or not target.is_surrounded:
        return None
    return f"no position near its goal area on the {target.name} can be stood on; {facts.ending}"


def _stopped_too_far(facts: Facts) -> str | None:
    target = facts.correct_target
    if target is None or not facts.stopped:
        return None
    return (
        f"it stopped at the {target.name}, {facts.distance_to_goal_m:.2f} m from where "
        f"it counts as reached (within {facts.success_distance_m:g} m)"
    )


def _missing_data(facts: Facts) -> str | None:
    target = facts.correct_target
    if target is None or not target.lacks_data:
        return None
    return (
        f"the path on its map to the {target.name} leads where nobody can stand, and its images "
        f"lacked data; {facts.ending}"
    )


def _seen_too_late(facts: Facts) -> str | None:
    target = facts.correct_target
    if target is None or facts.gave_up or target.short_m <= facts.success_distance_m:
        return None
    return (
        f"when it took the {target.name} for the goal, rightly, the shortest path was "
        f"{target.short_m:.1f} m longer than its steps; {facts.ending}"
    )


def _path_planning(facts: Facts) -> str | None:
    if facts.correct_target is None:
        return None
    return (
        f"it took the {facts.correct_target.name} for the goal, rightly, and {facts.ending} "
        f"{facts.distance_to_goal_m:.2f} m away from it"
    ).replace("and it ", "and ")


def _seen_but_missed(facts: Facts) -> str | None:
    if facts.goal_sightings == 0:
        return None
    steps = "step" if facts.goal_sightings == 1 else "steps"
    return f"the goal was in the image in {facts.goal_sightings} {steps}; {facts.ending} without it"


def _never_seen(facts: Facts) -> str:
    return f"the goal was never in the image; {facts.ending}"


RULES: tuple[tuple[Failure, Callable[[Facts], str | None]], ...] = (
    (Failure.MODEL_UNAVAILABLE, _model_unavailable),
    (Failure.SIMULATOR_ERROR, _simulator_error),
    (Failure.UNREACHABLE, _unreachable),
    (Failure.LANGUAGE, _language),
    (Failure.FALSE_DETECTION, _false_detection),
    (Failure.WRONG_MAP, _wrong_map),
    (Failure.TARGET_SURROUNDED, _target_surrounded),
    (Failure.STOPPED_TOO_FAR, _stopped_too_far),
    (Failure.MISSING_DATA, _missing_data),
    (Failure.SEEN_TOO_LATE, _seen_too_late),
    (Failure.PATH_PLANNING, _path_planning),
    (Failure.SEEN_BUT_MISSED, _seen_but_missed),
    (Failure.NEVER_SEEN, _never_seen),
)
"""The classes with their rules, in the order in which they are applied."""
