"""Write an agent of your own: two methods, `reset` and `act`.

This one bounces around like an early robot vacuum, and uses the detector of this package to see
when it has arrived. `hypernav.check_agent` says what breaks the contract of an agent. The agent
runs in the same episode loop as all others and is measured by the same referee.

Run: python examples/03_your_own_agent.py
"""

import numpy as np

import hypernav
from hypernav import Action, Goal, GroundTruthDetector, Observation


class Bouncer:
    """Goes straight until something is near, then turns by a random angle."""

    def __init__(self, seed: int) -> None:
        self._seed = seed
        self._detector = GroundTruthDetector()

    def reset(self, goal: Goal) -> None:
        self._goal = goal
        # Drawn anew for every search, so that a search doesn't depend on those before it.
        self._rng = np.random.default_rng(self._seed)
        self._turns = 0

    def act(self, observation: Observation) -> Action:
        for detection in self._detector.detect(observation, self._goal):
            assert detection.mask is not None
            depth = observation.depth[detection.mask]
            if (depth > 0).any() and np.median(depth[depth > 0]) < 1.2:
                return Action.STOP
        middle = observation.depth[200:400, 240:400]
        if self._turns == 0 and (middle[middle > 0].min(initial=9.0) < 0.9):
            self._turns = int(self._rng.integers(2, 8))
        if self._turns > 0:
            self._turns -= 1
            return Action.TURN_LEFT
        return Action.MOVE_FORWARD


def main() -> None:
    hypernav.check_agent(Bouncer(seed=0))
    search = hypernav.find("sofa", "builtin", agent=Bouncer(seed=0), max_steps=150)
    steps = sum(1 for _ in search)
    result = search.result()
    print(f"{result.outcome} after {steps} steps, {result.metrics.distance_to_goal_m:.1f} m away")


if __name__ == "__main__":
    main()
