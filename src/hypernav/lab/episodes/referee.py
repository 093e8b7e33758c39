"""Measures an episode by ground truth, which agents never get."""

import math

from hypernav.core.episode import SUCCESS_DISTANCE_M, EpisodeMetrics, measure
from hypernav.core.world import GoalTruth, Position


class Referee:
    """Measures one episode as habitat-lab does.

    Attributes:
        goal: The region in which the goal counts as reached.
        shortest_path_m: Geodesic distance from the start to the nearest view point.
        path_length_m: Sum of the displacements in space so far.
        distance_to_goal_m: Geodesic distance from the robot to the nearest view point.
    """

    def __init__(self, goal: GoalTruth, start: Position) -> None:
        """Begin an episode.

        Args:
            goal: The region in which the goal counts as reached.
            start: Position of the robot, scene frame, metres.
        """
        self.goal = goal
        self.shortest_path_m: float = goal.distance(*start)
        self.distance_to_goal_m: float = self.shortest_path_m
        self.path_length_m: float = 0.0
        self._position = start

    def watch(self, position: Position) -> None:
        """Note the position of the robot after an action, scene frame, metres."""
        if position == self._position:
            return
        self.path_length_m += math.dist(self._position, position)
        self.distance_to_goal_m = self.goal.distance(*position)
        self._position = position

    def measure(
        self, *, stopped: bool, success_distance_m: float = SUCCESS_DISTANCE_M
    ) -> EpisodeMetrics:
        """The measures so far.

        Args:
            stopped: Whether the agent took STOP. Some publications also count a time-out near the
                goal as a success; for their rule always pass True at the end.
            success_distance_m: Largest distance that counts as success; call again with another
                value to score another protocol.
        """
        return measure(
            stopped=stopped,
            distance_to_goal_m=self.distance_to_goal_m,
            shortest_path_m=self.shortest_path_m,
            path_length_m=self.path_length_m,
            success_distance_m=success_distance_m,
        )
