"""Number of frames of a video for each step, so that a person can follow."""

from collections.abc import Sequence
from itertools import accumulate

from hypernav.core.trace import Exchange, StepTrace

FRAMES_PER_SECOND = 6
ENDING_FRAMES = 4 * FRAMES_PER_SECOND
EVERY_STEP = frozenset({"ground", "score view"})
"""Kinds of questions that are asked at every step, and do not change the destination."""
_AT_A_STEP = 1
_AT_A_DECISION = 6


def decisions(step: StepTrace) -> list[Exchange]:
    """Questions of a step that changed the destination."""
    return [one for one in step.exchanges if one.kind not in EVERY_STEP]


def frame_count(step: StepTrace) -> int:
    """Frames of a step: one second for a decision or an event, else a sixth of one."""
    return _AT_A_DECISION if decisions(step) or step.events else _AT_A_STEP


def start_times(frame_counts: Sequence[int]) -> list[float]:
    """Time at which each step appears, seconds from the start of the video.

    Args:
        frame_counts: Number of frames of each step. A skipped step has none, and appears with the
            next one that is shown.
    """
    return [frame / FRAMES_PER_SECOND for frame in accumulate(frame_counts, initial=0)][:-1]
