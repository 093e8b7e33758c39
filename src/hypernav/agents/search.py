"""The search that the agents of this package share; they differ in their explorers."""

from collections.abc import Callable
from dataclasses import dataclass

from hypernav.agents.config import SearchConfig
from hypernav.agents.floors import Floor, Floors
from hypernav.agents.phases.approach import Approach
from hypernav.agents.phases.end import End
from hypernav.agents.phases.explore import Explore
from hypernav.agents.phases.gaze import Gaze
from hypernav.agents.phases.look_around import LookAround
from hypernav.agents.phases.second_look import SecondLook
from hypernav.agents.phases.step import Decision, Phase, PhaseName, Step
from hypernav.agents.phases.verify import Verify
from hypernav.core.actions import Action
from hypernav.core.clock import ModuleClock
from hypernav.core.components.abilities import Explains, Watches
from hypernav.core.components.protocols import Explorer, PresenceCheck
from hypernav.core.embodiment import Embodiment
from hypernav.core.errors import WorldError
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import DetectionRecord, ExchangeLog, Mode, StepTrace
from hypernav.mapping.top_down_map import TopDownMap
from hypernav.perception.local.local_perception import LocalPerception
from hypernav.planning.bump_sensor import BumpSensor
from hypernav.planning.config import PlanningConfig
from hypernav.planning.navigator import Navigator


@dataclass(frozen=True, eq=False)
class SearchComponents:
    """The components of a search; `hypernav.build` puts them together from a configuration.

    Attributes:
        new_map: Function that makes an empty map.
        local: Local perception: finds the goal in images and on the floor plan.
        explorer: Explorer: chooses destinations while the goal is out of sight.
        planning: Configuration of planning and path following.
        embodiment: Body, camera, step and turn of the robot.
        presence: Presence check before STOP; None trusts the goal area.
        log: Log of the questions to detectors and reasoners, for the trace.
        config: Configuration of the search.
    """

    new_map: Callable[[], TopDownMap]
    local: LocalPerception
    explorer: Explorer
    planning: PlanningConfig
    embodiment: Embodiment
    presence: PresenceCheck | None
    log: ExchangeLog
    config: SearchConfig


class SearchAgent:
    """Builds a map, looks for the goal, explores while it is out of sight, stops at it."""

    def __init__(self, components: SearchComponents) -> None:
        """Begin with no search under way."""
        self._components = components
        self._floors: Floors | None = None
        self._search: _Search | None = None

    @property
    def components(self) -> SearchComponents:
        """What the search is made of, for those who use a part of it."""
        return self._components

    @property
    def embodiment(self) -> Embodiment:
        """What the robot is that the agent was built for."""
        return self._components.embodiment

    def reset(self, goal: Goal) -> None:
        """Forget everything and begin a new search."""
        self._floors = Floors(self._components.new_map, self._components.embodiment)
        self._search = _Search(goal, self._components, self._floors.current)

    def act(self, observation: Observation) -> Action | None:
        """Look, decide, and say what to do next; None gives up.

        On another floor of the building the search goes on with a map of its own.
        """
        search = self._running
        floor = search.floor if self._floors is None else self._floors.follow(observation)
        if floor is not search.floor:
            search = self._search = search.on(floor)
        return search.act(floor.seen_from(observation))

    @property
    def last_step(self) -> StepTrace:
        """The trace of the latest `act`."""
        trace = self._running.trace
        if trace is None:
            raise WorldError("the agent has not acted yet; call reset(goal), then act(observation)")
        return trace

    @property
    def grid(self) -> OccupancyGrid:
        """The map drawn so far."""
        return self._running.floor.map.grid

    @property
    def _running(self) -> "_Search":
        if self._search is None:
            raise WorldError("no search is under way; call reset(goal) first")
        return self._search


