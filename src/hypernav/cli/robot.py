"""The command `hypernav robot`: robots, simulated or on ROS 2, recordings, and field studies."""

import importlib

from hypernav.cli.options.robot import Replay, Report, Ros2, Simulate, Wait

_MODULES = {
    Simulate: "simulate",
    Wait: "wait",
    Ros2: "ros2",
    Replay: "replay",
    Report: "report",
}


def run(options: Simulate | Wait | Ros2 | Replay | Report) -> int:
    """Run a subcommand.

    Returns:
        Its exit status.
    """
    name = _MODULES[type(options)]
    return importlib.import_module(f"hypernav.cli.robots.{name}").run(options)
