"""habitat-lab's ObjectNav as a Gymnasium environment, ``hypernav/HabitatObjectNav-v0``."""

from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
from jaxtyping import UInt8

from hypernav.core.errors import WorldError
from hypernav.lab.evaluation.habitat_lab.env import HabitatEnv
from hypernav.lab.evaluation.habitat_lab.task import HabitatTask
from hypernav.lab.evaluation.run_plan import RunPlan


class HabitatGymEnv(gymnasium.Env[dict[str, Any], Any]):
    """`hypernav.HabitatEnv` for Gymnasium.

    Replaces habitat-lab's ``RLTaskEnv`` and ``make_gym_from_config``, with Gymnasium's results of
    `reset` and `step`. STOP terminates an episode, the step limit truncates it. The reward is
    habitat-lab's: the decrease of the distance to the goal, metres, plus `HabitatTask.slack_reward`
    and, if SPL is not 0, `HabitatTask.success_reward`. ``info`` holds the measures.

    `reset` begins the next episode, and with a seed the first one again.
    """

    # Gymnasium declares it as an attribute of instances.
    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 10}  # noqa: RUF012

    def __init__(
        self,
        config: str | RunPlan | Mapping[str, Any],
        task: HabitatTask | None = None,
        *,
        render_mode: str | None = None,
    ) -> None:
        """Read the episodes.

        Args:
            config: As for `hypernav.HabitatEnv`.
            task: As for `hypernav.HabitatEnv`.
            render_mode: "rgb_array" or None.

        Raises:
            ConfigError: The configuration asks for something that doesn't exist here.
            EpisodeError: There is no such data set, or nothing in it is chosen.
            SceneError: A scene cannot be used.
            WorldError: The render mode doesn't exist.
        """
        if render_mode not in (None, "rgb_array"):
            raise WorldError(f"render_mode must be 'rgb_array' or None, got {render_mode!r}")
        self.render_mode = render_mode
        self.habitat_env: HabitatEnv = HabitatEnv(config, task)
        self.observation_space: gymnasium.Space[dict[str, Any]] = self.habitat_env.observation_space
        self.action_space: gymnasium.Space[Any] = self.habitat_env.action_space

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Begin an episode.

        Args:
            seed: Seed of all noise, and of the order if episodes are shuffled; None goes on.
            options: Not used.

        Raises:
            SceneError: The scene cannot be used.
            StartError: The robot can't stand at the start.
        """
        super().reset(seed=seed)
        if seed is not None:
            self.habitat_env.seed(seed)
        return self.habitat_env.reset(), self.habitat_env.get_metrics()

    def step(self, action: Any) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        """Take an action and observe.

        Raises:
            WorldError: There is no such action, or no running episode.
        """
        env = self.habitat_env
        observation = env.step(action)
        info = env.get_metrics()
        reward = env.task.slack_reward + info["distance_to_goal_reward"]
        if info["spl"]:
            reward += env.task.success_reward
        truncated = env.episode_over and not env.is_stop_called
        return observation, reward, env.is_stop_called, truncated, info

    def render(self) -> UInt8[np.ndarray, "height width 3"] | None:  # pyright: ignore[reportIncompatibleMethodOverride]
        """The camera image if the render mode is "rgb_array", else None."""
        return self.habitat_env.render() if self.render_mode == "rgb_array" else None

    def close(self) -> None:
        """Close the scene that is open."""
        self.habitat_env.close()
