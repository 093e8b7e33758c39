"""The search that the agents of this package share; they differ in their explorers."""

from dataclasses import replace

from hypernav.agents.decide import decide
from hypernav.agents.phases.recall import leaves_for_recalled
from hypernav.agents.plan import Climbing, Plan
from hypernav.agents.step import Decision, SearchComponents, Step
from hypernav.core.actions import Action
from hypernav.core.embodiment import Embodiment
from hypernav.core.errors import WorldError
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import BlockRecord, DetectionRecord, Mode, ModuleClock, StepTrace
from hypernav.mapping.memory.memory import Memory
from hypernav.mapping.memory.ways import stairs_underfoot
from hypernav.planning.bump_sensor import bumped_points


class SearchAgent:
    """Builds a map, looks for the goal, explores while it is out of sight, stops at it.

    What it knows is in the memory, and what it intends in the plan. Beside these it keeps the goal,
    the number of steps and the latest trace, and its components keep counts and caches.
    """

    def __init__(self, components: SearchComponents) -> None:
        """Begin with no search under way."""
        self.components: SearchComponents = components
        self._goal: Goal | None = None
        self._memory: Memory | None = None
        self._plan: Plan | None = None
        self._trace: StepTrace | None = None
        self._steps = 0
        self._most_steps = components.config.max_steps

    @property
    def embodiment(self) -> Embodiment:
        """The robot that the agent was built for."""
        return self.components.embodiment

    def allow_steps(self, most: int) -> None:
        """Plan the next searches with so many steps, at most those of the configuration."""
        steps, config = min(most, self._most_steps), self.components.config
        if steps != config.max_steps:
            config = config.model_copy(update={"max_steps": steps})
            self.components = replace(self.components, config=config)

    def reset(self, goal: Goal, memory: Memory | None = None) -> None:
        """Begin a new search.

        Args:
            goal: What to find.
            memory: What is known of the building, in whose ``map`` frame the robot is. The agent
                changes it from now on, and keeps for later searches what they need besides the
                maps. None begins a memory for this search alone.
        """
        components, lasts = self.components, memory is not None
        memory = memory or self.new_memory()
        memory.begin_search(lasts=lasts, sees_stairs=components.config.use_stairs)
        components.log.drain()
        self._goal, self._memory, self._plan = goal, memory, None
        self._trace, self._steps = None, 0

    def new_memory(self) -> Memory:
        """An empty memory, for the first of several searches."""
        return Memory(self.components.mapping, self.components.embodiment)

    def act(self, observation: Observation) -> Action | None:
        """Integrate the observation and choose an action; None ends the search without a claim."""
        (goal, memory), use = self._running, self.components
        clock, events = ModuleClock(), list[str]()
        came_from, floor = memory.number, memory.follow(observation)
        plan = self._plan
        if plan is None or memory.number != came_from:
            plan = self._plan_of_floor(memory, plan, events)
        if memory.on_stairs and plan.climbing is None:
            plan = _off_the_floor(observation.robot, memory, plan, events)
        plan = plan.explore(offered=(), insight=None)
        seen = memory.seen_from_ground(observation)
        with clock("map"):
            if not memory.on_stairs:  # stairs belong to no floor
                floor.integrate(seen)
            bumped = bumped_points(
                plan.ordered, seen.robot, memory.way, memory.obstacles, use.planning, use.embodiment
            )
            memory.mark_occupied(bumped)
        with clock("local"):
            asks = self._asks_the_camera() and not memory.on_stairs
            was_elsewhere = floor.search.seen_off_floor is not None
            detections = use.local.look(seen, goal, floor, ground_m=memory.ground_m, asks=asks)
            memory.keep_image(seen)
        if was_elsewhere and floor.search.seen_off_floor is None:
            events.append("goal is on this floor after all")
        step = Step(self._steps, goal, seen, floor.map.grid, use, clock, events)
        if use.learner is not None:
            with clock("global"):
                use.learner.learn(step.view(memory))
        if use.gaze is not None:
            floor.search.looked = use.gaze.after_image(floor.search.looked, seen.robot)
        decision, plan = decide(step, memory, plan)
        if decision.action is not None:
            plan = replace(plan, ordered=(seen.robot, decision.action))
        self._trace = self._traced(step, memory, plan, decision, detections)
        climbing = plan.climbing
        memory.goes_over(None if climbing is None or climbing.is_back else climbing.connector)
        self._plan, self._steps = plan, self._steps + 1
        return decision.action

    @property
    def memory(self) -> Memory:
        """What the agent knows of the building, present search included."""
        return self._running[1]

    @property
    def last_step(self) -> StepTrace:
        """The trace of the latest `act`."""
        if self._trace is None:
            raise WorldError("the agent has not acted yet; call reset(goal), then act(observation)")
        return self._trace

    @property
    def grid(self) -> OccupancyGrid:
        """The map so far of the floor that the robot is on."""
        return self.memory.floor.map.grid

    @property
    def _running(self) -> tuple[Goal, Memory]:
        if self._goal is None or self._memory is None:
            raise WorldError("no search is under way; call reset(goal) first")
        return self._goal, self._memory

    def _plan_of_floor(self, memory: Memory, before: Plan | None, events: list[str]) -> Plan:
        """The first plan on a floor: a look around, unless the robot has been there before.

        A search that would begin by leaving its floor looks at what is unseen there first.
        """
        if before is None and memory.under_way is not None and memory.on_stairs:
            climbing = Climbing(memory.under_way.connector)  # where the last search has ended
            return replace(Plan.at_start(self.components.paced, turns=0), climbing=climbing)
        then, climbing = None, None if before is None else before.climbing
        if climbing is not None:
            if memory.connectors[climbing.connector].other_floor == memory.number:
                then = climbing.then
            memory.crossed(climbing.connector)
            events.append("another floor reached")
        config, turns = self.components.paced, self.embodiment.motion.turns_of_a_circle
        looks = config.look_around_at_start and not memory.floor.trajectory
        if before is None and self.components.gaze is not None and config.looks == "always":
            looks = looks or leaves_for_recalled(self._running[0], memory, config)
        return Plan.at_start(config, turns=turns if looks else 0, then=then)

    def _asks_the_camera(self) -> bool:
        turned_around = self._trace is not None and self._trace.mode is Mode.LOOK_AROUND
        return self.components.config.looks == "always" or turned_around

    def _traced(
        self,
        step: Step,
        memory: Memory,
        plan: Plan,
        decision: Decision,
        detections: list[DetectionRecord],
    ) -> StepTrace:
        target, destination, robot = memory.search.evidence.target, plan.destination, step.robot
        if target is not None:
            going_to = target.area.centre
        else:
            going_to = None if destination is None else destination.xy
        return StepTrace(
            step=step.number,
            pose=(robot.x, robot.y, robot.yaw),
            z=memory.footing.z,
            action=decision.action,
            mode=decision.mode,
            reason=decision.reason,
            floor=memory.number + 1 if len(memory.floors) > 1 else None,
            destination=going_to,
            path=decision.path,
            goal_area=target.area.outlines if target else [],
            detections=detections,
            blocks=[
                BlockRecord(number=one.number, x_min=one.x_min, y_min=one.y_min, size_m=one.size_m)
                for one in plan.exploring.offered
            ],
            exchanges=self.components.log.drain(),
            events=step.events,
            insight=plan.exploring.insight,
            ending=decision.ending,
            seconds=step.clock.seconds,
        )


def _off_the_floor(robot: Pose2, memory: Memory, plan: Plan, events: list[str]) -> Plan:
    """The plan of a robot that is on stairs unplanned: it takes them, or they are its ground.

    The head of stairs is not always where it seemed to be, or was never seen. From stairs that it
    has taken before it goes back, by the map of its floor.
    """
    number = stairs_underfoot(memory, robot.xy)
    if plan.stands(robot):
        if plan.ordered is None or number is None or memory.connectors[number].is_new:
            memory.settle(robot)
        return plan
    if number is None:
        number = memory.gets_onto_stairs_down(robot)
    destination, then = plan.destination, None
    if number is not None and destination is not None and destination.connector == number:
        then = destination.then
    elif number is None or not memory.connectors[number].is_new:
        return plan
    events.append("came onto stairs sooner than planned")
    flight = replace(memory.connectors[number], end=robot.xy, axis=robot.yaw)
    climbing = Climbing(number, flight=flight, then=then)
    return replace(plan.explore(destination=None), climbing=climbing)
