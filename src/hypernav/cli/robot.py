"""The command `hypernav robot`: a simulated robot, recordings of a camera, and field studies."""

import importlib

from hypernav.cli.robot_options import Replay, Report, Simulate, Wait

_MODULES = {Simulate: "simulate", Wait: "wait", Replay: "replay", Report: "report"}


def run(options: Simulate | Wait | Replay | Report) -> int:
    """Run a subcommand.

    Returns:
        Its exit status.
    """
    name = _MODULES[type(options)]
    return importlib.import_module(f"hypernav.cli.robots.{name}").run(options)
