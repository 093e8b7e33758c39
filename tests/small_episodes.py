"""Episodes of scenes that tests make themselves."""

from hypernav.core.episode import Episode
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal


def episode_from(start: Pose2, goal: Goal | str = "bed", **values) -> Episode:
    """An episode of whatever scene the test has.

    Args:
        start: Start pose, scene frame.
        goal: What to find.
        **values: Further attributes of `Episode`.
    """
    goal = Goal(goal) if isinstance(goal, str) else goal
    return Episode("tests", "0", goal, start, **values)
