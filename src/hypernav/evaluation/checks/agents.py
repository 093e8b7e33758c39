"""The checker of the contract `hypernav.core.components.protocols.Agent`."""

from dataclasses import replace
from typing import Any

import numpy as np

from hypernav.core.components.abilities import BuiltForRobot
from hypernav.core.components.protocols import ExplainsItself
from hypernav.core.embodiment import Action
from hypernav.core.errors import LabelsMissingError
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import Ending, StepTrace
from hypernav.evaluation.checks.faults import Faults, While
from hypernav.worlds.box_room import DOOR, BoxRoom

_ACTIONS = ", ".join(action.name for action in Action)


def check_agent(agent: Any, *, goal: str = DOOR, steps: int = 30, repeatable: bool = True) -> None:
    """Check an agent against its contract, and list in words what breaks it.

    The agent searches an empty room with a door, which needs no simulator. It must answer every
    observation with an `Action`, not change observations, accept an image without any depth, forget
    everything at `reset`, and, if it has a trace and a map, keep them consistent.

    Args:
        agent: The agent, with ``reset(goal)`` and ``act(observation)``.
        goal: Text of the goal that it is given.
        steps: Number of steps that it is tried for.
        repeatable: Whether the same search must take the same actions again. An agent that draws
            random numbers keeps this if `reset` seeds them; evaluation needs it, since episodes run
            in any order.

    Raises:
        ContractError: The agent breaks the contract; the message lists all faults. Errors that the
            agent itself raises are not caught, but get a note that says when they happened.
    """
    faults = Faults()
    name = type(agent).__name__
    for method in ("reset", "act"):
        faults.expect(
            callable(getattr(agent, method, None)),
            f"it has no method {method}; an agent has reset(goal) and act(observation)",
        )
    faults.raise_if_any(name)
    first = _search(agent, goal, steps, faults)
    if not faults.found:
        second = _search(agent, goal, steps, faults)
        differ = [k for k, (a, b) in enumerate(zip(first, second, strict=False)) if a is not b]
        faults.expect(
            not repeatable or (not differ and len(first) == len(second)),
            f"the same search took another action the second time, first at step "
            f"{differ[0] if differ else min(len(first), len(second))}: reset must forget "
            "everything and seed whatever is drawn at random",
        )
        _see_nothing(agent, goal, faults)
    faults.raise_if_any(name)


def _room_for(agent: Any) -> BoxRoom:
    """The room with the agent's own robot, if the agent was built for one."""
    return BoxRoom(embodiment=agent.embodiment) if isinstance(agent, BuiltForRobot) else BoxRoom()


def _search(agent: Any, goal: str, steps: int, faults: Faults) -> list[Action | None]:
    """One search; returns the actions up to the first result that is not an action."""
    room, actions = _room_for(agent), list[Action | None]()
    with While("called reset(goal)"):
        agent.reset(Goal(goal))
    for step in range(steps):
        observation = room.observe()
        with While(f"called act(observation) at step {step}"):
            action = _act(agent, observation, faults)
        if faults.found:
            break
        _check_explanation(agent, step, observation, action, faults)
        actions.append(action)
        if action is None or action is Action.STOP:
            break
        room.step(action)
    return actions


def _act(agent: Any, observation: Observation, faults: Faults) -> Action | None:
    before = (observation.rgb.copy(), observation.depth.copy())
    action = agent.act(observation)
    unchanged = all(
        np.array_equal(a, b)
        for a, b in zip(before, (observation.rgb, observation.depth), strict=True)
    )
    faults.expect(
        unchanged, "act changed the observation's images; work on a copy, others read them too"
    )
    if action is None or isinstance(action, Action):
        return action
    hint = ""
    if isinstance(action, int | np.integer) and int(action) in set(Action):
        hint = f"; return Action({int(action)})"
    faults.expect(
        False, f"act returned {action!r}, expected an Action ({_ACTIONS}), or None to give up{hint}"
    )
    return None


def _see_nothing(agent: Any, goal: str, faults: Faults) -> None:
    """Check that the agent accepts an image without depth, and one without labels."""
    seen = replace(_room_for(agent), labels=False).observe()
    with While("called reset(goal)"):
        agent.reset(Goal(goal))
    try:
        with While("called act with an observation that has no labels and no depth at all"):
            _act(agent, replace(seen, depth=np.zeros_like(seen.depth)), faults)
    except LabelsMissingError:
        return  # An agent that works only in simulated worlds refuses in this way.


def _check_explanation(
    agent: Any, step: int, observation: Observation, action: Action | None, faults: Faults
) -> None:
    """Check that the trace of a step agrees with the step."""
    if not isinstance(agent, ExplainsItself):
        halves = [name for name in ("last_step", "grid") if hasattr(agent, name)]
        faults.expect(
            not halves,
            f"it has {' and '.join(halves)} alone; an agent that explains itself has both "
            "last_step and grid",
        )
        return
    trace, grid = agent.last_step, agent.grid
    if not faults.expect(
        isinstance(trace, StepTrace), f"last_step is {trace!r:.60}, expected a StepTrace"
    ):
        return
    faults.expect(
        trace.action is action,
        f"last_step.action is {trace.action!r}, but act returned {action!r}",
    )
    faults.expect(
        trace.ending is Ending.of(action),
        f"last_step.ending is {trace.ending!r} where act returned {action!r}, expected "
        f"{Ending.of(action)!r}: STOP says that the goal is here, None gives up",
    )
    faults.expect(
        trace.step == step,
        f"last_step.step is {trace.step} after {step + 1} calls, expected {step}",
    )
    robot = observation.robot
    pose = np.array([robot.x, robot.y, robot.yaw])
    faults.expect(
        bool(np.allclose(trace.pose, pose, atol=1e-6)),
        f"last_step.pose is {trace.pose}, but the observation's robot was at {tuple(pose)}",
    )
    faults.expect(
        isinstance(grid, OccupancyGrid), f"grid is {type(grid).__name__}, expected an OccupancyGrid"
    )
