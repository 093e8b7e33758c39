"""How an episode ended, typed."""

from enum import StrEnum


class Outcome(StrEnum):
    """The end of one episode.

    A model outage or a simulator error is never counted as a failure of navigation.
    """

    FOUND = "found"
    """Stopped, and the goal is there."""
    WRONG_PLACE = "wrong_place"
    """Stopped where the goal is not."""
    NOT_FOUND = "not_found"
    """Explored everything, or ran out of steps."""
    UNREACHABLE = "unreachable"
    """The scene holds the goal, but no way leads there from the start."""
    MODEL_UNAVAILABLE = "model_unavailable"
    """A model stayed away longer than the configured patience."""
    SIMULATOR_ERROR = "simulator_error"
    """The world failed, or the process that ran it was lost again and again."""
    INTERRUPTED = "interrupted"
    """Somebody stopped the program."""
