"""Notices that two programs, or two robots, publish one and the same odometry."""

import math
from collections import deque

from hypernav.core.geometry.transforms import Pose2, wrap_angle

_LEAST_M, _LEAST_RAD = 0.1, math.radians(6.0)
"""Smallest jump between two poses that follow each other: no legged body sways so fast."""
_BACK_SHARE = 0.3
"""Share of a jump within which the pose after the next is back where the first one was."""
_POSES, _MOST_BACK = 40, 10
"""Number of poses that are looked at, and how many of them may jump forth and back."""


class RivalOdometry:
    """Looks for poses that jump forth and back, as those of two publishers in turn do.

    Each would be right; taken together, every second image would be placed wrongly.
    """

    def __init__(self) -> None:
        """Begin without poses."""
        self._last: deque[Pose2] = deque(maxlen=3)
        self._jumps: deque[float | None] = deque(maxlen=_POSES)

    def note(self, pose: Pose2) -> None:
        """Take the pose that is newest by its stamp."""
        self._last.append(pose)
        if len(self._last) < 3:
            return
        first, second, third = self._last
        forth, back = _distance(first, second), _distance(second, third)
        is_jump = min(forth, back) > 1.0
        is_back = is_jump and _distance(first, third) < _BACK_SHARE * min(forth, back)
        self._jumps.append(first.distance_to(*second.xy) if is_back else None)

    @property
    def words(self) -> str | None:
        """What is wrong, for people; None if the poses follow each other."""
        jumps = [jump for jump in self._jumps if jump is not None]
        if len(jumps) <= _MOST_BACK:
            return None
        return (
            f"its pose jumps forth and back by {sum(jumps) / len(jumps):.2f} m: two publishers, "
            "such as the wheels' driver beside a localisation (publish_tf off in one), or two "
            "robots in one domain with the same names of frames"
        )


def _distance(before: Pose2, now: Pose2) -> float:
    """How far apart poses are, in smallest jumps."""
    turned = abs(wrap_angle(now.yaw - before.yaw))
    return max(before.distance_to(*now.xy) / _LEAST_M, turned / _LEAST_RAD)
