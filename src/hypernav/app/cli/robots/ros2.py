"""The command `hypernav robot ros2`: a search on a robot that speaks ROS 2."""

import logging
import uuid
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager, suppress
from typing import TYPE_CHECKING, Any

from rich.markup import escape
from rich.status import Status

from hypernav.app.cli.guards.crashes import ExitStatus
from hypernav.app.cli.guards.interruptions import UninterruptedEnd, interruptions_put_off
from hypernav.app.cli.guards.outputs import check_folder
from hypernav.app.cli.options.agent import check_steps_and_seed
from hypernav.app.cli.robot import Ros2
from hypernav.app.cli.robots.own_server import server_at
from hypernav.app.cli.robots.recording import (
    found_start_values,
    memory_values,
    recording,
    status_of,
    steps_of,
)
from hypernav.app.cli.screen.search_lines import warnings_on
from hypernav.app.cli.screen.terminal import Terminal
from hypernav.app.cli.screen.views import Views, check_views
from hypernav.core.components.registry import require
from hypernav.core.episode import Outcome
from hypernav.core.errors import (
    ConfigError,
    LinkLostError,
    RequestRefusedError,
    RobotLinkError,
    RosNetworkError,
)
from hypernav.core.goal import Goal
from hypernav.io.layered_config import layered
from hypernav.lab.episodes.recorder import OUTPUT_FILES
from hypernav.robot.client.links import HttpLink, HttpServer, ServerAddress
from hypernav.robot.client.robot_client import RobotClient, StopListener
from hypernav.robot.wire.replies import SearchEnding, SearchOpened
from hypernav.robot.wire.requests import Intrinsics, OpenSearch

if TYPE_CHECKING:
    from hypernav.robot.ros2.config import Ros2Config
    from hypernav.robot.ros2.outputs import Ros2Outputs
    from hypernav.robot.ros2.sensing_robot import SensingRobot

_LOG = logging.getLogger(__name__)
_OUTCOMES: dict[SearchEnding | None, Outcome] = {
    SearchEnding.FOUND: Outcome.FOUND,
    SearchEnding.GAVE_UP: Outcome.NOT_FOUND,
    SearchEnding.MODEL_UNAVAILABLE: Outcome.MODEL_UNAVAILABLE,
}
"""Outcomes by the agent's claim; they cannot be measured here."""


def run(options: Ros2) -> int:
    """Run the command.

    Returns:
        The status of success if the agent says that the goal was found, of failure if not, or of a
        model outage.

    Raises:
        MissingExtraError: The package that speaks DDS is not installed.
        ConfigError: An option or the configuration is wrong.
        TopicChoiceError: No topic of the camera fits, or several do.
        RosNetworkError: There is no network, data doesn't arrive, or the robot doesn't stand still
            at the end.
        Nav2Error: Nav2 takes no goals, or never moves the robot.
        OutputError: A file cannot be written.
        ViewError: A viewer does not start.
        RobotLinkError: The server can't be reached.
        RequestRefusedError: The server refuses the search.
    """
    require("cyclonedds", extra="ros2")
    from hypernav.robot.ros2.config import Ros2Config
    from hypernav.robot.ros2.drives import check_drive

    check_steps_and_seed(options.max_steps, 0)
    goal = Goal(options.goal)
    if options.out is not None:
        check_folder(options.out, OUTPUT_FILES)
    check_views(options.views.chosen, options.out)
    if options.server is not None and options.own_server:
        raise ConfigError("--vlm, --detector and --reasoner are options of the server of --server")
    config = layered(Ros2Config(), file=options.config, environment={}, assignments=options.set)
    console = Terminal(quiet=options.quiet)
    with ExitStack() as shown:
        shown.enter_context(
            warnings_on(Terminal(), level=logging.ERROR) if options.quiet else warnings_on(console)
        )
        check_drive(options.drive, config)
        ending, views = _searched(options, goal, config, console, shown)
        views.stay(console)
    if ending is SearchEnding.MODEL_UNAVAILABLE:
        return ExitStatus.MODEL_UNAVAILABLE
    return ExitStatus.SUCCESS if ending is SearchEnding.FOUND else ExitStatus.FAILURE


