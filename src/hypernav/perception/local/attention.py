"""Choice of the camera images that are worth a question, since questions cost time or money."""

from collections import deque
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from jaxtyping import Bool, Float32, Float64
from pydantic import Field

from hypernav.core.config import RoomConfig
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.transforms import Transform
from hypernav.core.observation import Observation
from hypernav.core.trace import ExchangeLog
from hypernav.mapping.memory.goal_area import GoalArea

_COLUMNS, _ROWS = 24, 18
_REMEMBERED_VIEWS = 64
_SAME_SURFACE_M = 0.15
_SAME_SURFACE_SHARE = 0.05
_CLOSER = 0.6
"""Share of the distance that a surface was seen from, below which it counts as new again."""
_HELD = 0.7
"""Share of the distance to a held target at the last question, at which the next is asked."""


class AttentionConfig(RoomConfig):
    """Conditions under which the detector is not asked. The paper asks it at every step.

    Both savings are off unless switched on: in our measurement they cost success (docs/models.md).

    Attributes:
        skip_seen_views: Whether to skip images that show nothing but surfaces of earlier questions.
        seen_share: Share of an image's surfaces that must have been seen before to skip it.
        edge_share: Width of an image's edge, as a share of its sides; objects seen there may be cut
            off.
        skip_held_target: Whether to skip images on the path to a target that needs no second look,
            until the distance has fallen to 0.7 of that at the last question.
    """

    skip_seen_views: bool = False
    seen_share: float = Field(default=0.9, gt=0.0, le=1.0)
    edge_share: float = Field(default=0.05, ge=0.0, lt=0.5)
    skip_held_target: bool = False


@dataclass(frozen=True, eq=False)
class _View:
    """Depth and pose of an image that the detector was asked about."""

    depth: Float32[np.ndarray, "height width"]
    camera: PinholeCamera
    map_to_camera: Transform

    @staticmethod
    def of(observation: Observation) -> "_View":
        return _View(observation.depth, observation.camera, observation.camera_to_map.inverse())

    def shows(
        self,
        points: Float64[np.ndarray, "n 3"],
        distance: Float64[np.ndarray, " n"],
        config: AttentionConfig,
    ) -> Bool[np.ndarray, " n"]:
        """Which points the image shows large enough and not at its edge.

        Args:
            points: Points in the ``map`` frame, metres.
            distance: Distance that each point is seen from now, along the optical axis, metres.
            config: Width of the edge.
        """
        camera, depth = self.camera, self.depth
        ahead = self.map_to_camera.apply(points)
        pixels, z = camera.project(ahead), ahead[:, 2]
        size = np.array([camera.width, camera.height])
        margin = config.edge_share * size
        inside = (z > 0.1) & ((pixels >= margin) & (pixels < size - margin)).all(axis=1)
        column, row = np.where(inside[:, None], pixels, 0).astype(int).T
        there = depth[row, column].astype(np.float64)
        same = np.abs(there - z) < _SAME_SURFACE_M + _SAME_SURFACE_SHARE * z
        # Nothing within the range of depth: beyond it, everything along the ray was in sight.
        beyond = ~is_measured(there) & (z > 0.9 * float(depth.max(initial=0.0)))
        return inside & (same | beyond) & (z * _CLOSER <= distance)


@dataclass(eq=False)
class _Looks:
    """What attention notes: the images asked about, and the distance of the held target then."""

    views: deque[_View] = field(default_factory=lambda: deque(maxlen=_REMEMBERED_VIEWS))
    held_m: float | None = None


@dataclass(frozen=True, eq=False)
class Attention:
    """Tells whether an image shows anything that was not asked about before.

    Attributes:
        log: Log of the skipped images, for the trace.
        config: Conditions for skipping images.
    """

    log: ExchangeLog
    config: AttentionConfig

    def is_worth_a_question(
        self, observation: Observation, target: GoalArea | None, notes: dict[str, Any]
    ) -> bool:
        """Whether to ask the detector; if so, the image counts as seen from now on.

        Images are kept only if ``skip_seen_views`` is on.

        Args:
            observation: Present frame.
            target: Goal area that is held; None while the goal is searched for.
            notes: Notes of this search, where the images are kept.
        """
        looks: _Looks = notes.setdefault("attention", _Looks())
        if target is not None and self.config.skip_held_target:
            distance_m = target.distance_to(*observation.robot.xy)
            if looks.held_m is not None and distance_m > _HELD * looks.held_m:
                self._skip(f"the way to the goal is known, {distance_m:.1f} m are left")
                return False
            looks.held_m = distance_m
        else:
            looks.held_m = None
            if self.config.skip_seen_views:
                share = self._seen_share(observation, looks.views)
                if share >= self.config.seen_share:
                    self._skip(f"nothing new, {share:.0%} of it was seen before")
                    return False
        if self.config.skip_seen_views:
            looks.views.append(_View.of(observation))
        return True

    def _seen_share(self, observation: Observation, views: deque[_View]) -> float:
        points, distance = _sampled(observation)
        seen = np.zeros(len(points), dtype=bool)
        for view in reversed(views):
            left = ~seen
            if not left.any():
                break
            seen[left] = view.shows(points[left], distance[left], self.config)
        return float(seen.mean())

    def _skip(self, why: str) -> None:
        question = "Does the picture show anything that was not asked about before?"
        self.log.note("attention", "geometric", question, why)


def _sampled(
    observation: Observation,
) -> tuple[Float64[np.ndarray, "n 3"], Float64[np.ndarray, " n"]]:
    """Points all over an image in the ``map`` frame, and their distance along the optical axis.

    Where there is no return, a point just beyond the farthest return stands for what is there.
    """
    depth: Float32[np.ndarray, "height width"] = observation.depth
    height, width = depth.shape
    rows = ((np.arange(_ROWS) + 0.5) * height / _ROWS).astype(int)
    columns = ((np.arange(_COLUMNS) + 0.5) * width / _COLUMNS).astype(int)
    z = depth[np.ix_(rows, columns)].astype(np.float64)
    z = np.where(is_measured(z), z, 1.2 * max(float(depth.max(initial=0.0)), 1.0))
    points = observation.camera.unproject_pixels(rows[:, None], columns[None, :], z).reshape(-1, 3)
    return observation.camera_to_map.apply(points), z.reshape(-1)
