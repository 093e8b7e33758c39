"""Poses that are none though they look like some: the identity where tracking was lost.

Formats mark a lost pose by infinities, zeros or by no line at all, which their readers leave out.
Some programs write the identity instead. At the beginning of a recording it is right, since the
first camera often is the world, unless the next pose is far away. Once the camera has moved, it
never comes back to the last digit, and a frame drawn there would spoil the map.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hypernav.robot.recordings.recording import RecordedFrame, Recording, left_out

_ROUNDING = 1e-9
"""Largest difference of equal numbers in poses."""
_FEWEST_STEPS, _LEAST_JUMP_M, _JUMP = 5, 0.5, 3.0
"""What is a jump: at least this number of steps, metres, and times the longest step."""


def without_lost_poses(recording: Recording) -> Recording:
    """The recording without the frames that the identity marks as lost, and with what is odd noted.

    Args:
        recording: A recording.
    """
    total = len(recording.frames)
    is_identity = [_is_identity(frame) for frame in recording.frames]
    begin = is_identity.index(False) if False in is_identity else total
    moving = [k for k in range(begin, total) if not is_identity[k]]
    standing = [] if _jumps([recording.frames[k] for k in moving]) else list(range(begin))
    frames: list[RecordedFrame] = [recording.frames[k] for k in (*standing, *moving)]
    why = "their pose is exactly the identity, where the camera is not, so it was lost"
    notes = [*recording.notes, *left_out(total - len(frames), total, "frames", why)]
    if not moving and total > 1:
        notes.append(
            f"the poses of all {total} frames are exactly the identity: the camera stood still, or "
            "its poses are missing"
        )
    return replace(recording, frames=frames, notes=notes)


def _jumps(frames: Sequence[RecordedFrame]) -> bool:
    """Whether the first of some frames lies far from the origin for steps as long as theirs."""
    places = np.array([frame.camera_to_world.translation for frame in frames]).reshape(-1, 3)
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    if len(steps) < _FEWEST_STEPS:
        return False
    return bool(np.linalg.norm(places[0]) > max(_LEAST_JUMP_M, _JUMP * steps.max()))


def _is_identity(frame: RecordedFrame) -> bool:
    return bool(np.abs(frame.camera_to_world.matrix - np.eye(4)).max() <= _ROUNDING)
