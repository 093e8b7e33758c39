"""The plan of a search: where to, by which path, with how much patience left."""

import math
from dataclasses import dataclass, field, replace

from hypernav.agents.config import SearchConfig
from hypernav.core.actions import Action
from hypernav.core.exploring.exploration import Destination
from hypernav.core.exploring.insight import Insight
from hypernav.core.exploring.overview import Block
from hypernav.core.geometry.transforms import Pose2
from hypernav.planning.gaps import Gap
from hypernav.planning.route import Route

Position = tuple[float, float]

_STEP_M = 0.1
"""Smallest shortening of the path that counts as progress."""
_DETOUR_STEPS_PER_M = 4
"""Number of steps and turns granted per metre of a detour."""


def patience_of(config: SearchConfig) -> "Progress | Endurance":
    """The patience that a search has with a new destination."""
    if config.give_up_when_stuck:
        return Progress(config.patience_steps)
    return Endurance(config.endurance_steps)


@dataclass(frozen=True)
class Endurance:
    """Grants every destination the same number of steps (paper: endurance limit).

    Attributes:
        limit: Number of steps for each destination.
        steps: Number of steps so far.
    """

    limit: int
    steps: int = 0

    worn_out = "endurance exceeded"

    def after(self, left_m: float, planned: int) -> "Endurance":
        """The patience after one more step; see `Progress.after`."""
        return replace(self, steps=self.steps + 1)

    @property
    def lasts(self) -> bool:
        """Whether the destination may be kept."""
        return self.steps <= self.limit


@dataclass(frozen=True)
class Progress:
    """Notices a robot that goes to and fro, or stands still, instead of coming nearer.

    It is the path that must get shorter: a robot that drives around a wall gets farther away in a
    straight line. If the path turns out to be longer, the steps of that detour are granted, and so
    are the turns of a robot that shunts its way through a gap.

    Attributes:
        patience_steps: Number of steps that may bring the robot no nearer, on top of those of a
            detour and of a planned sequence of actions.
        shortest_m: Length of the shortest path that was left so far, metres.
        longest_m: Length of the longest since then, metres.
        steps: Number of steps since then.
        planned: Largest number of planned actions since then.
    """

    patience_steps: int
    shortest_m: float = math.inf
    longest_m: float = 0.0
    steps: int = 0
    planned: int = 0

    worn_out = "no progress to destination"

    def after(self, left_m: float, planned: int) -> "Progress":
        """The patience after one more step.

        Args:
            left_m: Length of the path that is left, metres.
            planned: Number of actions that are left of the sequence under way.
        """
        if left_m < self.shortest_m - _STEP_M:
            return Progress(self.patience_steps, left_m, left_m)
        return replace(
            self,
            longest_m=max(self.longest_m, left_m),
            steps=self.steps + 1,
            planned=max(self.planned, planned),
        )

    @property
    def lasts(self) -> bool:
        """Whether the robot still makes progress."""
        detour_m = max(self.longest_m - self.shortest_m, 0.0)
        granted = self.planned + _DETOUR_STEPS_PER_M * detour_m
        return self.steps <= self.patience_steps + granted


@dataclass(frozen=True, eq=False)
class Exploring:
    """The part of the plan that leads to places where the goal may come into sight.

    Attributes:
        patience: Patience with the destination.
        destination: Present destination; None if there is none.
        route: Path to it.
        age: Number of steps with it.
        unasked: Number of steps since the explorer was asked.
        expired: Destination whose steps are over, until the explorer has been asked again.
        left: Destinations that were left for another since the last one that ended.
        pursued: Positions to which far sightings of the goal were followed.
        offered: Blocks of the map question of this step.
        insight: What the explorer looked at in this step.
    """

    patience: Progress | Endurance
    destination: Destination | None = None
    route: Route = field(default_factory=Route)
    age: int = 0
    unasked: int = 0
    expired: Destination | None = None
    left: tuple[Position, ...] = ()
    pursued: tuple[Position, ...] = ()
    offered: tuple[Block, ...] = ()
    insight: Insight | None = None

    def towards(
        self, destination: Destination, config: SearchConfig, *, left: tuple[Position, ...]
    ) -> "Exploring":
        """The plan with a destination of the explorer; the same as before keeps its patience."""
        again = self.expired
        arrival_m = destination.arrival_m or config.arrival_distance_m
        is_same = again is not None and math.dist(again.xy, destination.xy) <= arrival_m
        return replace(
            self,
            destination=destination,
            expired=None,
            offered=destination.blocks,
            insight=destination.insight or self.insight,
            unasked=0,
            age=self.age if is_same else 0,
            patience=self.patience if is_same else patience_of(config),
            left=left,
        )


