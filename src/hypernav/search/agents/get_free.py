"""Getting free of what the robot touches: a step that was cut short is not tried again."""

import math
from dataclasses import replace

import numpy as np
from jaxtyping import Float64

from hypernav.core.embodiment import Action
from hypernav.core.geometry.transforms import Pose2, wrap_angle
from hypernav.core.trace import Mode
from hypernav.search.agents.plan import STANDS_M, Plan
from hypernav.search.agents.step import Decision, Phase, Step
from hypernav.search.memory.memory import Memory
from hypernav.search.planning.bump_sensor import is_cut_short

_SAME_HEADING = math.radians(15.0)
"""Angle between two headings, radians, below which a robot that turns finely tries one of them."""
_REMEMBERED = 100
"""Number of steps cut short that are remembered: what stood in their way may have gone."""
_ON_WAY = 16
"""Number of positions on the way of a step at which obstacles and drops are looked for."""
_AHEAD_M = 0.1
"""Length of a way that must be clear, metres, and after which the room around is compared."""


def with_tried(step: Step, plan: Plan) -> Plan:
    """The plan that knows from where, and in which heading, steps were cut short."""
    was_cut_short = is_cut_short(plan.ordered, step.robot, step.motion)
    has_stepped = plan.ordered is not None and plan.ordered[1] is Action.MOVE_FORWARD
    if (has_stepped and not was_cut_short) or not plan.stands(step.robot):
        plan = replace(plan, is_recovering=False)
    if step.components.planning.bump_sensor and plan.ordered is not None and was_cut_short:
        pose, _ = plan.ordered
        return replace(plan, tried=(*plan.tried, Pose2(*step.robot.xy, pose.yaw))[-_REMEMBERED:])
    return plan


def repeats(step: Step, plan: Plan, outcome: Decision | Phase) -> bool:
    """Whether a decision is for a step that was cut short here: it would not move the robot."""
    is_step = isinstance(outcome, Decision) and outcome.action is Action.MOVE_FORWARD
    return is_step and plan.climbing is None and _is_tried(step.robot, step, plan)


def get_free(step: Step, memory: Memory, plan: Plan) -> tuple[Decision | Phase, Plan]:
    """Try a step in the nearest heading in which none was cut short, until one moves the robot.

    What it touches may be anywhere before it, so marks of bumps say less than such a step. No
    heading is tried in which a drop is known, or images show what would stop the robot at once.
    """
    robot = step.robot
    obstacles = step.grid.centres_of(np.argwhere(step.grid.occupied))

    def rank(turns: int) -> tuple[int, float]:
        ahead = np.array(_after(turns, step).ahead(_AHEAD_M).xy)
        away_m = np.linalg.norm(obstacles - ahead, axis=1)
        return abs(turns), -float(away_m.min(initial=math.inf))

    radius_m, floor = step.components.embodiment.body.radius_m, memory.floor.map

    closed = closed_turns(step, plan)

    def is_open(turns: int) -> bool:
        pose = _after(turns, step)
        clear = _way(pose, _AHEAD_M + radius_m)
        whole = _way(pose, step.motion.forward_m + radius_m)
        is_seen_closed = floor.shows_obstacle(clear) or floor.has_drop(whole)
        return not (is_seen_closed or turns in closed)

    untried = [k for k in _turns(step) if is_open(k)]
    if not untried:
        return Phase.END, replace(plan, tried=(), is_recovering=False)
    turns = min(untried, key=rank)
    action, path = Action.MOVE_FORWARD, [robot.xy, robot.ahead(step.motion.forward_m).xy]
    if turns != 0:
        action, path = Action.TURN_LEFT if turns > 0 else Action.TURN_RIGHT, []
    mode = Mode.EXPLORE if memory.search.evidence.target is None else Mode.APPROACH
    reason = "touching something, trying to get free of it"
    return Decision(action, mode, reason, path), replace(plan, is_recovering=True)


def closed_turns(step: Step, plan: Plan) -> frozenset[int]:
    """The turns to the left after which a step was cut short here."""
    return frozenset(k for k in _turns(step) if _is_tried(_after(k, step), step, plan))


def _turns(step: Step) -> range:
    """All headings, by turns to the left, negative to the right."""
    count = step.motion.turns_of_a_circle
    return range(1 - (count + 1) // 2, count // 2 + 1)


def _after(turns: int, step: Step) -> Pose2:
    """The robot's pose after some turns to the left."""
    robot, turn = step.robot, math.radians(step.motion.turn_angle_deg)
    return Pose2(robot.x, robot.y, robot.yaw + turns * turn)


def _way(pose: Pose2, length_m: float) -> Float64[np.ndarray, "n 2"]:
    """Positions ahead of a pose up to a length, metres."""
    return np.array([pose.ahead(far_m).xy for far_m in np.linspace(0.0, length_m, _ON_WAY)])


def _is_tried(pose: Pose2, step: Step, plan: Plan) -> bool:
    """Whether a step from a pose was cut short before."""
    near = max(math.radians(step.motion.turn_angle_deg) / 2.0, _SAME_HEADING)
    return any(
        one.distance_to(*pose.xy) < STANDS_M and abs(wrap_angle(one.yaw - pose.yaw)) < near
        for one in plan.tried
    )
