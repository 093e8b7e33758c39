"""Checks what a robot sends against its last observations and its orders, for every client."""

import hashlib
import math
from collections import Counter
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32

from hypernav.core.embodiment import Action, Embodiment
from hypernav.core.errors import SensorError
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.transforms import wrap_angle
from hypernav.core.observation import Observation
from hypernav.robot.wire.frames import PackedObservation
from hypernav.robot.wire.requests import ObservationFacts
from hypernav.robot.wire.values import PlanarPose

_MOVED_M, _TURNED_RAD = 0.1, math.radians(5.0)
"""Smallest motion after which the images must be new."""
_MOST_IDENTICAL = 5
"""Number of images in a row that may repeat the one before them while the robot doesn't move: a
real camera's noise never repeats, but a simulated one that is blocked sees the same again."""
_FROZEN_SHARE = 0.98
"""Share of the depth pixels that a camera which has turned doesn't measure alike again."""
_JUMP_M = 1.0
"""Length by which a motion may exceed that of a step: a robot rolls on while it waits."""
_PACE_M_S, _FARTHEST_M = 1.5, 20.0
"""Speed at which it may be driven between two observations, and the longest such motion."""
_MOST_WRONG = 3
"""Number of turns, or steps, in a row that aren't those ordered: somebody may push the robot."""
_WRONG_SHARE = 0.6
"""Share of a motion that odometry must show in the wrong direction to have the wrong sign."""
_OTHER_TURN_RAD = math.radians(60.0)
"""Angle by which a turn may differ from the one that was ordered."""
_FURTHER_SHARE, _FURTHER_RAD = 0.9, math.radians(20.0)
"""Share of a turn, and least angle, by which it may go further than it was ordered."""
_ASIDE_RAD = math.radians(70.0)
"""Greatest angle between the robot's heading and the direction in which a step moves it."""
_METRES_RANGES = 3.0
"""Multiple of the camera's range from which on a depth cannot be in metres."""
_MOST_BLOCKED = 40
"""Number of steps, or turns, in a row that may fail."""
_MOST_BLIND = 24
"""Number of images without depth in a row after which a search ends."""


@dataclass(frozen=True)
class _Image:
    """An image that was seen, and where.

    Attributes:
        sequence: Number of the last observation that had it.
        pose: Pose of the robot at the first one, frame of the odometry.
    """

    sequence: int
    pose: PlanarPose


