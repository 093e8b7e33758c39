"""Write an explorer of your own: one method, `next_destination`.

It says where to look next, by the map; the search around it detects the goal, plans, drives,
approaches and stops, as for all others. In the shell it is `--agent FILE:NearestEdge`, with the
name of the file without `.py`.

Run: python examples/07_your_own_explorer.py
"""

import numpy as np

import hypernav
from hypernav import Destination, ExplorationView


class NearestEdge:
    """Goes to the nearest free cell beside unknown ones where it has not been."""

    def next_destination(self, view: ExplorationView) -> Destination | None:
        unknown = ~view.grid.explored
        beside = np.zeros_like(unknown)
        for axis in (0, 1):
            beside |= np.roll(unknown, 1, axis) | np.roll(unknown, -1, axis)
        edge = view.grid.centres_of(np.argwhere(view.grid.free & beside))
        for visit in view.visits:
            edge = edge[np.linalg.norm(edge - visit, axis=1) > 1.0]
        if not len(edge):
            return None
        nearest = np.linalg.norm(edge - view.robot.xy, axis=1).argmin()
        x, y = edge[nearest].tolist()
        return Destination(x, y, "the nearest edge of the map")


def main() -> None:
    detector = hypernav.GroundTruthDetector()
    named = f"{__name__}:NearestEdge"
    agent = hypernav.build_search(hypernav.preset("default"), detector, agent=named)
    search = hypernav.find("bed", "builtin", agent=agent, seed=2, max_steps=150)
    steps = sum(1 for _ in search)
    result = search.result()
    print(f"{result.outcome} after {steps} steps, {result.metrics.distance_to_goal_m:.1f} m away")


if __name__ == "__main__":
    main()