def _searched(
    options: Ros2, goal: Goal, config: "Ros2Config", console: Terminal, shown: ExitStack
) -> tuple[SearchEnding | None, Views]:
    """Take control of the robot, search, and release it.

    Args:
        options: The options.
        goal: The object to find.
        config: The configuration, already checked.
        console: Terminal for messages.
        shown: Exit stack for the views, which stay open longer than the robot is needed.

    Returns:
        Ending, and the views.
    """
    from hypernav.robot.ros2.drives import opened_drive
    from hypernav.robot.ros2.network import Ros2Network
    from hypernav.robot.ros2.outputs import Ros2Outputs

    with (
        console.status("looking for the robot …") as status,
        closing(Ros2Network(config.domain_id)) as network,
        UninterruptedEnd(
            opened_drive(options.drive, network, config), "waiting until the robot stands"
        ) as (robot, senses),
        UninterruptedEnd(server_at(options.server, options.own_server)) as url,
        closing(HttpServer(ServerAddress.of(url, options.token_file))) as server,
        _opened(options, goal, senses, server) as opened,
    ):
        console.print(
            f"searching for {goal.in_sentence}; watch and stop it at {url}/", markup=False
        )
        link = HttpLink(server.address, opened.id)
        client = RobotClient(robot, link, continuous=options.is_continuous)
        outputs = Ros2Outputs(network, config)
        views = shown.enter_context(recording(options, opened))
        views.await_watchers(status)
        with StopListener(server.address, opened.id, client.stop):
            ending, length_m, stopped_by = _search(
                client, senses, server, opened, outputs, views, status
            )
            with interruptions_put_off("writing the page …"):
                detector, reasoner = opened.detector_and_reasoner
                told = status_of(server, opened)
                found = None if told is None else told.start
                result: dict[str, Any] = {
                    "goal": goal.text,
                    "scene": "a robot on ROS 2",
                    "agent": options.agent or "hypernav",
                    "preset": options.preset or "default",
                    "drive": options.drive,
                    "detector": detector,
                    "reasoner": reasoner,
                    **found_start_values(found),
                    **memory_values(opened, told),
                    "outcome": _OUTCOMES.get(ending, Outcome.INTERRUPTED),
                    "steps": steps_of(client.steps, told),
                    "path_length_m": length_m,
                    "blocked": client.blocked,
                    "late_answers": client.watchdog.times_late,
                    "config": config.model_dump(mode="json"),
                }
                views.finish(result)
        ended = f"{goal.in_sentence}: {ending or 'stopped'} after {result['steps']} steps"
        console.print(ended, markup=False)
        if found is not None:
            console.print(f"start {found.words}", markup=False)
        if stopped_by is not None:
            raise stopped_by
    return ending, views


@contextmanager
def _opened(
    options: Ros2, goal: Goal, senses: "SensingRobot", server: HttpServer
) -> Iterator[SearchOpened]:
    """A search of the server, closed at the end."""
    camera = senses.camera
    opened = server.open(
        OpenSearch(
            goal=goal.text,
            embodiment=senses.embodiment,
            intrinsics=Intrinsics(fx=camera.fx, fy=camera.fy, cx=camera.cx, cy=camera.cy),
            preset=options.preset,
            agent=options.agent,
            max_steps=options.max_steps,
            key=uuid.uuid4().hex,
        )
    )
    try:
        yield opened
    finally:
        with interruptions_put_off(), suppress(RobotLinkError, RequestRefusedError):
            server.close_search(opened.id)


def _search(
    client: RobotClient,
    senses: "SensingRobot",
    server: HttpServer,
    opened: SearchOpened,
    outputs: "Ros2Outputs",
    views: Views,
    status: Status,
) -> tuple[SearchEnding | None, float, KeyboardInterrupt | None]:
    """Run the search to its end, and publish what the server says about every step.

    Returns:
        Ending, length of the path by odometry, metres, and what interrupted the search; the robot
        stands then.
    """
    ending, known, length_m, before = None, 0, 0.0, senses.odometry()
    try:
        with closing(iter(client)) as steps:
            for step in steps:
                reply, sensed = step.reply, step.sensed
                ending = reply.ending
                length_m += before.distance_to(*sensed.odometry.xy)
                before = sensed.odometry
                status.update(escape(f"step {reply.sequence + 1} · {reply.mode} · {reply.reason}"))
                # An error of the display must not end the search; the next step catches up.
                try:
                    start = server.status(opened.id).start
                    for trace in server.trace(opened.id, since=known):
                        grid = server.grid(opened.id)
                        is_present = trace.step == reply.sequence
                        # The images of earlier steps are no longer available.
                        seen = senses.observation(sensed) if is_present else None
                        if seen is not None and start is not None:
                            seen = seen.in_frame(start.robot_to_map)
                        with interruptions_put_off():  # half a frame would break the video
                            views.add(trace, grid, seen)
                        known = trace.step + 1
                        if is_present:
                            frame, at_s = senses.sensors.calibration.frame, sensed.stamp_s
                            outputs.publish(
                                trace, grid, sensed.rgb, at_s=at_s, camera_frame=frame, start=start
                            )
                except (LinkLostError, RequestRefusedError, RosNetworkError) as error:
                    _LOG.warning("step %d is not shown: %s", reply.sequence + 1, error)
    except KeyboardInterrupt as stop:
        return ending, length_m, stop
    return ending, length_m, None