class Sensing:
    """Ends a search by an error that names the mistake, before the agent uses wrong numbers.

    Attributes:
        blind: Number of images in a row, up to the last, without any depth in the camera's range.
    """

    def __init__(self, robot: Embodiment) -> None:
        """Create it; nothing has been sensed yet.

        Args:
            robot: Camera, step and turn of the robot.
        """
        self.blind: int = 0
        self._robot = robot
        self._last: ObservationFacts | None = None
        self._depth: Float32[np.ndarray, "height width"] | None = None
        self._images: dict[bytes, _Image] = {}
        self._identical = 0
        self._blocked: Counter[bool] = Counter()  # failed in a row: turns, and steps
        self._wrong: Counter[bool] = Counter()  # others than ordered in a row: turns, and steps

    def check(self, packed: PackedObservation, seen: Observation, commanded: Action | None) -> None:
        """Look at the next observation.

        Args:
            packed: The observation as it came.
            seen: The same, decoded.
            commanded: Action that the robot was told before; None at the beginning.

        Raises:
            SensorError: The data cannot be right.
        """
        facts, last = packed.header, self._last
        self._check_depth(seen)
        if last is not None:
            _check_time(last, facts)
            self._check_motion(last, facts, commanded)
            self._check_direction(last, facts, commanded)
        self._check_images(packed, seen)
        if last is not None and self._depth is not None:
            self._check_change(last, facts, self._depth, seen.depth)

    def note(self, packed: PackedObservation, seen: Observation, commanded: Action | None) -> None:
        """Remember an observation; one of before a restart of the server isn't checked again."""
        facts = packed.header
        if self._last is not None and commanded is not None:
            turns = commanded is not Action.MOVE_FORWARD
            is_wrong = not facts.blocked and self._is_other(self._last, facts, commanded)
            self._wrong[turns] = self._wrong[turns] + 1 if is_wrong else 0
            self._blocked[turns] = self._blocked[turns] + 1 if facts.blocked else 0
        digests = _digests(packed)
        self._identical = self._identical + 1 if self._repeats(digests, facts) else 0
        for one in digests:
            known = self._images.get(one)
            pose = facts.base_to_odom if known is None else known.pose
            self._images[one] = _Image(facts.sequence, pose)
        self.blind = 0 if self._sees(seen) else self.blind + 1
        self._last, self._depth = facts, seen.depth

    def _check_depth(self, seen: Observation) -> None:
        lens = self._robot.camera
        measured = seen.depth[is_measured(seen.depth)]
        if measured.size > 0 and measured.min() > _METRES_RANGES * lens.max_depth_m:
            raise SensorError(
                f"all depth is from {measured.min():g} to {measured.max():g} m, and the camera "
                f"measures up to {lens.max_depth_m:g} m; is its depth in metres?"
            )
        if self.blind >= _MOST_BLIND - 1 and not self._sees(seen):
            raise SensorError(
                f"{_MOST_BLIND} images without any depth between {lens.min_depth_m:g} and "
                f"{lens.max_depth_m:g} m; does the camera work, and is its depth in metres?"
            )

    def _check_images(self, packed: PackedObservation, seen: Observation) -> None:
        """Refuse images that were seen elsewhere, and too many in a row that are the same."""
        pose, number = packed.header.base_to_odom, packed.header.sequence
        names, pixels = ("colour image", "depth image"), (seen.rgb, seen.depth)
        digests = _digests(packed)
        known = [self._images.get(one) for one in digests]
        are_one = None not in known and len({one.sequence for one in known if one}) == 1
        for name, image, digest in zip(names, pixels, digests, strict=True):
            before = self._images.get(digest)
            if before is None or not _moved(before.pose, pose) or np.ptp(image) == 0:
                continue  # one of a single colour, or without any return, may come again
            if before.sequence < number - 1 and not are_one:
                continue  # in simulation a room may look the same from two sides
            moved_m, turned = _motion(before.pose, pose)
            raise SensorError(
                f"the {name} of observation {number} is that of observation {before.sequence}, "
                f"byte for byte, but the odometry has moved {moved_m:.2f} m and turned "
                f"{math.degrees(turned):.0f}°; is the camera frozen?"
            )
        is_frozen = self._repeats(digests, packed.header) and self._identical + 1 >= _MOST_IDENTICAL
        if is_frozen and self._sees(seen):  # a covered camera is blind: `_check_depth` counts that
            raise SensorError(
                f"the images of the last {_MOST_IDENTICAL + 1} observations are the same, byte for "
                "byte; is the camera frozen?"
            )

    def _check_change(
        self,
        before: ObservationFacts,
        now: ObservationFacts,
        depth_before: Float32[np.ndarray, "height width"],
        depth: Float32[np.ndarray, "height width"],
    ) -> None:
        """Refuse a depth image that is hardly another after a turn.

        A step doesn't change it everywhere: the walls of a corridor stay where they are. Nor does a
        turn change level floor, which is as far away in all of a row; only the rest tells.
        """
        _, turned = _motion(before.base_to_odom, now.base_to_odom)
        if abs(turned) <= _TURNED_RAD:
            return
        lens, largest = self._robot.camera, max(depth.max(), depth_before.max())
        farthest_m = min(lens.max_depth_m, float(largest))  # a sensor may clip before its range
        measured = is_measured(depth, lens.min_depth_m, farthest_m)
        measured |= is_measured(depth_before, lens.min_depth_m, farthest_m)
        for image in (depth, depth_before):
            measured &= image != np.median(image, axis=1, keepdims=True)
        if not measured.any():
            return
        share = float((depth == depth_before)[measured].mean())
        if share >= _FROZEN_SHARE:
            raise SensorError(
                f"{share:.2%} of the depth of observation {now.sequence} is that of observation "
                f"{before.sequence}, pixel for pixel, but the odometry has turned "
                f"{math.degrees(turned):.0f}°; is the camera frozen?"
            )

    def _sees(self, seen: Observation) -> bool:
        """Whether there is any depth in the camera's range."""
        lens = self._robot.camera
        return bool(is_measured(seen.depth, lens.min_depth_m, lens.max_depth_m).any())

    def _repeats(self, digests: tuple[bytes, bytes], facts: ObservationFacts) -> bool:
        """Whether both images are those of the last observation."""
        known = [self._images.get(one) for one in digests]
        return all(one is not None and one.sequence == facts.sequence - 1 for one in known)

    def _check_motion(
        self, before: ObservationFacts, now: ObservationFacts, commanded: Action | None
    ) -> None:
        motion = self._robot.motion
        moved_m, _ = _motion(before.base_to_odom, now.base_to_odom)
        driven_m = min(_PACE_M_S * (now.stamp_s - before.stamp_s), _FARTHEST_M)
        if moved_m > motion.forward_m + _JUMP_M + driven_m:
            raise SensorError(
                f"odometry (base_to_odom) moved {moved_m:.2f} m in one step of "
                f"{motion.forward_m:g} m and {now.stamp_s - before.stamp_s:.1f} s; it may drift, "
                "but not jump: what localisation finds belongs in odom_to_map"
            )
        turns = commanded is not Action.MOVE_FORWARD
        if now.blocked and commanded is not None and self._blocked[turns] + 1 >= _MOST_BLOCKED:
            raise SensorError(
                f"{_MOST_BLOCKED} {'turns' if turns else 'steps'} in a row did not happen, "
                "according to the robot or its odometry; does it move, and does its odometry show "
                "it?"
            )

    def _check_direction(
        self, before: ObservationFacts, now: ObservationFacts, commanded: Action | None
    ) -> None:
        """Refuse several motions in a row that odometry shows as others than those ordered."""
        if commanded is None or now.blocked or not self._is_other(before, now, commanded):
            return
        if self._wrong[commanded is not Action.MOVE_FORWARD] + 1 < _MOST_WRONG:
            return
        moved_m, turned = _motion(before.base_to_odom, now.base_to_odom)
        if commanded is Action.MOVE_FORWARD:
            aside = math.degrees(abs(_aside(before.base_to_odom, now.base_to_odom)))
            raise SensorError(
                f"the robot was told to drive forward, and its odometry moved {moved_m:.2f} m at "
                f"{aside:.0f}° to its heading, {_MOST_WRONG} times in a row; x is forward and y to "
                "the left at yaw 0 (REP 103)"
            )
        raise SensorError(
            f"the robot was told to turn {math.degrees(self._turn(commanded)):+.0f}°, and its "
            f"odometry turned {math.degrees(turned):+.0f}°, {_MOST_WRONG} times in a row something "
            "else than it was told; yaw is in radians and grows to the left (REP 103)"
        )

    def _is_other(self, before: ObservationFacts, now: ObservationFacts, commanded: Action) -> bool:
        """Whether odometry shows a motion of another direction, or a turn of another size."""
        moved_m, turned = _motion(before.base_to_odom, now.base_to_odom)
        if commanded is Action.STOP:
            return False
        if commanded is Action.MOVE_FORWARD:
            is_long = moved_m > _WRONG_SHARE * self._robot.motion.forward_m
            return is_long and abs(_aside(before.base_to_odom, now.base_to_odom)) > _ASIDE_RAD
        turn = self._turn(commanded)
        is_mirrored = turned * turn < 0.0 and abs(turned) > _WRONG_SHARE * abs(turn)
        too_far = math.copysign(1.0, turn) * wrap_angle(turned - turn)
        is_far = too_far > max(_FURTHER_SHARE * abs(turn), _FURTHER_RAD)
        return is_mirrored or is_far or abs(too_far) > _OTHER_TURN_RAD

    def _turn(self, commanded: Action) -> float:
        """The angle of a turn, radians, positive to the left."""
        angle = math.radians(self._robot.motion.turn_angle_deg)
        return angle if commanded is Action.TURN_LEFT else -angle


