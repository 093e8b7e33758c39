"""The check at the goal area, and a second look from another side, before the robot stops."""

import math

import numpy as np
from jaxtyping import Bool, Float64

from hypernav.core.embodiment import Action
from hypernav.core.events import Event
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.trace import Ending, Mode
from hypernav.search.agents.plan import Plan
from hypernav.search.agents.step import Decision, Phase, Step, turn_towards
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.reachable_area import ReachableArea
from hypernav.search.memory.candidate import Candidate
from hypernav.search.memory.goal_area import GoalArea
from hypernav.search.memory.memory import Memory
from hypernav.search.perception.local.belief import (
    confirmed,
    is_convincing,
    needs_second_look,
    rejected,
    with_position_barred,
)

_OTHER_SIDE_DEG = 60.0
"""Smallest angle between the first and the second position, seen from the target, degrees."""
_NEAREST_M, _FARTHEST_M = 1.5, 3.0
"""Distances to the target's middle, metres, at which it fits into the image and is large there."""
_APART_CELLS = 4
"""Spacing of the positions that are tried, cells."""

_AS_NEAR_AS_M = 0.3
"""Distance, metres, at which the robot is near enough to a goal whose outline was guessed."""


def position_on_other_side(
    grid: OccupancyGrid,
    robot: Pose2,
    area: GoalArea,
    seen_from: tuple[float, float],
    mapping: MappingConfig,
    clearance_m: float,
) -> tuple[float, float] | None:
    """The nearest position that shows a goal area from another side.

    Args:
        grid: The map.
        robot: Pose of the robot.
        area: Goal area of the target.
        seen_from: Position ``(x, y)`` of the robot in the first look, ``map`` frame, metres.
        mapping: Configuration of the map.
        clearance_m: Distance from obstacles that the robot's middle keeps, metres.

    Returns:
        ``(x, y)``, ``map`` frame, metres; None if no such position can be reached.
    """
    reach = ReachableArea.of(grid, robot, mapping, clearance_m)
    cells = np.argwhere(reach.reachable)
    cells = cells[(cells % _APART_CELLS == 0).all(axis=1)]
    positions = reach.grid.centres_of(cells)
    away = positions - np.array(area.centre)
    distance = np.hypot(away[:, 0], away[:, 1])
    before = np.array(seen_from) - np.array(area.centre)
    cosine = away @ before / np.maximum(distance * np.hypot(*before), 1e-9)
    good = (distance >= _NEAREST_M) & (distance <= _FARTHEST_M)
    good &= cosine <= math.cos(math.radians(_OTHER_SIDE_DEG))
    good[good] = _in_sight(reach.grid, positions[good], area)
    if not good.any():
        return None
    travel_m = reach.travel_m[cells[:, 0], cells[:, 1]]
    x, y = positions[int(np.where(good, travel_m, np.inf).argmin())]
    return (float(x), float(y))


def _in_sight(
    grid: OccupancyGrid, positions: Float64[np.ndarray, "n 2"], area: GoalArea
) -> Bool[np.ndarray, "n"]:
    """Whether each position sees the middle of an area, hidden by nothing but the area itself."""
    hides = grid.occupied & ~grid.mask_of(area.points)
    steps = math.ceil(_FARTHEST_M / grid.resolution_m)
    share = np.linspace(0.0, 1.0, steps)[None, :, None]
    middle = np.array(area.centre)
    rays = grid.cells_of(
        (positions[:, None] + share * (middle - positions[:, None])).reshape(-1, 2)
    )
    known = grid.contains(rays)
    hidden = np.zeros(len(rays), dtype=bool)
    hidden[known] = hides[rays[known, 0], rays[known, 1]]
    return np.logical_not(hidden.reshape(len(positions), steps).any(axis=1))