@dataclass(frozen=True, eq=False)
class Opening:
    """A gap on the way to the goal that the robot looks at from near.

    Attributes:
        gap: The gap.
        route: Path to where it is looked at from.
        steps: Number of steps so far.
    """

    gap: Gap
    route: Route = field(default_factory=Route)
    steps: int = 0


@dataclass(frozen=True, eq=False)
class Approaching:
    """The part of the plan that leads to the goal.

    Attributes:
        candidate: Number of the candidate that it leads to; None if it leads to none.
        patience: Patience with the target.
        route: Path to the goal area.
        inside: Path of the last step, into the goal area.
        rest_steps: Number of steps for which the robot explores, because it was stuck.
        as_near_as_possible: Whether the end of the nearest path must suffice, because the goal
            comes first or because everything else is explored.
        steps_run_out: Whether the steps that are left just lead to the goal: the nearest position
            that it was seen from will do.
        second_look: Position from which to look at the target from another side; None if no second
            look is under way.
        second_look_steps: Number of its steps.
        opening: Gap that is looked at because no path leads to the goal; None if there is none.
        closed: Positions of the gaps that were looked at, and are closed.
        blocked_steps: Number of steps in which no path led into the goal area.
        sure_step: Number of the step in which the check at the goal area said yes, or of the latest
            move nearer after it; None if it has not.
    """

    patience: Progress | Endurance
    candidate: int | None = None
    route: Route = field(default_factory=Route)
    inside: Route = field(default_factory=Route)
    rest_steps: int = 0
    as_near_as_possible: bool = False
    steps_run_out: bool = False
    second_look: Position | None = None
    second_look_steps: int = 0
    opening: Opening | None = None
    closed: tuple[Position, ...] = ()
    blocked_steps: int = 0
    sure_step: int | None = None

    def may_clear(self, config: SearchConfig) -> bool:
        """Whether what blocks the way has not stood there for long: it may be a person."""
        return 0 < self.blocked_steps <= config.patience_steps


@dataclass(frozen=True, eq=False)
class Plan:
    """What the robot intends. Every step replaces it; what the robot knows is in the memory.

    Attributes:
        exploring: Where to look for the goal.
        approaching: How to get to it.
        turns_left: Number of turns that are left of a turn around.
        full_turn: Whether it is a full circle, whatever it shows.
        looked_around_at: Position of the latest turn around; None if there was none.
        ends: Positions at which nothing was left to explore.
        ordered: Pose and action of the step before; None before the first.
    """

    exploring: Exploring
    approaching: Approaching
    turns_left: int = 0
    full_turn: bool = True
    looked_around_at: Position | None = None
    ends: tuple[Position, ...] = ()
    ordered: tuple[Pose2, Action] | None = None

    @staticmethod
    def at_start(config: SearchConfig, *, turns: int) -> "Plan":
        """The first plan on a floor.

        Args:
            config: Conditions of the search.
            turns: Number of turns to begin with.
        """
        patience = patience_of(config)
        approaching = Approaching(patience, as_near_as_possible=config.local_first)
        full_turn = config.looks != "always"
        return Plan(Exploring(patience), approaching, turns_left=turns, full_turn=full_turn)

    @property
    def destination(self) -> Destination | None:
        """Present destination of exploration."""
        return self.exploring.destination

    def explore(self, **changes: object) -> "Plan":
        """The plan with some values of its exploration replaced."""
        return replace(self, exploring=replace(self.exploring, **changes))

    def approach(self, **changes: object) -> "Plan":
        """The plan with some values of its approach replaced."""
        return replace(self, approaching=replace(self.approaching, **changes))

    def with_new_patience(self, config: SearchConfig) -> "Plan":
        """The plan whose next approach begins with new patience."""
        return self.approach(patience=patience_of(config))

    def without_exploration(self) -> "Plan":
        """The plan of a robot that goes to the goal: local perception wins (paper)."""
        return replace(self.explore(destination=None), turns_left=0)
