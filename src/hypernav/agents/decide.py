"""The decision of a step: phases hand it on from one to another until one of them decides."""

from collections.abc import Callable, Mapping

from hypernav.agents.phases.approach import approach
from hypernav.agents.phases.climb import climb
from hypernav.agents.phases.end import end
from hypernav.agents.phases.explore import explore
from hypernav.agents.phases.get_free import get_free, repeats, with_tried
from hypernav.agents.phases.recall import errand, is_nearer
from hypernav.agents.phases.second_look import second_look
from hypernav.agents.phases.verify import verify
from hypernav.agents.plan import Plan
from hypernav.agents.step import Decision, Phase, Step
from hypernav.mapping.memory.candidate import Candidate
from hypernav.mapping.memory.memory import Memory
from hypernav.perception.local.belief import likeliest, reconsidered

_PHASES: Mapping[Phase, Callable[[Step, Memory, Plan], tuple[Decision | Phase, Plan]]] = {
    Phase.EXPLORE: explore,
    Phase.APPROACH: approach,
    Phase.VERIFY: verify,
    Phase.SECOND_LOOK: second_look,
    Phase.CLIMB: climb,
    Phase.GET_FREE: get_free,
    Phase.END: end,
}

_DETOUR = 2.0
"""Actions, turns included, that the path to a place takes per step of the straight line there."""
_TURNS = 1.5
"""Actions that a path takes per step of its length, since turns are actions too."""
_MEASURED_EVERY = 10
"""Number of steps between two plans of the path to the likeliest candidate."""


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
    if plan.frees:
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
    if target is not None and (
        _is_another(step, memory, target) or is_nearer(step, memory, plan, target)
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
        way_m = step.use.navigator.way_m(step.grid, step.robot, *destinations)
    return way_m is not None and left <= _TURNS * way_m / motion.forward_m + turns
