"""A turn around, full or as far as it shows something."""

from dataclasses import replace

from hypernav.agents.plan import Plan
from hypernav.agents.step import Decision, Phase, Step
from hypernav.core.actions import Action
from hypernav.core.trace import Mode
from hypernav.mapping.memory.memory import Memory


def look_around(step: Step, memory: Memory, plan: Plan) -> tuple[Decision | Phase, Plan]:
    """The next turn of the circle, if one is left that shows something; else exploration."""
    turn = _next_turn(step, memory, plan)
    if turn is None:
        return Phase.EXPLORE, replace(plan, turns_left=0)
    plan = replace(plan, turns_left=plan.turns_left - 1, looked_around_at=step.robot.xy)
    return Decision(turn, Mode.LOOK_AROUND, "looking around"), plan


def _next_turn(step: Step, memory: Memory, plan: Plan) -> Action | None:
    gaze = step.use.gaze
    if plan.turns_left == 0:
        return None
    if plan.full_turn or gaze is None:
        return Action.TURN_LEFT
    return gaze.worthwhile_turn(step.grid, step.robot, memory.search.looked)
