"""The search that the agents of this package share; they differ in their explorers.

In every step phases hand the decision on from one to another until one of them decides.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from hypernav.core.embodiment import Action, Embodiment
from hypernav.core.errors import WorldError
from hypernav.core.events import Event
from hypernav.core.exploring.operator_place import OperatorPlace, PlaceState
from hypernav.core.geometry.closed_area import ClosedArea, with_closed
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import BlockRecord, DetectionRecord, Ending, Mode, ModuleClock, StepTrace
from hypernav.search.agents.approach import approach
from hypernav.search.agents.climb import climb
from hypernav.search.agents.destinations import OverStairs, beyond_stairs
from hypernav.search.agents.explore import explore
from hypernav.search.agents.get_free import get_free, repeats, with_tried
from hypernav.search.agents.plan import STANDS_M, Climbing, Plan
from hypernav.search.agents.recall import errand, is_nearer, leaves_for_recalled
from hypernav.search.agents.step import Decision, Phase, SearchComponents, Step
from hypernav.search.agents.verify import second_look, verify
from hypernav.search.memory.candidate import Candidate
from hypernav.search.memory.floor_exits import stairs_underfoot
from hypernav.search.memory.memory import Memory
from hypernav.search.perception.local.belief import is_convincing, likeliest, reconsidered
from hypernav.search.planning.bump_sensor import bumped_points

_DETOUR = 2.0
"""Actions, turns included, that the path to a place takes per step of the straight line there."""
_TURNS = 1.5
"""Actions that a path takes per step of its length, since turns are actions too."""
_MEASURED_EVERY = 10
"""Number of steps between two plans of the path to the likeliest candidate."""


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
        self._closed: tuple[ClosedArea, ...] = ()
        self._place: OperatorPlace | None = None

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
        self._trace, self._steps, self._closed, self._place = None, 0, (), None

    def keep_out_of(self, areas: Sequence[ClosedArea]) -> None:
        """Enter none of these areas from the next `act` on; `reset` forgets them."""
        self._closed = tuple(areas)

    def go_to(self, place: OperatorPlace | None) -> None:
        """Go to this place from the next `act` on, then search on; `reset` forgets it.

        What convincingly looks like the goal is gone to first.
        """
        self._place = place

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
        if self._place is not None and (plan.sent is None or plan.sent.place != self._place):
            events.append(PlaceState.ON_ITS_WAY.event)
        plan = plan.sent_to(self._place, use.paced)
        seen = memory.seen_from_ground(observation)
        with clock("map"):
            if not memory.on_stairs:  # stairs belong to no floor
                floor.integrate(seen)
            bumped = bumped_points(
                plan.ordered,
                seen.robot,
                memory.track,
                memory.obstacles,
                use.planning,
                use.embodiment,
            )
            memory.mark_occupied(bumped)
        with clock("local"):
            asks = self._asks_the_camera() and not memory.on_stairs
            was_elsewhere = floor.search.seen_off_floor is not None
            detections = use.local.look(seen, goal, floor, ground_m=memory.ground_m, asks=asks)
            memory.keep_image(seen)
        if was_elsewhere and floor.search.seen_off_floor is None:
            events.append(Event.GOAL_ON_THIS_FLOOR)
        closed = [one for one in self._closed if one.floor == memory.number + 1]
        grid = with_closed(floor.map.grid, closed)
        step = Step(self._steps, goal, seen, grid, use, clock, events)
        if use.learner is not None:
            with clock("global"):
                use.learner.learn(step.view(memory))
        if use.gaze is not None:
            floor.search.looked = use.gaze.after_image(floor.search.looked, seen.robot)
        decision, plan = decide(step, memory, plan)
        decision = _kept_out(step, decision, closed)
        if decision.action is not None:
            plan = replace(plan, ordered=(seen.robot, decision.action))
        self._trace = self._traced(step, memory, plan, decision, detections)
        climbing = plan.climbing
        memory.set_current_connector(
            None if climbing is None or climbing.is_back else climbing.connector
        )
        self._plan, self._steps = plan, self._steps + 1
        self._place = None if plan.sent is None else plan.sent.place
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
            events.append(Event.FLOOR_REACHED)
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
        if plan.sent is not None and decision.mode is Mode.EXPLORE:
            going_to = plan.sent.place.xy
        elif target is not None:
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
        number = memory.register_stairs_underfoot(robot)
    destination, then = plan.destination, None
    leads_on = isinstance(destination, OverStairs)
    if number is not None and leads_on and destination.connector == number:
        then = beyond_stairs(destination)
    elif number is None or not memory.connectors[number].is_new:
        return plan
    events.append(Event.ONTO_STAIRS)
    flight = replace(memory.connectors[number], end=robot.xy, axis=robot.yaw)
    climbing = Climbing(number, flight=flight, then=then)
    return replace(plan.explore(destination=None), climbing=climbing)


def _kept_out(step: Step, decision: Decision, closed: Sequence[ClosedArea]) -> Decision:
    """A turn instead of a step into a closed area, whichever phase orders it; stairs have no map.

    A robot that an area was closed around may leave it.
    """
    if decision.action is not Action.MOVE_FORWARD:
        return decision
    here, ahead = step.robot.xy, step.robot.ahead(step.motion.forward_m).xy
    for area in closed:
        left_m = area.distance_m(*ahead)
        if left_m < 0.0 and left_m < area.distance_m(*here):
            reason = "the way ahead is closed by the operator"
            return Decision(Action.TURN_LEFT, decision.mode, reason)
    return decision


def decide(step: Step, memory: Memory, plan: Plan) -> tuple[Decision, Plan]:
    """The decision of this step, and the plan that goes on from here."""
    outcome, plan = _first_phase(step, memory, with_tried(step, plan))
    while isinstance(outcome, Phase):
        outcome, plan = _PHASES[outcome](step, memory, plan)
        if repeats(step, plan, outcome):
            outcome = Phase.GET_FREE
    return outcome, plan


def _first_phase(step: Step, memory: Memory, plan: Plan) -> tuple[Decision | Phase, Plan]:
    """The phase that gets the step first: the approach if there is a candidate to go to now."""
    config = step.config
    if plan.climbing is not None:
        return Phase.CLIMB, plan
    if plan.is_recovering:
        return Phase.GET_FREE, plan
    must_finish_look = config.look_around_at_start and config.finish_first_look
    if must_finish_look and step.number < step.motion.turns_of_a_circle:
        return Phase.EXPLORE, plan
    if _must_choose(step, memory):
        evidence = reconsidered(memory.search.evidence)
        memory.search.evidence = evidence or memory.search.evidence
        if config.open_the_way:
            plan = plan.approach(as_near_as_possible=True, steps_run_out=True)
    target = memory.search.evidence.target
    is_doubtful = not is_convincing(memory.search.evidence, step.components.local.config)
    if target is not None and (
        (plan.sent is not None and is_doubtful)
        or _is_another(step, memory, target)
        or is_nearer(step, memory, plan, target)
    ):
        target = None
    if target is None or target.number != plan.approaching.candidate:
        number = None if target is None else target.number
        plan = plan.approach(
            candidate=number,
            second_look=None,
            opening=None,
            closed=(),
            blocked_steps=0,
            sure_step=None,
        ).with_new_patience(config)
    if target is None:
        return Phase.EXPLORE, plan
    approaching = plan.approaching
    if approaching.rest_steps > 0 and not approaching.as_near_as_possible:
        return Phase.EXPLORE, plan.approach(rest_steps=approaching.rest_steps - 1)
    if approaching.second_look is not None:
        return Phase.SECOND_LOOK, plan
    return Phase.APPROACH, plan


def _is_another(step: Step, memory: Memory, target: Candidate) -> bool:
    """Whether a target is another thing than the one that the robot was sent to."""
    meant = None if target.is_last_chance else errand(step, memory)
    if meant is None:
        return False
    there = memory.floor.things.at(*target.area.centre, step.goal)
    return all((memory.number, one.number) != (meant[0], meant[1].number) for one in there)


def _must_choose(step: Step, memory: Memory) -> bool:
    """Whether the steps that are left only just suffice to go to the likeliest candidate.

    While the one thing that is meant is on another floor, no candidate of this one will do.
    """
    evidence, config, motion = memory.search.evidence, step.config, step.motion
    meant = errand(step, memory)
    if meant is not None and meant[0] != memory.number:
        return False
    best = likeliest(evidence)
    if best is None or (evidence.target is not None and evidence.target.is_last_chance):
        return False
    left = config.max_steps - step.number
    turns = 2 * motion.turns_of_a_circle
    straight = best.distance_to(*step.robot.xy) / motion.forward_m
    if left <= _DETOUR * straight + turns:
        return True
    if not config.open_the_way or 2 * left > config.max_steps or left % _MEASURED_EVERY:
        return False
    with step.clock("plan"):
        beside = best.views_beside
        destinations = (best.entry_points, *([beside] if len(beside) else []))
        path_m = step.components.navigator.path_m(step.grid, step.robot, *destinations)
    return path_m is not None and left <= _TURNS * path_m / motion.forward_m + turns


def end(step: Step, memory: Memory, plan: Plan) -> tuple[Decision | Phase, Plan]:
    """Get free; go near the candidate; look once more; retry the likeliest refuted; end.

    The robot gets free where a step of it was cut short.
    """
    goal, search = step.goal.in_sentence, memory.search
    vain = plan.exploring.in_vain
    why = vain.why if vain and vain.is_at(step.robot) else "nothing is left to explore"
    goes_on = _goes_on(step, plan)
    if goes_on and any(one.distance_to(*step.robot.xy) < STANDS_M for one in plan.tried):
        _forget(memory)
        return Phase.GET_FREE, plan
    if memory.search.evidence.target is not None and not plan.approaching.as_near_as_possible:
        if step.config.open_the_way and plan.approaching.may_clear(step.config):
            reason = f"the way to {goal} is blocked, looking whether it stays so"
            return Decision(Action.TURN_LEFT, Mode.LOOK_AROUND, reason), replace(
                plan, turns_left=step.motion.turns_of_a_circle, full_turn=True
            )
        reason = f"all is explored, going as near to {goal} as possible"
        path = plan.approaching.route.remaining(step.robot)
        decision = Decision(Action.TURN_LEFT, Mode.APPROACH, reason, path)
        return decision, plan.approach(as_near_as_possible=True)
    if goes_on:
        _forget(memory)
        reason = f"{why}; looking once more"
        return Decision(Action.TURN_LEFT, Mode.LOOK_AROUND, reason), replace(
            plan,
            ends=(*plan.ends, step.robot.xy),
            turns_left=step.motion.turns_of_a_circle,
            full_turn=True,
        )
    evidence = reconsidered(search.evidence)
    if evidence is not None:
        search.evidence = evidence
        step.events.append(Event.AREA_RECONSIDERED)
        reason = f"{why}; going to what looked most like {goal}"
        decision = Decision(Action.TURN_LEFT, Mode.APPROACH, reason)
        return decision, plan.with_new_patience(step.config)
    if step.config.claim_when_explored:
        return Decision(Action.STOP, Mode.STOP, why, ending=Ending.FOUND), plan
    return Decision(None, Mode.STOP, why, ending=Ending.GAVE_UP), plan


def _forget(memory: Memory) -> None:
    """Forget visited positions and bumps, which may be all that keeps the robot from going on."""
    memory.search.forget_exploration()
    memory.floor.map.forget_bumps()


def _goes_on(step: Step, plan: Plan) -> bool:
    """Whether to look once more: always, or if exploration has not ended near here before."""
    if not step.config.end_when_explored:
        return True
    near_m = 2.0 * step.config.arrival_distance_m
    return step.config.look_again_before_giving_up and all(
        step.robot.distance_to(*position) > near_m for position in plan.ends
    )


_PHASES: Mapping[Phase, Callable[[Step, Memory, Plan], tuple[Decision | Phase, Plan]]] = {
    Phase.EXPLORE: explore,
    Phase.APPROACH: approach,
    Phase.VERIFY: verify,
    Phase.SECOND_LOOK: second_look,
    Phase.CLIMB: climb,
    Phase.GET_FREE: get_free,
    Phase.END: end,
}
