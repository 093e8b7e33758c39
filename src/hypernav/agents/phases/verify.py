"""The check at the goal area, before the robot stops there."""

from hypernav.agents.phases.second_look import with_second_look
from hypernav.agents.plan import Plan
from hypernav.agents.step import Decision, Phase, Step, turn_towards
from hypernav.core.actions import Action
from hypernav.core.trace import Ending, Mode
from hypernav.mapping.memory.candidate import Candidate
from hypernav.mapping.memory.memory import Memory
from hypernav.perception.local.belief import (
    is_convincing,
    needs_second_look,
    rejected,
    with_position_barred,
)

_AS_NEAR_AS_M = 0.3
"""Distance, metres, at which the robot is near enough to a goal whose outline was guessed."""


def verify(step: Step, memory: Memory, plan: Plan) -> tuple[Decision | Phase, Plan]:
    """Face the goal area and check it; then stop, look from elsewhere, or reject it."""
    target, search, config = memory.search.evidence.target, memory.search, step.config
    if target is None:
        return Phase.EXPLORE, plan
    is_sure = _is_still_sure(step, memory, plan)
    if is_sure and step.number + 1 >= config.max_steps:
        return _stop(step), plan
    plan = plan.approach(sure_step=step.number if is_sure else None)
    turn = turn_towards(step.robot, target.area.centre, step.motion)
    if config.face_target and turn is not None:
        reason = f"turning to face {step.goal.told}"
        path = plan.approaching.route.remaining(step.robot)
        return Decision(turn, Mode.VERIFY, reason, path), plan
    if is_sure:
        if _goes_nearer(step, target):
            reason = f"here is {step.goal.told}, going nearer"
            return Decision(Action.MOVE_FORWARD, Mode.APPROACH, reason), plan
        return _stop(step), plan
    if config.see_before_stop:
        barred = with_position_barred(search.evidence, step.observation)
        if barred is not None:
            search.evidence = barred
            step.events.append("goal area not in sight from here")
            return Phase.APPROACH, plan.with_new_patience(config)
    local = step.use.local.config
    if needs_second_look(search.evidence, local):
        plan = with_second_look(step, plan, target)
        if plan.approaching.second_look is not None:
            return Phase.SECOND_LOOK, plan
    with step.clock("verify"):
        present = _is_present(step, memory, target)
    if present:
        return Phase.VERIFY, plan.approach(sure_step=step.number)
    step.events.append("goal area rejected")
    for_good = is_convincing(search.evidence, local)
    search.evidence = rejected(search.evidence, local, for_good=for_good)
    return Phase.EXPLORE, plan.with_new_patience(config)


def _is_still_sure(step: Step, memory: Memory, plan: Plan) -> bool:
    """Whether the check held in this step or the last, and the candidate is still convincing."""
    said, evidence = plan.approaching.sure_step, memory.search.evidence
    is_recent = said is not None and step.number - said <= 1
    return is_recent and is_convincing(evidence, step.use.local.config)


def _stop(step: Step) -> Decision:
    step.events.append("goal reached")
    reason = f"here is {step.goal.told}"
    return Decision(Action.STOP, Mode.STOP, reason, ending=Ending.FOUND)


def _goes_nearer(step: Step, target: Candidate) -> bool:
    """Whether to step forward, to a goal whose guessed outline may include what is before it."""
    if not (step.config.go_nearer and target.area.is_guessed):
        return False
    robot = step.robot
    ahead = robot.ahead(step.motion.forward_m)
    from_m, to_m = (target.area.distance_to_seen(*pose.xy) for pose in (robot, ahead))
    if from_m <= _AS_NEAR_AS_M or to_m >= from_m:
        return False
    return step.use.navigator.is_open(step.grid, robot, ahead)


def _is_present(step: Step, memory: Memory, target: Candidate) -> bool:
    if not is_convincing(memory.search.evidence, step.use.local.config):
        return False
    view = target.best_view if step.config.verify_view == "best" else step.observation
    presence = step.use.presence
    return presence is None or presence.is_present(view, step.goal)
