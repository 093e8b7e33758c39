"""The loop of habitat-lab's ``habitat.Benchmark``.

Source: habitat-lab, ``habitat/core/benchmark.py``.
"""

from collections import defaultdict
from collections.abc import Mapping
from typing import Any, Protocol, runtime_checkable

from hypernav.core.errors import EpisodeError
from hypernav.lab.evaluation.habitat_lab.env import HabitatEnv
from hypernav.lab.evaluation.habitat_lab.task import HabitatTask
from hypernav.lab.evaluation.run_plan import RunPlan


@runtime_checkable
class HabitatAgent(Protocol):
    """The interface of habitat-lab's agents, ``habitat.Agent``."""

    def reset(self) -> None:
        """Begin an episode."""
        ...

    def act(self, observations: dict[str, Any]) -> Any:
        """The number or the name of an action, or a mapping with either as ``action``."""
        ...


class HabitatBenchmark:
    """Mean measures of an agent that was written for habitat-lab."""

    def __init__(
        self, config: str | RunPlan | Mapping[str, Any], task: HabitatTask | None = None
    ) -> None:
        """Read the episodes.

        Args:
            config: As for `hypernav.HabitatEnv`.
            task: As for `hypernav.HabitatEnv`.

        Raises:
            ConfigError: The configuration asks for something that doesn't exist here.
            EpisodeError: There is no such data set, or nothing in it is chosen.
            SceneError: A scene cannot be used.
        """
        self._env = HabitatEnv(config, task)

    def evaluate(self, agent: HabitatAgent, num_episodes: int | None = None) -> dict[str, float]:
        """The means of all measures over the first episodes.

        Args:
            agent: The agent.
            num_episodes: Number of episodes; None takes all.

        Raises:
            EpisodeError: There are fewer episodes.
        """
        env = self._env
        count = env.number_of_episodes if num_episodes is None else num_episodes
        if not 0 < count <= env.number_of_episodes:
            raise EpisodeError(f"num_episodes: expected 1 to {env.number_of_episodes}, got {count}")
        sums: dict[str, float] = defaultdict(float)
        for _ in range(count):
            observations = env.reset()
            agent.reset()
            while not env.episode_over:
                observations = env.step(agent.act(observations))
            for name, value in env.get_metrics().items():
                parts = value if isinstance(value, dict) else {"": value}
                for part, number in parts.items():
                    sums[f"{name}/{part}" if part else name] += number
        return {name: value / count for name, value in sums.items()}
