"""Frames that a video spends on each step, so that a person can follow."""

from collections.abc import Sequence

from hypernav.core.trace import Exchange, StepTrace

FRAMES_PER_SECOND = 6
ENDING_FRAMES = 4 * FRAMES_PER_SECOND
_AT_A_STEP = 1
_AT_A_DECISION = 6


def decisions(step: StepTrace) -> list[Exchange]:
    """Questions of a step that changed the destination."""
    return [one for one in step.exchanges if one.kind not in {"ground", "attention"}]


def frame_count(step: StepTrace) -> int:
    """Frames of a step: one second for a decision or an event, else a sixth of one."""
    return _AT_A_DECISION if decisions(step) or step.events else _AT_A_STEP


def start_times(steps: Sequence[StepTrace]) -> list[float]:
    """Time at which each step appears, seconds from the start of the video."""
    times, frame = [], 0
    for step in steps:
        times.append(frame / FRAMES_PER_SECOND)
        frame += frame_count(step)
    return times