class _Search:
    """One search for one goal on one floor: the phases, and the trace of the latest step."""

    def __init__(
        self, goal: Goal, components: SearchComponents, floor: Floor, steps: int = 0
    ) -> None:
        planning, embodiment = components.planning, components.embodiment
        local, config = components.local, components.config.paced(embodiment.motion)
        local.reset(goal)
        components.log.drain()
        self.floor = floor
        self.trace: StepTrace | None = None
        self._goal = goal
        self._components = components
        self._local = local
        self._log = components.log
        self._bumps = BumpSensor(planning, embodiment)
        self._steps = steps
        self._always_looks = config.looks == "always"
        explorer = components.explorer
        self._watcher = explorer if isinstance(explorer, Watches) else None
        self._explainer = explorer if isinstance(explorer, Explains) else None
        self._motion = embodiment.motion
        self._finishes_first_look = config.look_around_at_start and config.finish_first_look
        # Each keeps to its own plan: steps that lead to two positions by turns lead to neither.
        navigator = Navigator(planning, embodiment)
        roaming = Navigator(planning, embodiment)
        least_m2 = config.least_unseen_m2
        self._gaze = None if least_m2 is None else Gaze(embodiment, least_m2)
        self._look_around = LookAround(embodiment.motion, self._gaze)
        self._explore = Explore(
            goal, local, components.explorer, roaming, self._look_around, self._gaze, config
        )
        self._approach = Approach(
            goal,
            local,
            navigator,
            Navigator(planning, embodiment),
            floor.map,
            self._explore,
            self._look_around,
            config,
        )
        self._second_look = SecondLook(
            goal,
            local,
            navigator,
            self._approach,
            floor.map.config,
            planning.clearances_m(embodiment.body)[0],
            config,
        )
        self._phases: dict[PhaseName, Phase] = {
            PhaseName.LOOK_AROUND: self._look_around,
            PhaseName.EXPLORE: self._explore,
            PhaseName.APPROACH: self._approach,
            PhaseName.VERIFY: Verify(
                goal,
                local,
                navigator,
                self._approach,
                self._second_look,
                components.presence,
                config,
            ),
            PhaseName.SECOND_LOOK: self._second_look,
            PhaseName.END: End(
                goal,
                local,
                navigator,
                floor.map,
                self._explore,
                self._look_around,
                self._approach,
                config,
            ),
        }
        if config.look_around_at_start and not floor.trajectory:
            self._look_around.begin(full=not self._always_looks)

    def on(self, floor: Floor) -> "_Search":
        """The same search on another floor; a target on this one is forgotten."""
        return _Search(self._goal, self._components, floor, self._steps)

    def act(self, observation: Observation) -> Action | None:
        """Draw the map, look for the goal, decide, and keep the trace."""
        clock, events = ModuleClock(), list[str]()
        world_map, trajectory = self.floor.map, self.floor.trajectory
        trajectory.append(observation.robot.xy)
        with clock("map"):
            world_map.integrate(observation)
            world_map.mark_occupied(self._bumps.points(observation.robot, world_map.grid))
        with clock("local"):
            detections = self._local.look(observation, asks=self._asks_the_camera())
        if self._watcher is not None:
            with clock("global"):
                self._watcher.watch(observation, world_map.grid)
        if self._gaze is not None:
            self._gaze.note(observation.robot)
        step = Step(observation, world_map.grid, trajectory, self._motion, clock, events)
        decision = self._decide(step)
        if decision.action is not None:
            self._bumps.note_action(observation.robot, decision.action)
        self.trace = self._traced(step, decision, detections)
        self._steps += 1
        return decision.action

    def _asks_the_camera(self) -> bool:
        turned_around = self.trace is not None and self.trace.mode is Mode.LOOK_AROUND
        return self._always_looks or turned_around

    def _decide(self, step: Step) -> Decision:
        """Let one phase after another look at the step until one of them decides it."""
        outcome: Decision | PhaseName = self._first_phase()
        while isinstance(outcome, PhaseName):
            outcome = self._phases[outcome].act(step)
        return outcome

    def _first_phase(self) -> PhaseName:
        """Local perception comes first: a goal in sight is gone to, unless no path leads there."""
        if self._finishes_first_look and self._steps < self._motion.turns_of_a_circle:
            return PhaseName.LOOK_AROUND
        if self._local.target is None:
            self._approach.forget()
            self._second_look.cancel()
            return PhaseName.LOOK_AROUND
        if self._approach.rests():
            return PhaseName.LOOK_AROUND
        return PhaseName.SECOND_LOOK if self._second_look.is_under_way else PhaseName.APPROACH

    def _traced(
        self, step: Step, decision: Decision, detections: list[DetectionRecord]
    ) -> StepTrace:
        target, destination = self._local.target, self._explore.destination
        if target is not None:
            going_to = target.area.centre
        else:
            going_to = None if destination is None else destination.xy
        return StepTrace(
            step=self._steps,
            pose=(step.robot.x, step.robot.y, step.robot.yaw),
            action=decision.action,
            mode=decision.mode,
            reason=decision.reason,
            destination=going_to,
            path=decision.path,
            goal_area=target.area.outlines if target else [],
            detections=detections,
            blocks=self._explore.drain_offered(),
            exchanges=self._log.drain(),
            events=step.events,
            insight=self._explainer.take_insight() if self._explainer is not None else None,
            ending=decision.ending,
            seconds=step.clock.seconds,
        )