def _check_time(before: ObservationFacts, now: ObservationFacts) -> None:
    """Refuse images that are not newer than the last ones."""
    if now.stamp_s > before.stamp_s:
        return
    what = (
        f"is that of observation {before.sequence} again, {now.stamp_s:.6f}; is the camera frozen"
        if now.stamp_s == before.stamp_s
        else f"went back from {before.stamp_s:.6f} to {now.stamp_s:.6f}; was its clock reset"
    )
    raise SensorError(
        f"stamp_s of observation {now.sequence} {what}? Expected the time of each observation's "
        "images, on one clock of the robot"
    )


def _digests(packed: PackedObservation) -> tuple[bytes, bytes]:
    """What tells two colour images, and two depth images, apart."""
    colour = hashlib.blake2b(packed.colour, digest_size=16, person=b"colour").digest()
    return colour, hashlib.blake2b(packed.depth, digest_size=16, person=b"depth").digest()


def _motion(before: PlanarPose, now: PlanarPose) -> tuple[float, float]:
    """Length and angle of a motion by odometry, metres and radians."""
    length_m = math.dist((before.x, before.y, before.z), (now.x, now.y, now.z))
    return length_m, wrap_angle(now.yaw - before.yaw)


def _aside(before: PlanarPose, now: PlanarPose) -> float:
    """Angle from the robot's mean heading to the direction of its motion, radians."""
    _, turned = _motion(before, now)
    direction = math.atan2(now.y - before.y, now.x - before.x)
    return wrap_angle(direction - before.yaw - turned / 2.0)


def _moved(before: PlanarPose, now: PlanarPose) -> bool:
    moved_m, turned = _motion(before, now)
    return moved_m > _MOVED_M or abs(turned) > _TURNED_RAD
