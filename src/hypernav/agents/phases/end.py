"""The end of exploration, when nothing is left to explore."""

from dataclasses import replace

from hypernav.agents.plan import STANDS_M, Plan
from hypernav.agents.step import Decision, Phase, Step
from hypernav.core.actions import Action
from hypernav.core.trace import Ending, Mode
from hypernav.mapping.memory.memory import Memory
from hypernav.perception.local.belief import reconsidered


def end(step: Step, memory: Memory, plan: Plan) -> tuple[Decision | Phase, Plan]:
    """Get free; go near the candidate; look once more; retry the likeliest refuted; end.

    The robot gets free where a step of it was cut short.
    """
    goal, search = step.goal.told, memory.search
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
        reason = "nothing is left to explore, looking once more"
        return Decision(Action.TURN_LEFT, Mode.LOOK_AROUND, reason), replace(
            plan,
            ends=(*plan.ends, step.robot.xy),
            turns_left=step.motion.turns_of_a_circle,
            full_turn=True,
        )
    evidence = reconsidered(search.evidence)
    if evidence is not None:
        search.evidence = evidence
        step.events.append("rejected goal area reconsidered")
        reason = f"nothing is left to explore, going to what looked most like {goal}"
        decision = Decision(Action.TURN_LEFT, Mode.APPROACH, reason)
        return decision, plan.with_new_patience(step.config)
    reason = "nothing is left to explore"
    if step.config.claim_when_explored:
        return Decision(Action.STOP, Mode.STOP, reason, ending=Ending.FOUND), plan
    return Decision(None, Mode.STOP, reason, ending=Ending.GAVE_UP), plan


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
