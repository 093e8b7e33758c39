"""A closer look at gaps on the way to a goal that no path leads to."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float64

from hypernav.agents.plan import Opening, Plan
from hypernav.agents.step import Decision, Step, turn_towards
from hypernav.core.trace import Mode

_GAPS_PER_STEP = 3


def open_way(
    step: Step, plan: Plan, points: Float64[np.ndarray, "n 2"]
) -> tuple[Decision | None, Plan]:
    """Go to the next gap that may be wider than the map shows, and look at it from near.

    Args:
        step: The present step.
        plan: Plan whose approach has no path.
        points: Points of the goal area and beside it, ``(x, y)``, ``map`` frame, metres.

    Returns:
        The decision, None if no gap is left or if three were found closed in this step; the plan.
    """
    navigator, robot, grid = step.use.navigator, step.robot, step.grid
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
                reason = f"looking from near for a way to the {step.goal.thing}"
                return Decision(action, Mode.APPROACH, reason, route.remaining(robot)), plan
        step.events.append("gap closed")
        closed = (*plan.approaching.closed, gap.position)
        plan = plan.approach(opening=None, closed=closed)
    return None, plan
