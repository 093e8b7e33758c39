"""The first sight of the goal, which divides a path into exploring and approaching."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int64

from hypernav.core.observation import LabelledPixels
from hypernav.lab.episodes.referee import Referee

MIN_VISIBLE_SHARE = 0.0005
"""Smallest share of the image that counts as seen: 12×12 pixels of 640×480."""

_STRIDE = 2


@dataclass(frozen=True)
class PathParts:
    """The path of an episode before and after the goal was first in the image.

    Attributes:
        explored_m: Length of the path until then, metres.
        approached_m: Length of the path from then to the end, metres.
        shortest_from_sight_m: Geodesic distance from where it was first seen to the nearest view
            point, metres; infinite if no path exists.
    """

    explored_m: float
    approached_m: float
    shortest_from_sight_m: float


class GoalSight:
    """Watches the true labels of an episode's images for the goal."""

    def __init__(self, referee: Referee) -> None:
        """Begin an episode.

        Args:
            referee: Referee of the episode, which knows the goal's instances and measures the path.
        """
        self._referee = referee
        self._ids: Int64[np.ndarray, " n"] = np.array(
            [instance.id for instance in referee.goal.instances], dtype=np.int64
        )
        self._first: tuple[float, float] | None = None

    def watch(self, labels: LabelledPixels) -> bool:
        """Whether the goal is in the image with these labels.

        Call it with every image, before the referee watches the action that follows.
        """
        ids = labels.ids[::_STRIDE, ::_STRIDE]
        pixels = np.bincount(ids.ravel() + 1, minlength=int(self._ids.max(initial=0)) + 2)
        is_seen = bool((pixels[self._ids + 1] >= MIN_VISIBLE_SHARE * ids.size).any())
        if is_seen and self._first is None:
            self._first = (self._referee.path_length_m, self._referee.distance_to_goal_m)
        return is_seen

    @property
    def parts(self) -> PathParts | None:
        """The two parts of the path so far; None if the goal has not been in the image."""
        if self._first is None:
            return None
        explored, shortest = self._first
        return PathParts(explored, self._referee.path_length_m - explored, shortest)
