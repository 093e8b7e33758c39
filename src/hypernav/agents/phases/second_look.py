"""A second look at an uncertain target, from another side, before the robot believes in it."""

import numpy as np

from hypernav.agents.phases.other_side import position_on_other_side
from hypernav.agents.plan import Plan
from hypernav.agents.step import Decision, Phase, Step, turn_towards
from hypernav.core.trace import Mode
from hypernav.mapping.memory.memory import Memory
from hypernav.mapping.memory.target import Target
from hypernav.perception.local.belief import confirmed, is_convincing, rejected


def with_second_look(step: Step, plan: Plan, target: Target) -> Plan:
    """The plan with a second look, if a position on another side of the target can be reached."""
    with step.clock("verify"):
        position = position_on_other_side(
            step.grid,
            step.robot,
            target.area,
            target.best_view.robot.xy,
            step.use.mapping,
            step.use.planning.clearances_m(step.use.embodiment.body)[0],
        )
    if position is not None:
        step.events.append("second look wanted")
    return plan.approach(second_look=position, second_look_steps=0)


def second_look(step: Step, memory: Memory, plan: Plan) -> tuple[Decision | Phase, Plan]:
    """Drive to the other side, turn to the target, and judge it by the image there."""
    target, position = memory.search.evidence.target, plan.approaching.second_look
    if target is None or position is None:
        return Phase.LOOK_AROUND, plan
    robot, config, thing = step.robot, step.config, step.goal.thing
    steps = plan.approaching.second_look_steps + 1
    plan = plan.approach(second_look_steps=steps)
    if steps <= config.endurance_steps:
        with step.clock("plan"):
            action, route = step.use.navigator.towards(
                plan.approaching.route, step.grid, robot, np.array([position])
            )
        plan = plan.approach(route=route)
        if action is not None:
            reason = f"is it really the {thing}? going to look from another side"
            return Decision(action, Mode.VERIFY, reason, route.remaining(robot)), plan
    turn = turn_towards(robot, target.area.centre, step.motion)
    if turn is not None:
        reason = f"turning to face the {thing} from another side"
        path = plan.approaching.route.remaining(robot)
        return Decision(turn, Mode.VERIFY, reason, path), plan
    plan = plan.approach(second_look=None).with_new_patience(config)
    evidence, local = confirmed(memory.search.evidence), step.use.local.config
    if is_convincing(evidence, local):
        memory.search.evidence = evidence
        return Phase.APPROACH, plan
    step.events.append("goal area rejected")
    memory.search.evidence = rejected(evidence, local)
    return Phase.LOOK_AROUND, plan