def with_second_look(step: Step, plan: Plan, target: Candidate) -> Plan:
    """The plan with a second look, if a position on another side of the target can be reached."""
    with step.clock("verify"):
        position = position_on_other_side(
            step.grid,
            step.robot,
            target.area,
            target.best_view.robot.xy,
            step.components.mapping,
            step.components.planning.clearances_m(step.components.embodiment.body)[0],
        )
    if position is not None:
        step.events.append(Event.SECOND_LOOK_WANTED)
    return plan.approach(second_look=position, second_look_steps=0)


def second_look(step: Step, memory: Memory, plan: Plan) -> tuple[Decision | Phase, Plan]:
    """Drive to the other side, face the target, then approach or reject it by the images."""
    target, position = memory.search.evidence.target, plan.approaching.second_look
    if target is None or position is None:
        return Phase.EXPLORE, plan
    robot, config, goal = step.robot, step.config, step.goal.in_sentence
    steps = plan.approaching.second_look_steps + 1
    plan = plan.approach(second_look_steps=steps)
    if steps <= config.endurance_steps:
        with step.clock("plan"):
            action, route = step.components.navigator.towards(
                plan.approaching.route, step.grid, robot, np.array([position])
            )
        plan = plan.approach(route=route)
        if action is not None:
            reason = f"is it really {goal}? going to look from another side"
            return Decision(action, Mode.VERIFY, reason, route.remaining(robot)), plan
    turn = turn_towards(robot, target.area.centre, step.motion)
    if turn is not None:
        reason = f"turning to face {goal} from another side"
        path = plan.approaching.route.remaining(robot)
        return Decision(turn, Mode.VERIFY, reason, path), plan
    plan = plan.approach(second_look=None).with_new_patience(config)
    evidence, local = confirmed(memory.search.evidence), step.components.local.config
    if is_convincing(evidence, local):
        memory.search.evidence = evidence
        return Phase.APPROACH, plan
    step.events.append(Event.AREA_REJECTED)
    memory.search.evidence = rejected(evidence, local)
    return Phase.EXPLORE, plan


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
        reason = f"turning to face {step.goal.in_sentence}"
        path = plan.approaching.route.remaining(step.robot)
        return Decision(turn, Mode.VERIFY, reason, path), plan
    if is_sure:
        if _goes_nearer(step, target):
            reason = f"here is {step.goal.in_sentence}, going nearer"
            return Decision(Action.MOVE_FORWARD, Mode.APPROACH, reason), plan
        return _stop(step), plan
    if config.see_before_stop:
        barred = with_position_barred(search.evidence, step.observation)
        if barred is not None:
            search.evidence = barred
            step.events.append(Event.AREA_NOT_IN_SIGHT)
            return Phase.APPROACH, plan.with_new_patience(config)
    local = step.components.local.config
    if needs_second_look(search.evidence, local):
        plan = with_second_look(step, plan, target)
        if plan.approaching.second_look is not None:
            return Phase.SECOND_LOOK, plan
    with step.clock("verify"):
        present = _is_present(step, memory, target)
    if present:
        return Phase.VERIFY, plan.approach(sure_step=step.number)
    step.events.append(Event.AREA_REJECTED)
    for_good = is_convincing(search.evidence, local)
    search.evidence = rejected(search.evidence, local, for_good=for_good)
    return Phase.EXPLORE, plan.with_new_patience(config)


def _is_still_sure(step: Step, memory: Memory, plan: Plan) -> bool:
    """Whether the check held in this step or the last, and the candidate is still convincing."""
    said, evidence = plan.approaching.sure_step, memory.search.evidence
    is_recent = said is not None and step.number - said <= 1
    return is_recent and is_convincing(evidence, step.components.local.config)


def _stop(step: Step) -> Decision:
    step.events.append(Event.GOAL_REACHED)
    reason = f"here is {step.goal.in_sentence}"
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
    return step.components.navigator.is_open(step.grid, robot, ahead)


def _is_present(step: Step, memory: Memory, target: Candidate) -> bool:
    if not is_convincing(memory.search.evidence, step.components.local.config):
        return False
    view = target.best_view if step.config.verify_view == "best" else step.observation
    presence = step.components.presence
    return presence is None or presence.is_present(view, step.goal)
