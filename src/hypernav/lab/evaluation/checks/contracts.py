"""Checkers of contracts: of an `Agent`, and of the environment ``hypernav/ObjectNav-v0``."""

import math
import warnings
from collections.abc import Sequence
from dataclasses import fields, replace
from types import TracebackType
from typing import Any, Literal

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.utils.env_checker import check_env

from hypernav.core.components.abilities import BuiltForRobot
from hypernav.core.components.protocols import ExplainsItself
from hypernav.core.embodiment import Action
from hypernav.core.episode import EpisodeMetrics
from hypernav.core.errors import ContractError, LabelsMissingError
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import wrap_angle
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import Ending, StepTrace
from hypernav.simulator.worlds.box_room import DOOR, BoxRoom


class Faults:
    """Collects faults, so that one error lists them all."""

    def __init__(self) -> None:
        """Begin without faults."""
        self.found: list[str] = []

    def expect(self, holds: bool, fault: str) -> bool:
        """Add a fault unless a condition holds; return whether it holds."""
        if not holds and fault not in self.found:
            self.found.append(fault)
        return holds

    def raise_if_any(self, what: str) -> None:
        """Raise one error that lists all faults.

        Raises:
            ContractError: There are faults.
        """
        if self.found:
            raise ContractError(f"{what} breaks its contract: {_listed(self.found)}")


class While:
    """Adds a note to an error raised in the ``with`` block: what the checker was doing."""

    def __init__(self, where: str) -> None:
        """Say what the checker does in the block, for example "called reset(goal)"."""
        self._where = where

    def __enter__(self) -> None:
        """Enter the block."""

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> Literal[False]:
        """Add the note."""
        if error is not None:
            error.add_note(f"raised while the checker {self._where}")
        return False


def _listed(faults: Sequence[str]) -> str:
    if len(faults) == 1:
        return faults[0]
    return "".join(f"\n  {number}. {fault}" for number, fault in enumerate(faults, 1))


_ACTIONS = ", ".join(action.name for action in Action)


