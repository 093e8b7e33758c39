"""The step of a failed episode that is worth looking at first."""

from collections.abc import Sequence

from hypernav.core.trace import StepTrace
from hypernav.evaluation.failures.classification import Failure

_WRONG_BELIEFS = frozenset(
    {
        Failure.FALSE_DETECTION,
        Failure.LANGUAGE,
        Failure.WRONG_MAP,
        Failure.TARGET_SURROUNDED,
    }
)


def decisive_step(failure: Failure, steps: Sequence[StepTrace]) -> int:
    """Index of the step that decided a failed episode.

    If the robot took a wrong object for the goal, or placed the goal wrongly, that is the step at
    which it first did so; if it saw the goal and missed it, the first step with a detection; else
    the last step.

    Args:
        failure: Class of the failure.
        steps: Trace of the episode, at least one step.
    """
    last = len(steps) - 1
    if failure in _WRONG_BELIEFS:
        doubtful = (n for n in range(last, -1, -1) if not steps[n].goal_area)
        return min(next(doubtful, -1) + 1, last)
    if failure is Failure.SEEN_BUT_MISSED:
        seen = (n for n, step in enumerate(steps) if step.detections)
        return next(seen, last)
    return last
