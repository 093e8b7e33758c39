"""The exit statuses of all commands."""

from enum import IntEnum


class ExitStatus(IntEnum):
    """How a command ended, for whoever started it."""

    SUCCESS = 0
    """The goal was found; the evaluation is complete; nothing is wrong with the model."""
    FAILURE = 1
    """The goal was not found; the model has a fault."""
    USAGE = 2
    """An option, a file or another input cannot be used, or a result cannot be written.

    Also used for an evaluation without any scored episode, and for a robot that doesn't stand
    still at the end.
    """
    MODEL_UNAVAILABLE = 3
    """A model was unavailable for longer than the patience."""
    CRASH = 70
    """An error of this program, or of a component of the user's own, which its message names."""
    INTERRUPTED = 130
    """Ctrl-C (SIGINT) ended the command."""
    TERMINATED = 143
    """SIGTERM ended the command, or SIGHUP: its terminal is gone."""
