"""The way to a place that the operator chose, over the map of the search."""

from dataclasses import replace

import numpy as np

from hypernav.core.exploring.operator_place import PlaceState
from hypernav.core.trace import Mode
from hypernav.search.agents.plan import Plan
from hypernav.search.agents.step import Decision, Step
from hypernav.search.memory.memory import Memory

_BESIDE_M = 1.0
"""Distance from the place, metres, of a position that stands in for one that can't be entered."""


def go_to(step: Step, memory: Memory, plan: Plan) -> tuple[Decision | None, Plan]:
    """Drive to the place that the operator chose; there, look at what is unseen around it.

    The end is named as an event. Other floors have no path.

    Returns:
        No decision if there is no such place, or the way there has ended; then the search goes on.
    """
    sent, navigator, robot = plan.sent, step.components.navigator, step.robot
    if sent is None:
        return None, plan
    nearest, state = None, PlaceState.NO_PATH
    with step.clock("plan"):
        if sent.place.floor == memory.number + 1:
            nearest = navigator.nearest_known(step.grid, robot, sent.place.xy, _BESIDE_M)
        if nearest is not None:
            targets = np.array([nearest])
            action, route = navigator.towards(sent.route, step.grid, robot, targets)
            patience = sent.patience.after(route.left_m(robot), len(route.actions))
            if action is not None and patience.lasts:
                reason = "going to the place that the operator chose"
                decision = Decision(action, Mode.EXPLORE, reason, route.remaining(robot))
                return decision, replace(plan, sent=replace(sent, patience=patience, route=route))
            if action is not None:
                state = PlaceState.NO_PROGRESS
            elif route.arrived:
                state = PlaceState.REACHED
    step.events.append(state.event)
    plan = replace(plan, sent=None)
    if state is PlaceState.REACHED:
        plan = replace(plan, turns_left=step.motion.turns_of_a_circle, full_turn=False)
    return None, plan
