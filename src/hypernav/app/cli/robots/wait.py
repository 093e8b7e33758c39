"""The command `hypernav robot wait`: a simulated robot that takes goals from the operator."""

import time
from contextlib import closing

import numpy as np
from rich.markup import escape
from rich.status import Status

from hypernav.app.build.presets import HyPerNavConfig
from hypernav.app.build.worlds import open_world
from hypernav.app.cli.find import check_start, given_start
from hypernav.app.cli.options.agent import check_steps_and_seed
from hypernav.app.cli.robot import Wait
from hypernav.app.cli.screen.terminal import Terminal
from hypernav.core.episode import MAX_STEPS, Episode
from hypernav.core.errors import ConfigError, LinkLostError, RequestRefusedError
from hypernav.core.goal import Goal
from hypernav.io.layered_config import layered
from hypernav.robot.client.links import HttpLink, HttpServer, ServerAddress
from hypernav.robot.client.robot_client import RobotClient, StopListener
from hypernav.robot.driving.driven_robot import DrivenRobot
from hypernav.robot.simulation.base import SimulatedBase
from hypernav.robot.wire.replies import SearchEnding
from hypernav.robot.wire.requests import GivenGoal, OpenSearch, is_robot_name

_PACE = 2.0
"""Simulated seconds per real second, slow enough for people to follow and to stop it."""
_PAUSE_S = 1.0
_SAY_EVERY_S = 5.0
_ANY = Goal("a thing that the operator names")


def run(options: Wait) -> int:
    """Run the command until it is interrupted.

    Raises:
        RobotLinkError: The server can't be reached.
        RequestRefusedError: The server refuses the robot.
    """
    check_steps_and_seed(MAX_STEPS, options.seed)
    check_start(options.start)
    if not is_robot_name(options.name):
        raise ConfigError(
            f"--name {options.name:.50}: expected up to 40 letters, digits, _ and -, as in robot-1"
        )
    address = ServerAddress.of(options.server, options.token_file)
    config = layered(HyPerNavConfig(), file=options.config, assignments=options.set)
    console, rng = Terminal(quiet=options.quiet), np.random.default_rng(options.seed)
    with console.status("loading the building …") as status:
        world = open_world(options.scene, config)
        with closing(world), closing(HttpServer(address)) as server:
            base = SimulatedBase(world, config.world, pace=_PACE)
            if options.start is None:
                start, start_z = world.truth.random_start(rng), None
            else:
                start, start_z = given_start(options.start)
            # Once: its odometry goes on from search to search, as that of a real robot.
            base.place(Episode(options.scene, "", _ANY, start, start_z=start_z), rng)
            said_s = -_SAY_EVERY_S
            while True:
                status.update(f"{options.name} waits for a goal from {escape(str(address))}/")
                try:
                    given = server.wait_for_goal(options.name)
                except LinkLostError as lost:
                    words = f"{options.name} finds no server at {address} ({lost}), trying again"
                    status.update(escape(words))
                    if not console.is_terminal and time.monotonic() - said_s >= _SAY_EVERY_S:
                        said_s = time.monotonic()
                        console.print(words, markup=False, soft_wrap=True)
                    time.sleep(_PAUSE_S)
                    continue
                if given.goal is None or given.key is None:
                    continue
                goal = Goal(given.goal).in_sentence
                try:
                    ending = _search(options, server, address, base, given, status)
                except RequestRefusedError as refused:
                    console.print(f"no search for {goal}: {refused}", markup=False)
                    time.sleep(_PAUSE_S)
                else:
                    console.print(f"{goal}: {ending or 'stopped'}", markup=False)


def _search(
    options: Wait,
    server: HttpServer,
    address: ServerAddress,
    base: SimulatedBase,
    given: GivenGoal,
    status: Status,
) -> SearchEnding | None:
    """Run a search to its end; returns None if a stop came before the next answer."""
    opened = server.open(
        OpenSearch(
            goal=given.goal or "",
            embodiment=base.embodiment,
            preset=options.preset,
            agent=options.agent,
            labels=base.config.labels,
            key=given.key,
        )
    )
    if opened.earlier_searches is not None:
        base.localise()
    client = RobotClient(DrivenRobot(base), HttpLink(address, opened.id))
    ending = None
    with StopListener(address, opened.id, client.stop):
        for step in client:
            reply = step.reply
            ending = reply.ending
            status.update(escape(f"step {reply.sequence + 1} · {reply.mode} · {reply.reason}"))
    return ending
