"""The plan of a search: where to, by which path, with how much patience left."""

import math
from dataclasses import dataclass, field, replace

from hypernav.core.embodiment import Action
from hypernav.core.events import Event
from hypernav.core.exploring.exploration import Chosen, Destination
from hypernav.core.exploring.insight import Insight
from hypernav.core.exploring.operator_place import OperatorPlace
from hypernav.core.exploring.overview import Block
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.agents.config import SearchConfig
from hypernav.search.agents.destinations import AnyDestination, arrival_m_of
from hypernav.search.mapping.stairs.connectors import Connector
from hypernav.search.planning.follower import Route
from hypernav.search.planning.navigator import Gap

Position = tuple[float, float]

_GAIN_M = 0.1
"""Least that counts as progress, metres: of a path that gets shorter, or of height on stairs."""
STANDS_M = 0.05
"""Way below which a robot stands, metres: odometry trembles."""
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
        steps: Number of steps towards the present destination so far.
    """

    limit: int
    steps: int = 0

    worn_out = Event.ENDURANCE_EXCEEDED

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
        shortest_m: Shortest length of the rest of the path so far, metres.
        longest_m: Longest length of it since `shortest_m` last fell, metres.
        steps: Number of steps since `shortest_m` last fell.
        planned: Largest number of planned actions since `shortest_m` last fell.
    """

    patience_steps: int
    shortest_m: float = math.inf
    longest_m: float = 0.0
    steps: int = 0
    planned: int = 0

    worn_out = Event.NO_PROGRESS

    def after(self, left_m: float, planned: int) -> "Progress":
        """The patience after one more step.

        Args:
            left_m: Length of the path that is left, metres.
            planned: Number of actions that are left of the sequence under way.
        """
        if left_m < self.shortest_m - _GAIN_M:
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


@dataclass(frozen=True)
class InVain:
    """A place from which no destination leads on.

    Attributes:
        position: Where it is ``(x, y)``, metres.
        turns: Number of steps in a row, turns on the spot, in which none did.
        why: Why the latest destination led nowhere.
    """

    position: Position
    turns: int
    why: str

    def is_at(self, robot: Pose2) -> bool:
        """Whether a robot still stands there."""
        return robot.distance_to(*self.position) < STANDS_M


@dataclass(frozen=True, eq=False)
class Exploring:
    """The part of the plan that leads to places where the goal may come into sight.

    Attributes:
        patience: Patience with the destination.
        destination: Present destination; None if there is none.
        route: Path to it.
        age: Number of steps and turns made for it.
        unasked: Steps since the explorer was asked, counted if it may be asked again on the way.
        in_vain: Where and why no destination led on; None once one does.
        expired: Destination dropped after its ``most_steps``; None once the explorer answered.
        left: Positions ``(x, y)``, metres, of destinations changed for others on the way.
        pursued: Positions ``(x, y)``, metres, of far sightings whose pursuit has ended.
        offered: Blocks offered to the explorer's reasoner in this step, for the trace.
        insight: What the explorer looked at in this step, for the trace.
    """

    patience: Progress | Endurance
    destination: AnyDestination | None = None
    route: Route = field(default_factory=Route)
    age: int = 0
    unasked: int = 0
    in_vain: InVain | None = None
    expired: Destination | None = None
    left: tuple[Position, ...] = ()
    pursued: tuple[Position, ...] = ()
    offered: tuple[Block, ...] = ()
    insight: Insight | None = None

    def towards(
        self, destination: AnyDestination, config: SearchConfig, *, left: tuple[Position, ...] = ()
    ) -> "Exploring":
        """The plan with a new destination; patience goes on if it is the expired one."""
        again = self.expired
        arrival_m = arrival_m_of(destination, config)
        is_same = again is not None and math.dist(again.xy, destination.xy) <= arrival_m
        chosen = destination if isinstance(destination, Chosen) else None
        return replace(
            self,
            destination=destination,
            expired=None,
            offered=chosen.blocks if chosen else (),
            insight=chosen.insight if chosen and chosen.insight else self.insight,
            unasked=0,
            age=self.age if is_same else 0,
            patience=self.patience if is_same else patience_of(config),
            left=left,
        )


@dataclass(frozen=True, eq=False)
class Opening:
    """A gap on the path to the goal that the robot looks at from near.

    Attributes:
        gap: The gap.
        route: Path to the position from which the robot looks at it.
        steps: Number of steps spent on it so far.
    """

    gap: Gap
    route: Route = field(default_factory=Route)
    steps: int = 0


