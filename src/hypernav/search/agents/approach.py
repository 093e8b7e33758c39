"""The approach to the goal area."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float64

from hypernav.core.embodiment import Action
from hypernav.core.events import Event
from hypernav.core.trace import Mode
from hypernav.search.agents.plan import Opening, Plan
from hypernav.search.agents.step import Decision, Phase, Step, turn_towards
from hypernav.search.memory.candidate import Candidate
from hypernav.search.memory.memory import Memory
from hypernav.search.perception.local.belief import is_convincing, rejected

_CLOSE_BY_M = 1.5
"""Length of the rest of the path, metres, below which a stuck robot counts as at the goal area."""
_WIDER_M = (0.3, 0.7)
"""Distances from the entry points, metres, that suffice, in sight, if nothing else is left."""
_GAPS_PER_STEP = 3


def approach(step: Step, memory: Memory, plan: Plan) -> tuple[Decision | Phase, Plan]:
    """Drive to the goal area and hand on to VERIFY there; explore for now where no path leads."""
    target, robot, config = memory.search.evidence.target, step.robot, step.config
    if target is None:
        return Phase.EXPLORE, plan
    opens = _may_open_path(step, memory, plan)
    goals = _goals(step, memory, plan, target, opens=opens)
    if _distance_m(robot.xy, goals[0]) <= config.stop_distance_m:
        return Phase.VERIFY, _without_exploration(step, plan)
    with step.clock("plan"):
        action, plan = _next_action(step, plan, target, goals)
    must_do, route = plan.approaching.as_near_as_possible, plan.approaching.route
    path, gap_m = route.path, config.approach_gap_m
    leads_there = path is not None and path.gap_m <= gap_m
    enters = path is not None and leads_there and _distance_m(path.end, goals[0]) <= gap_m
    if not enters:
        plan = plan.approach(blocked_steps=plan.approaching.blocked_steps + 1)
    if path is None or not (leads_there or must_do):
        if opens:
            with step.clock("plan"):
                decision, plan = _open_way(step, plan, np.concatenate(goals))
            if decision is not None:
                return decision, _without_exploration(step, plan)
        return Phase.EXPLORE, plan.with_new_patience(config)
    left_m = route.left_m(robot)
    if action is not None:
        patience = plan.approaching.patience.after(left_m, len(route.actions))
        plan = plan.approach(patience=patience)
        if patience.lasts:
            reason = f"going to {step.goal.in_sentence}"
            decision = Decision(action, Mode.APPROACH, reason, route.remaining(robot))
            return decision, _without_exploration(step, plan)
    elif opens and not (must_do or enters) and plan.approaching.may_clear(config):
        turn = turn_towards(robot, target.area.centre, step.motion) or Action.TURN_LEFT
        reason = f"waiting beside {step.goal.in_sentence} for what stands before it"
        return Decision(turn, Mode.APPROACH, reason), _without_exploration(step, plan)
    if config.local_first and (action is not None or not leads_there):
        step.events.append(Event.AREA_GIVEN_UP)
        memory.search.evidence = rejected(memory.search.evidence, step.components.local.config)
        return Phase.EXPLORE, plan.with_new_patience(config)
    if left_m > _CLOSE_BY_M and not must_do:
        step.events.append(Event.GOAL_OUT_OF_REACH)
        plan = plan.approach(rest_steps=config.endurance_steps)
        return Phase.EXPLORE, plan.with_new_patience(config)
    return Phase.VERIFY, _without_exploration(step, plan)


def _next_action(
    step: Step, plan: Plan, target: Candidate, goals: list[Float64[np.ndarray, "_ 2"]]
) -> tuple[Action | None, Plan]:
    """The next action on the path to the goal area, or from its edge into it."""
    navigator, grid, robot = step.components.navigator, step.grid, step.robot
    action, route = navigator.towards(plan.approaching.route, grid, robot, *goals)
    plan = plan.approach(route=route)
    if action is not None or not route.arrived or not step.config.enter_fully:
        return action, plan
    points = target.area.inner_entry_points
    action, inside = navigator.towards(plan.approaching.inside, grid, robot, points)
    path = inside.path
    is_near = path is not None and path.is_sure and path.length_m < _CLOSE_BY_M
    return action if is_near else None, plan.approach(inside=inside)


def _may_open_path(step: Step, memory: Memory, plan: Plan) -> bool:
    """Whether to open a path to the target: it is convincing, or nothing else is left."""
    is_believed = is_convincing(memory.search.evidence, step.components.local.config)
    return step.config.open_the_way and (is_believed or plan.approaching.as_near_as_possible)


def _open_way(
    step: Step, plan: Plan, points: Float64[np.ndarray, "n 2"]
) -> tuple[Decision | None, Plan]:
    """Go to the next gap that may be wider than the map shows, and look at it from near.

    The gap is on the path to points of the goal area and beside it, ``(x, y)``, metres. No decision
    if no gap is left or three were found closed in this step.
    """
    navigator, robot, grid = step.components.navigator, step.robot, step.grid
    for _ in range(_GAPS_PER_STEP):
        opening = plan.approaching.opening
        if opening is None:
            gap = navigator.gap_towards(grid, robot, points, plan.approaching.closed)
            if gap is None:
                return None, plan
            opening = Opening(gap)
        gap, steps = opening.gap, opening.steps + 1
        if steps <= step.config.endurance_steps:
            action, route = navigator.towards(opening.route, grid, robot, np.array([gap.look_from]))
            if action is None:
                action = turn_towards(robot, gap.position, step.motion)
            if action is not None:
                plan = plan.approach(opening=replace(opening, route=route, steps=steps))
                reason = f"looking from near for a way to {step.goal.in_sentence}"
                return Decision(action, Mode.APPROACH, reason, route.remaining(robot)), plan
        step.events.append(Event.GAP_CLOSED)
        closed = (*plan.approaching.closed, gap.position)
        plan = plan.approach(opening=None, closed=closed)
    return None, plan


def _goals(
    step: Step, memory: Memory, plan: Plan, target: Candidate, *, opens: bool
) -> list[Float64[np.ndarray, "_ 2"]]:
    """Sets of positions to go to, ``(x, y)``, ``map`` frame, metres, in the order of preference."""
    config, goals = step.config, [target.entry_points]
    if not (config.enter_in_sight or opens):
        return goals
    around = np.concatenate([target.area.entry_points, target.area.seen_points])
    widest_m = max(config.approach_gap_m, *_WIDER_M)
    corners = np.array([around.min(axis=0) - widest_m, around.max(axis=0) + widest_m])
    eye_level = memory.floor.map.eye_level(corners)
    if config.enter_in_sight:
        in_sight = target.entry_points_in_sight(eye_level)
        if 0 < len(in_sight) < len(goals[0]):
            goals.insert(0, in_sight)
    if not opens:
        return goals
    must_do = plan.approaching.as_near_as_possible
    nearest_m = config.approach_gap_m / 3.0
    gaps_m = (nearest_m, config.approach_gap_m, *(_WIDER_M if must_do else ()))
    beside = [target.points_beside_in_sight(eye_level, gap_m) for gap_m in gaps_m]
    goals += [points for points in beside if len(points)]
    if plan.approaching.steps_run_out and len(target.views_beside):
        goals.append(target.views_beside)
    return goals


def _without_exploration(step: Step, plan: Plan) -> Plan:
    if plan.destination is not None:
        step.events.append(Event.GOAL_SEEN)
    return plan.without_exploration()


def _distance_m(position: tuple[float, float], points: Float64[np.ndarray, "n 2"]) -> float:
    return float(np.linalg.norm(points - np.array(position), axis=1).min())
