"""Native mode: a published method with its own camera, step and stop, as far as they are known.

The episodes and the referee are those of common mode; what a difference between the two modes means
nobody can tell, so they never share a table.
"""

from typing import Any

from hypernav.build.presets import HyPerNavConfig, with_changes
from hypernav.core.errors import ConfigError

_STEP_LIMITS = {"vlfm": 500, "navvlm": 400, "vlmnav": 2000, "pivot": 2000}
"""Step limits of the methods that have a native mode. Those of the last two are in short steps, so
that `PromptedConfig` ends their searches: no 40 moves take more."""

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
_AS_DRAWN = {"marks": {"slide": False}, "blind_step_m": 0.2}


def step_limit_of(agent: str) -> int:
    """The number of steps after which a method's searches end in native mode.

    Raises:
        ConfigError: The agent has no native mode.
    """
    if agent not in _STEP_LIMITS:
        raise ConfigError(
            f"--native: {agent} has no robot or stop of its own; known are those of "
            f"{', '.join(_STEP_LIMITS)}; drop --native"
        )
    return _STEP_LIMITS[agent]


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
    return with_changes(base.model_copy(update={"world": judged_as_before}), _changes(agent, base))


def check_native_robot(config: HyPerNavConfig) -> None:
    """Refuse an agent in native mode on the robot of common mode, which would be neither mode.

    Raises:
        ConfigError: The configuration was not made by `native_config`.
    """
    # Only native mode moves the camera away from the eye by which goals are judged.
    if config.world.judge_eye_m is None:
        raise ConfigError(
            "native=True needs the robot that was published with the agent, and this configuration "
            "has the one of common mode: make it by hypernav.native_config(agent, configuration)"
        )


def _changes(agent: str, base: HyPerNavConfig) -> dict[str, Any]:
    match agent:
        case "vlfm":
            return {
                "embodiment": {"motion": {"forward_m": 0.25, "turn_angle_deg": 30.0}},
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
                },
                "presence": {"enabled": False},
            }
        case "navvlm":
            return {
                "embodiment": {
                    "camera": {"width": 640, "height": 480, "hfov_deg": 90.0, "height_m": 1.1},
                    "motion": {"forward_m": 0.3, "turn_angle_deg": 30.0},
                },
                "world": {"sliding": True},
                "search": {"look_around_at_start": False},
            }
        case "vlmnav":
            return _LOOKING_DOWN | {"vlmnav": {"sight": _AS_DRAWN}}
        case _:
            return _LOOKING_DOWN | {"pivot": {"sight": _AS_DRAWN}}


def _rim_m(config: HyPerNavConfig) -> float:
    """Width of the rim that is dilated around a goal, metres."""
    local = config.local
    return local.dilation_kernel // 2 * local.dilation_iterations * config.mapping.cell_size_m
