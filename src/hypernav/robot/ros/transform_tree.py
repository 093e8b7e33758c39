"""The tree of frames that ``/tf`` and ``/tf_static`` describe, and its poses at any time.

Conventions: REP 103 (x forward, y left, z up; optical frames x right, y down, z forward) and REP
105 (map → odom → base_link).
"""

from bisect import bisect, insort
from collections.abc import Iterator
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from hypernav.core.errors import RosMessageError, TransformMissingError
from hypernav.core.geometry.transforms import Transform
from hypernav.robot.ros.messages import frame_name, rigid_transform, stamp_s

_NOT_RUNNING = "is the node that publishes it running?"
_REACH_S = 0.2
"""Time before the first and after the last known pose for which that pose still holds."""
_GAP_S = 1.0
"""Longest time between two poses that are interpolated."""


class TransformTree:
    """Frames, each with a pose in its parent; most poses change with time."""

    def __init__(self, *, memory_s: float = float("inf")) -> None:
        """Create an empty tree."""
        self._memory_s = memory_s
        self._parents: dict[str, str] = {}
        self._rivals: dict[str, str] = {}
        self._static: dict[str, Transform] = {}
        self._moving: dict[str, list[tuple[float, int, Transform]]] = {}
        self._count = 0

    def frames(self) -> frozenset[str]:
        """All frames that have a pose in another."""
        return frozenset(self._parents)

    def add_message(self, message: Any, *, static: bool) -> None:
        """Take the transforms of a ``TFMessage``.

        Raises:
            RosMessageError: One of them holds no pose; all others are taken.
        """
        broken: list[str] = []
        for stamped in message.transforms:
            transform, child = stamped.transform, frame_name(stamped.child_frame_id)
            try:
                pose = rigid_transform(transform.translation, transform.rotation)
            except RosMessageError as error:
                broken.append(f"'{child}': {error}")
                continue
            parent = frame_name(stamped.header.frame_id)
            self.add(parent, child, pose, stamp_s(stamped.header), static=static)
        if broken:
            raise RosMessageError(broken[0])

    def add_odometry(self, message: Any) -> None:
        """Take the pose of an ``Odometry``.

        Raises:
            RosMessageError: The message holds no pose.
        """
        self.add(
            frame_name(message.header.frame_id),
            frame_name(message.child_frame_id),
            rigid_transform(message.pose.pose.position, message.pose.pose.orientation),
            stamp_s(message.header),
            static=False,
        )

    def add(
        self, parent: str, child: str, child_to_parent: Transform, at_s: float, *, static: bool
    ) -> None:
        """Take one pose.

        Args:
            parent: Frame in which the pose is given.
            child: Frame whose pose it is.
            child_to_parent: The pose.
            at_s: Time of the pose, seconds.
            static: Whether it holds at all times.
        """
        before = self._parents.setdefault(child, parent)
        if before != parent:
            self._rivals[child] = parent
            return
        if static:
            self._static[child] = child_to_parent
            return
        poses = self._moving.setdefault(child, [])
        self._count += 1
        insort(poses, (at_s, self._count, child_to_parent), key=lambda pose: pose[:2])
        while poses[-1][0] - poses[0][0] > self._memory_s:
            poses.pop(0)

    def is_moving(self, frame: str) -> bool:
        """Whether a frame moves relative to the root of its tree."""
        return any(name in self._moving for name in self._chain(frame))

    def newest_s(self, frame: str, parent: str) -> float | None:
        """Time up to which all poses between two frames are known; None if one is unknown.

        Args:
            frame: A frame.
            parent: Frame above it.
        """
        chain = list(self._chain(frame))
        if parent not in chain:
            return None
        moving = (
            self._moving[name] for name in chain[: chain.index(parent)] if name in self._moving
        )
        return min((poses[-1][0] for poses in moving), default=None)

    def root_of(self, frame: str) -> str:
        """The frame at the root of another frame's tree."""
        return list(self._chain(frame))[-1]

    def pose(self, frame: str, parent: str, at_s: float) -> Transform:
        """The pose of a frame in another: the transform from `frame` to `parent` coordinates.

        Args:
            frame: The frame.
            parent: Any frame of the same tree.
            at_s: Time, seconds.

        Raises:
            TransformMissingError: The frames share no tree, a frame between them has two parents,
                or no pose is known near that time.
        """
        below, above = list(self._chain(frame)), list(self._chain(parent))
        common = next((name for name in below if name in above), None)
        if common is None:
            raise TransformMissingError(
                f"tf does not connect '{frame}' (below '{below[-1]}') with '{parent}' (below "
                f"'{above[-1]}'); {self._alike(frame, parent) or _NOT_RUNNING}"
            )
        up = self._climb(below[: below.index(common)], at_s)
        return self._climb(above[: above.index(common)], at_s).inverse() @ up

    def _alike(self, *frames: str) -> str:
        """Which known frames differ from unknown ones only by the prefix of a robot, for people."""
        known = self._parents.keys() | set(self._parents.values())
        alike = [
            f"'{name}' instead of '{frame}'"
            for frame in frames
            for name in sorted(known)
            if frame not in known and name.endswith(f"/{frame}")
        ]
        return f"there is {', '.join(alike)}: name it in the configuration" if alike else ""

    def _climb(self, frames: list[str], at_s: float) -> Transform:
        """The pose of the first frame in the parent of the last."""
        pose = Transform.identity()
        for frame in frames:
            pose = self._in_parent(frame, at_s) @ pose
        return pose

    def _chain(self, frame: str) -> Iterator[str]:
        """A frame, its parent, and so on up to the root."""
        seen = {frame}
        yield frame
        while (frame := self._parents.get(frame, "")) and frame not in seen:
            seen.add(frame)
            yield frame

    def _in_parent(self, frame: str, at_s: float) -> Transform:
        if frame in self._rivals:
            raise TransformMissingError(
                f"tf puts '{frame}' both into '{self._parents[frame]}' and into "
                f"'{self._rivals[frame]}'; a frame has one parent: switch one publisher off"
            )
        if frame in self._static:
            return self._static[frame]
        poses = self._moving[frame]
        after = bisect(poses, at_s, key=lambda pose: pose[0])
        if after and poses[after - 1][0] == at_s:
            return poses[after - 1][2]
        if 0 < after < len(poses) and poses[after][0] - poses[after - 1][0] <= _GAP_S:
            return _between(poses[after - 1], poses[after], at_s)
        near = min(poses[max(after - 1, 0) : after + 1], key=lambda pose: abs(pose[0] - at_s))
        if abs(near[0] - at_s) > _REACH_S:
            raise TransformMissingError(
                f"tf has '{frame}' in '{self._parents[frame]}' from {poses[0][0]:.3f} to "
                f"{poses[-1][0]:.3f} s, and nothing near {at_s:.3f} s; do the clocks agree?"
            )
        return near[2]


def _between(
    before: tuple[float, int, Transform], after: tuple[float, int, Transform], at_s: float
) -> Transform:
    """The pose between two poses, at a constant velocity."""
    (start_s, _, first), (end_s, _, last) = before, after
    share = (at_s - start_s) / (end_s - start_s)
    rotations = Rotation.from_matrix(np.array([first.rotation, last.rotation]))
    rotation = Slerp([0.0, 1.0], rotations)(share).as_matrix()
    return Transform(rotation, first.translation + share * (last.translation - first.translation))
