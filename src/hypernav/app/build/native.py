"""Native mode: a published method with its own camera, step and stop, as far as they are known.

The episodes and the referee are those of common mode. A difference between the two modes could not
be interpreted, so they never share a table.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from hypernav.app.build.presets import ARROWS_AS_RELEASED, HyPerNavConfig
from hypernav.core.errors import ConfigError

_LOOKING_DOWN: dict[str, Any] = {
    "embodiment": {
        "camera": {
            "width": 960,
            "height": 540,
            "hfov_deg": 131.0,
            "height_m": 1.5,
            "pitch_deg": 25.8,
            "min_depth_m": 0.0,
            "max_depth_m": 10.0,
        },
        # A tenth of the longest move, and any direction to 2.5 degrees.
        "motion": {"forward_m": 0.17, "turn_angle_deg": 5.0},
    },
    "world": {"sliding": True},
}
"""VLMnav's robot. Ours: half the published number of pixels in both directions, 10 m of depth, and
the length of the actions that its moves are made of."""
_NAVVLM: dict[str, Any] = {
    "embodiment": {
        "camera": {"width": 640, "height": 480, "hfov_deg": 90.0, "height_m": 1.1},
        "motion": {"forward_m": 0.3, "turn_angle_deg": 30.0},
    },
    "world": {"sliding": True},
    "search": {"look_around_at_start": False, "use_stairs": False},
}


def _vlfm(base: HyPerNavConfig) -> dict[str, Any]:
    return {
        "embodiment": {
            "camera": {
                **{"width": 640, "height": 480, "hfov_deg": 79.0},
                **{"height_m": 0.88, "pitch_deg": 0.0},
            },
            "motion": {"forward_m": 0.25, "turn_angle_deg": 30.0},
        },
        "world": {"sliding": False},
        "search": {
            "look_around_at_start": True,
            "finish_first_look": True,
            "least_unseen_m2": None,
            # Its 0.9 m are measured to the goal itself, ours to the area around it.
            **dict.fromkeys(("stop_distance_m", "approach_gap_m"), 0.9 - _rim_m(base)),
            "face_target": False,
            "see_before_stop": False,
            "enter_in_sight": False,
            "enter_fully": False,
            "go_nearer": False,
            "open_the_way": False,
            "use_stairs": False,
        },
        "presence": {"enabled": False},
    }


def _rim_m(config: HyPerNavConfig) -> float:
    """Width of the rim that is dilated around a goal, metres."""
    local = config.local
    return local.dilation_kernel // 2 * local.dilation_iterations * config.mapping.cell_size_m


@dataclass(frozen=True)
class _NativeMethod:
    """The published values of a method.

    Attributes:
        step_limit: Number of steps after which its searches end.
        changes: Values that differ from a configuration of common mode.
    """

    step_limit: int
    changes: Callable[[HyPerNavConfig], dict[str, Any]]


_METHODS = {
    "vlfm": _NativeMethod(500, _vlfm),
    "navvlm": _NativeMethod(400, lambda _: _NAVVLM),
    "vlmnav": _NativeMethod(2000, lambda _: _LOOKING_DOWN | {"arrows": ARROWS_AS_RELEASED}),
    "pivot": _NativeMethod(2000, lambda _: _LOOKING_DOWN | {"arrows": ARROWS_AS_RELEASED}),
}
"""Methods that have a native mode. Limits of the last two are in short steps and large enough that
`PromptedConfig` ends their searches first."""


def step_limit_of(agent: str) -> int:
    """The number of steps after which a method's searches end in native mode.

    Raises:
        ConfigError: The agent has no native mode.
    """
    if agent not in _METHODS:
        raise ConfigError(
            f"--native: {agent} has no robot or stop of its own; known are those of "
            f"{', '.join(_METHODS)}; drop --native"
        )
    return _METHODS[agent].step_limit


def native_config(agent: str, base: HyPerNavConfig) -> HyPerNavConfig:
    """A configuration with the camera, step and stop that were published for an agent.

    Args:
        agent: Name of the agent.
        base: Configuration to change.

    Raises:
        ConfigError: The agent has no native mode.
    """
    step_limit_of(agent)
    eye_m = base.world.judge_eye_m or base.embodiment.camera.height_m
    judged_as_before = base.world.model_copy(update={"judge_eye_m": eye_m})
    judged = base.model_copy(update={"world": judged_as_before})
    return judged.with_(**_METHODS[agent].changes(base))


def check_native_robot(config: HyPerNavConfig) -> None:
    """Refuse an agent in native mode with the robot of common mode, which would be neither mode.

    Raises:
        ConfigError: The configuration was not made by `native_config`.
    """
    # `native_config` sets this; setting it by hand is accepted as well.
    if config.world.judge_eye_m is None:
        raise ConfigError(
            "native=True needs the robot that was published with the agent, and this configuration "
            "has the one of common mode: make it by hypernav.native_config(agent, configuration)"
        )
