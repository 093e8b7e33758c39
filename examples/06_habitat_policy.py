"""Run an agent that was written for habitat-lab: it sees, acts and is measured as there.

The agent reads what habitat-lab's ObjectNav sensors show and answers with habitat-lab's numbers of
actions, and the loop is that of `habitat.Env`. The policy here is a tiny recurrent network with
random weights; yours takes its place.

Run: python examples/06_habitat_policy.py
"""

from typing import Any

import numpy as np

import hypernav

STOP, MOST_ACTIONS = 0, 25
GOALS = 50


class TinyPolicy:
    """Coarse depth and colours, GPS, compass and goal in; chances of the actions out."""

    def __init__(self, actions: int) -> None:
        rng = np.random.default_rng(0)
        self._goals = rng.normal(size=(GOALS, 8))
        self._input = rng.normal(size=(16, 12 + 3 + 3 + 8)) / 5.0
        self._state = rng.normal(size=(16, 16)) / 4.0
        self._output = rng.normal(size=(actions, 16))

    def reset(self) -> None:
        self._memory = np.zeros(16)
        self._rng = np.random.default_rng(0)
        self._taken = 0

    def act(self, observations: dict[str, Any]) -> dict[str, int]:
        height, width, _ = observations["depth"].shape
        blocks = observations["depth"].reshape(3, height // 3, 4, width // 4).mean(axis=(1, 3))
        seen = [
            blocks.ravel(),
            observations["rgb"].mean(axis=(0, 1)) / 255.0,
            observations["gps"] / 10.0,
            observations["compass"],
            self._goals[observations["objectgoal"][0]],
        ]
        self._memory = np.tanh(self._input @ np.concatenate(seen) + self._state @ self._memory)
        self._taken += 1
        if self._taken == MOST_ACTIONS:
            return {"action": STOP}
        chances = np.exp(self._output @ self._memory)
        chances[STOP] = 0.0
        return {"action": int(self._rng.choice(len(chances), p=chances / chances.sum()))}


def main() -> None:
    # In habitat-lab: env = habitat.Env(config)
    env = hypernav.HabitatEnv("houses-train#3000")
    agent = TinyPolicy(int(env.action_space.n))
    for _ in range(3):
        observations = env.reset()
        agent.reset()
        while not env.episode_over:
            observations = env.step(agent.act(observations))
        measures = env.get_metrics()
        print(
            f"{env.current_episode.object_category:12s} success {measures['success']:.0f}, "
            f"SPL {measures['spl']:.2f}, SoftSPL {measures['soft_spl']:.2f}, "
            f"{measures['distance_to_goal']:.1f} m away after {measures['num_steps']} steps"
        )
    env.close()


if __name__ == "__main__":
    main()
