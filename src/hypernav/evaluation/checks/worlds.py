"""The checker of the contract ``hypernav/ObjectNav-v0``."""

import math
import warnings
from dataclasses import fields
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.utils.env_checker import check_env

from hypernav.core.embodiment import Action
from hypernav.core.episode import EpisodeMetrics
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.transforms import wrap_angle
from hypernav.evaluation.checks.faults import Faults, While

_KEYS = ("rgb", "depth", "pose", "goal")
_SAME_M = 0.05
_SAME_RAD = math.radians(3.0)
_MOST_TURNS = 360
_EXPLORED = 40


def check_world(env: Any, *, seed: int = 0) -> None:
    """Check a world against the contract of object-goal navigation, and list what breaks it.

    The world is a Gymnasium environment like `hypernav.build.env.ObjectNavEnv`: observations
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