@dataclass(frozen=True, eq=False)
class Approaching:
    """The part of the plan that leads to the goal.

    Attributes:
        candidate: Number of the candidate that it leads to; None if it leads to none.
        patience: Patience with this candidate.
        route: Path to the goal area, or to the position of the second look.
        inside: Path from right before the goal area into it (`SearchConfig.enter_fully`).
        rest_steps: Number of steps left for which the robot explores, because it was stuck.
        as_near_as_possible: Whether a path that ends before the goal area suffices: candidates come
            first (`SearchConfig.local_first`), all is explored, or the steps run out.
        steps_run_out: Whether the steps that are left only just lead to the candidate; then the
            nearest position that it was seen from suffices, too, if it is beside it.
        second_look: Position ``(x, y)``, metres, from which to look at the candidate from another
            side; None if no second look is under way.
        second_look_steps: Number of steps spent on the second look so far.
        opening: Gap that is looked at because no path leads to the goal; None if there is none.
        closed: Positions ``(x, y)``, metres, of gaps that were looked at and found closed.
        blocked_steps: Number of steps in which no path led into the goal area.
        sure_step: Number of the latest step in which the presence check at the goal area held; None
            if it does not hold.
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
        """Whether the path is blocked, but not for long yet: it may be by a person."""
        return 0 < self.blocked_steps <= config.patience_steps


@dataclass(frozen=True, eq=False)
class Climbing:
    """The part of the plan that leads over a connector to another floor.

    Attributes:
        connector: Number of the connector.
        is_back: Whether the robot has turned back on it.
        farthest_m: How far up it has come at most, or down on a way down: height in that
            direction, metres.
        steps: Number of steps and turns since it came that far.
        turned: Number of turns since stairs were last seen ahead.
        turning: Turn that it makes until its next step, since it has begun to turn to and fro, as
            where each heading shows another way; None if it has not.
        came_by: Where its steps began ``(x, y, z)``, metres.
        touching: Whether the robot has bumped into something and has not got away from it yet.
        from_front: Whether it goes onto the stairs from the front alone, since it has bumped into
            something before them.
        flight: The flight of stairs that it is on or goes to; None if it knows of none.
        looked: Where it turned all around on landings and saw no stairs ``(x, y)``, metres.
        then: Where the robot goes on the floor that it leads to; None leaves it to the explorer.
    """

    connector: int
    is_back: bool = False
    farthest_m: float = -math.inf
    steps: int = 0
    turned: int = 0
    turning: Action | None = None
    came_by: tuple[tuple[float, float, float], ...] = ()
    touching: bool = False
    from_front: bool = False
    flight: Connector | None = None
    looked: tuple[Position, ...] = ()
    then: Chosen | None = None

    def after_step(self, height_m: float) -> "Climbing":
        """The climb after one more step or turn.

        Args:
            height_m: Height of the robot in the direction in which it goes, metres.
        """
        if height_m > self.farthest_m + _GAIN_M:
            return replace(self, farthest_m=height_m, steps=0)
        return replace(self, steps=self.steps + 1)


@dataclass(frozen=True, eq=False)
class Sent:
    """The way to a place that the operator chose; it ends when there is no progress.

    Attributes:
        place: The place.
        patience: Patience with it.
        route: Path to it.
    """

    place: OperatorPlace
    patience: Progress
    route: Route = field(default_factory=Route)


@dataclass(frozen=True, eq=False)
class Plan:
    """What the robot intends. Every step replaces it; what the robot knows is in the memory.

    Attributes:
        exploring: Where to look for the goal.
        approaching: How to get to it.
        climbing: How to get over stairs to another floor; None if the robot is not on any.
        sent: Where the operator sends the robot; None if nowhere.
        turns_left: Number of turns that are left of the look around.
        full_turn: Whether that look makes all its turns, even those that show nothing unseen.
        last_scan_at: Position ``(x, y)``, metres, of the latest look around; None before.
        ends: Positions ``(x, y)``, metres, at which nothing was left to explore.
        ordered: Pose and action of the step before; None before the first.
        tried: Poses from which a step was cut short.
        is_recovering: Whether the robot gets free of what it touches.
    """

    exploring: Exploring
    approaching: Approaching
    climbing: Climbing | None = None
    sent: Sent | None = None
    turns_left: int = 0
    full_turn: bool = True
    last_scan_at: Position | None = None
    ends: tuple[Position, ...] = ()
    ordered: tuple[Pose2, Action] | None = None
    tried: tuple[Pose2, ...] = ()
    is_recovering: bool = False

    @staticmethod
    def at_start(config: SearchConfig, *, turns: int, then: Chosen | None = None) -> "Plan":
        """The first plan on a floor.

        Args:
            config: Conditions of the search.
            turns: Number of turns of the look around at the start.
            then: Destination on this floor for which the robot came; None if it came for none.
        """
        patience = patience_of(config)
        approaching = Approaching(patience, as_near_as_possible=config.local_first)
        full_turn = config.looks != "always"
        exploring = Exploring(patience, destination=then)
        return Plan(exploring, approaching, turns_left=turns, full_turn=full_turn)

    @property
    def destination(self) -> AnyDestination | None:
        """Present destination of exploration; None if there is none."""
        return self.exploring.destination

    def stands(self, robot: Pose2) -> bool:
        """Whether the robot is where its last action was ordered; also before the first one."""
        return self.ordered is None or self.ordered[0].distance_to(*robot.xy) < STANDS_M

    def sent_to(self, place: OperatorPlace | None, config: SearchConfig) -> "Plan":
        """The plan of a robot that is sent to a place, or to none any more."""
        if place == (self.sent and self.sent.place):
            return self
        sent = None if place is None else Sent(place, Progress(config.patience_steps))
        return replace(self.explore(destination=None), sent=sent)

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
        """The plan without destination and look around: local perception wins (paper)."""
        return replace(self.explore(destination=None), turns_left=0)