def check_agent(agent: Any, *, goal: str = DOOR, steps: int = 30, repeatable: bool = True) -> None:
    """Check an agent against its contract, and list in words what breaks it.

    The agent searches an empty room with a door, which needs no simulator. It must answer every
    observation with an `Action` or None, not change observations, accept an image without any
    depth, forget everything at `reset`, and, if it has a trace and a map, keep them consistent.

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
        trace.action is action, f"last_step.action is {trace.action!r}, but act returned {action!r}"
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


_KEYS = ("rgb", "depth", "pose", "goal")
_SAME_M = 0.05
_SAME_RAD = math.radians(3.0)
_MOST_TURNS = 360
_EXPLORED = 40


def check_world(env: Any, *, seed: int = 0) -> None:
    """Check a world against the contract of object-goal navigation, and list what breaks it.

    The world is a Gymnasium environment like `hypernav.app.build.env.ObjectNavEnv`: observations
    with ``rgb``, ``depth`` (float32 metres, 0 where there is no return), ``pose`` (x forward, y
    left, yaw counter-clockwise, from the start pose) and ``goal``; Habitat's four actions; STOP
    ends an episode; ``info`` carries the measures. Gymnasium's own checker runs last. That the
    depth is measured along the optical axis, not along each ray, cannot be told from outside.

    Args:
        env: The world; the check resets it and moves its robot.
        seed: Seed of the episodes.

    Raises:
        ContractError: The world breaks the contract; the message lists all faults. Errors that the
            world itself raises are not caught, but get a note that says when they happened.
    """
    faults = Faults()
    name = type(getattr(env, "unwrapped", env)).__name__
    faults.expect(
        isinstance(env, gymnasium.Env),
        "it is no gymnasium.Env; wrap it: reset(seed=, options=) gives (observation, info), "
        "step(action) gives (observation, reward, terminated, truncated, info)",
    )
    faults.raise_if_any(name)
    _check_spaces(env, faults)
    faults.raise_if_any(name)
    driver = _Driver(env, seed, faults)
    driver.check_start()
    driver.check_turning()
    driver.check_walking()
    driver.check_stop()
    faults.raise_if_any(name)
    _check_as_gymnasium_does(env, faults)
    faults.raise_if_any(name)


def _check_spaces(env: Any, faults: Faults) -> None:
    space = env.observation_space
    if faults.expect(isinstance(space, spaces.Dict), f"its observation space is {space}, no Dict"):
        missing = [key for key in _KEYS if key not in space.spaces]
        faults.expect(not missing, f"its observations lack {', '.join(missing)}")
        if not missing:
            rgb, depth = space["rgb"], space["depth"]
            faults.expect(
                rgb.dtype == np.uint8 and rgb.shape is not None and rgb.shape[-1:] == (3,),
                f"rgb is {rgb}, expected uint8 of (height, width, 3)",
            )
            faults.expect(
                depth.dtype == np.float32
                and rgb.shape is not None
                and depth.shape == rgb.shape[:2],
                f"depth is {depth}, expected float32 metres of the same size as rgb",
            )
    actions = env.action_space
    faults.expect(
        isinstance(actions, spaces.Discrete) and int(actions.n) == len(Action),
        f"its actions are {actions}, expected Discrete(4): STOP, forward, left, right",
    )


def _check_as_gymnasium_does(env: Any, faults: Faults) -> None:
    with warnings.catch_warnings(), While("ran Gymnasium's own checker"):
        warnings.simplefilter("ignore")
        try:
            check_env(env.unwrapped, skip_render_check=True, skip_close_check=True)
        except (AssertionError, gymnasium.error.Error) as error:
            faults.expect(False, f"Gymnasium's own checker says: {error}")


class _Driver:
    """Moves the robot of a world and compares observations with the contract."""

    def __init__(self, env: Any, seed: int, faults: Faults) -> None:
        self._env, self._seed, self._faults = env, seed, faults

    def check_start(self) -> None:
        expect = self._faults.expect
        first, _ = self._reset()
        again, _ = self._reset()
        same = all(np.array_equal(first[key], again[key]) for key in _KEYS)
        expect(same, "two resets with the same seed differ; draw only from env.np_random")
        expect(
            bool(np.allclose(first["pose"], 0.0, atol=1e-6)),
            f"the first pose is {first['pose']}, expected (0, 0, 0): the map frame starts at the "
            "start pose",
        )
        expect(bool(str(first["goal"]).strip()), "the goal is empty")

    def check_turning(self) -> None:
        expect = self._faults.expect
        start, _ = self._reset()
        left = self._step(Action.TURN_LEFT)
        turned = wrap_angle(float(left["pose"][2] - start["pose"][2]))
        if not expect(
            turned > 0.0,
            f"TURN_LEFT changed the yaw by {math.degrees(turned):.1f}°, expected more than 0: yaw "
            "is radians, counter-clockwise",
        ):
            return
        expect(
            _moved(start, left) < _SAME_M, f"TURN_LEFT moved the robot {_moved(start, left):.2f} m"
        )
        back = self._step(Action.TURN_RIGHT)
        gap = abs(wrap_angle(float(back["pose"][2] - start["pose"][2])))
        expect(
            gap < _SAME_RAD,
            f"TURN_LEFT and TURN_RIGHT end {math.degrees(gap):.1f}° from where they began",
        )
        count = min(round(2.0 * math.pi / turned), _MOST_TURNS)
        for _ in range(count):
            back = self._step(Action.TURN_LEFT)
        gap = abs(wrap_angle(float(back["pose"][2] - start["pose"][2])))
        expect(
            gap < count * _SAME_RAD,
            f"{count} turns of {math.degrees(turned):.0f}° end {math.degrees(gap):.0f}° off",
        )

    def check_walking(self) -> None:
        expect = self._faults.expect
        before, info = self._reset()
        rng = np.random.default_rng(self._seed)
        walked, driven = float(info.get("path_length_m", 0.0)), 0.0
        for _ in range(_EXPLORED):
            action = Action.MOVE_FORWARD if rng.random() < 0.6 else Action.TURN_LEFT
            seen = self._step(action)
            length = _moved(before, seen)
            driven += length
            if action is Action.MOVE_FORWARD and length > _SAME_M:
                motion = seen["pose"][:2] - before["pose"][:2]
                heading = float(before["pose"][2])
                aside = abs(wrap_angle(math.atan2(motion[1], motion[0]) - heading))
                expect(
                    aside < math.pi / 2.0,
                    f"MOVE_FORWARD went {math.degrees(aside):.0f}° beside the robot's heading; x "
                    "is forward and y is left",
                )
            before = seen
            if self._over:
                break
        length_m = float(self._info.get("path_length_m", math.nan)) - walked
        expect(driven > 0.0, f"{_EXPLORED} actions did not move the robot at all")
        expect(
            abs(length_m - driven) <= 0.1 * driven + _SAME_M,
            f"info's path_length_m grew by {length_m:.2f} m while the poses moved {driven:.2f} m",
        )
        expect(not self._info.get("success", False), "success without STOP")

    def check_stop(self) -> None:
        expect = self._faults.expect
        _, info = self._reset()
        expected = [field.name for field in fields(EpisodeMetrics)]
        missing = [key for key in expected if key not in info]
        expect(not missing, f"info lacks {', '.join(missing)}")
        self._step(Action.STOP)
        expect(self._terminated, "STOP did not terminate the episode")

    def _reset(self) -> tuple[dict[str, Any], dict[str, Any]]:
        with While(f"called reset(seed={self._seed})"):
            seen, self._info = self._env.reset(seed=self._seed)
        self._check_images(seen)
        self._over = False
        return seen, self._info

    def _step(self, action: Action) -> dict[str, Any]:
        with While(f"called step({int(action)}), {action.name}"):
            seen, _, self._terminated, truncated, self._info = self._env.step(int(action))
        self._check_images(seen)
        self._over = bool(self._terminated or truncated)
        return seen

    def _check_images(self, seen: dict[str, Any]) -> None:
        depth = np.asarray(seen["depth"])
        self._faults.expect(
            bool((is_measured(depth) | (depth == 0.0)).all()),
            "depth holds negative, infinite or NaN values; 0 says that there is no return",
        )


def _moved(before: dict[str, Any], after: dict[str, Any]) -> float:
    return math.dist(before["pose"][:2], after["pose"][:2])
