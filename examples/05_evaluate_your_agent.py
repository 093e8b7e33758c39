"""Evaluate an agent of your own on generated houses and write a report about it.

The folder holds one line per episode; run the program again and it continues where it was
interrupted. Use houses of `houses-train` for development, and `houses-val` once, for the results
that you publish.

Run: python examples/05_evaluate_your_agent.py [FOLDER]
"""

import sys
from pathlib import Path

import hypernav
from hypernav import Action, Goal, GroundTruthDetector, Observation, RunPlan, Selection


class LeftHanded:
    """Goes straight until something is near, then turns left. Stops where it sees the goal."""

    def __init__(self) -> None:
        self._detector = GroundTruthDetector()

    def reset(self, goal: Goal) -> None:
        self._goal = goal

    def act(self, observation: Observation) -> Action:
        for detection in self._detector.detect(observation, self._goal):
            depth = observation.depth[detection.mask]
            if (depth > 0).any() and depth[depth > 0].min() < 1.0:
                return Action.STOP
        ahead = observation.depth[200:400, 240:400]
        near = ahead[ahead > 0].min(initial=9.0) < 0.9
        return Action.TURN_LEFT if near else Action.MOVE_FORWARD


def main() -> None:
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "runs/left-handed")
    hypernav.check_agent(LeftHanded())
    plan = RunPlan("houses-train#3000", selection=Selection(episodes="0:3"), max_steps=60)
    progress = hypernav.evaluate(plan, folder, LeftHanded)
    for record in progress.records:
        print(f"{record.goal:15s} {record.outcome:12s} {record.why}")
    print(f"open {hypernav.write_report(folder, hypernav.load_runs([folder]))}")


if __name__ == "__main__":
    main()
