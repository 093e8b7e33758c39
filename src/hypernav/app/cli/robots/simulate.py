"""The command `hypernav robot simulate`: a simulated robot on the network, with faults."""

import uuid
from collections.abc import Iterator
from contextlib import (
    closing,
    contextmanager,
    suppress,
)
from dataclasses import asdict
from typing import Any

import numpy as np
from rich.markup import escape
from rich.status import Status

from hypernav.app.build.presets import HyPerNavConfig
from hypernav.app.build.worlds import open_world
from hypernav.app.cli.find import check_start, start_pose, start_values
from hypernav.app.cli.guards.crashes import ExitStatus
from hypernav.app.cli.guards.interruptions import (
    Terminated,
    UninterruptedEnd,
    interruptions_put_off,
)
from hypernav.app.cli.guards.outputs import check_folder
from hypernav.app.cli.options.agent import check_steps_and_seed
from hypernav.app.cli.robot import Simulate
from hypernav.app.cli.robots.own_server import server_at
from hypernav.app.cli.robots.recording import (
    found_start_values,
    memory_values,
    recording,
    status_of,
    steps_of,
)
from hypernav.app.cli.screen.search_lines import ending_words
from hypernav.app.cli.screen.terminal import Terminal
from hypernav.app.cli.screen.views import Views, check_views
from hypernav.core.config import check_option
from hypernav.core.embodiment import Embodiment
from hypernav.core.episode import SUCCESS_DISTANCE_M, Episode, EpisodeMetrics, Outcome, measure
from hypernav.core.errors import RequestRefusedError, RobotLinkError
from hypernav.core.goal import Goal
from hypernav.io.layered_config import layered
from hypernav.lab.episodes.recorder import OUTPUT_FILES
from hypernav.robot.client.links import HttpLink, HttpServer, Link, ServerAddress, WebSocketLink
from hypernav.robot.client.robot_client import RobotClient, StopListener
from hypernav.robot.driving.driven_robot import DrivenRobot
from hypernav.robot.simulation.base import MishapConfig, SimulatedBase
from hypernav.robot.simulation.faulty_link import FaultyLink, NetworkFaults
from hypernav.robot.simulation.person import PersonConfig
from hypernav.robot.wire.replies import SearchEnding, SearchOpened
from hypernav.robot.wire.requests import OpenSearch
from hypernav.simulator.worlds.config import NoiseConfig

_PACE = 5.0
"""Simulated seconds per real second, for a robot that drives on while it waits for answers."""
_NOISE = NoiseConfig(
    depth_sigma_m=0.002,
    depth_edge_px=1,
    forward_sigma=0.02,
    turn_sigma_deg=1.0,
    odometry_sigma=0.01,
    odometry_turn_sigma_deg=0.5,
)


def run(options: Simulate) -> int:
    """Run the command.

    Returns:
        The status of success if the goal was found, of failure if not, or of a model outage.

    Raises:
        RobotLinkError: The server can't be reached.
        RequestRefusedError: The server refuses the search.
    """
    check_steps_and_seed(options.max_steps, options.seed)
    check_start(options.start)
    goal, faults, mishaps = Goal(options.goal), _faults(options), _mishaps(options)
    if options.out is not None:
        check_folder(options.out, OUTPUT_FILES)
    check_views(options.views.chosen, options.out)
    config = layered(HyPerNavConfig(), file=options.config, assignments=options.set)
    console = Terminal(quiet=options.quiet)
    with (
        UninterruptedEnd(server_at(options.server)) as url,
        closing(HttpServer(ServerAddress.of(url, options.token_file))) as server,
        console.status("loading the building …") as status,
        _placed(options, config, mishaps) as base,
    ):
        rng = np.random.default_rng(options.seed)
        start, start_z = start_pose(options.start, base.world, goal, rng)
        base.place(Episode(options.scene, "", goal, start, start_z=start_z), rng)
        opened = server.open(
            OpenSearch(
                goal=goal.text,
                embodiment=config.embodiment,
                preset=options.preset,
                agent=options.agent,
                max_steps=options.max_steps,
                labels=base.config.labels,
                key=uuid.uuid4().hex,
            )
        )
        if opened.earlier_searches is not None:
            base.localise()
        link = FaultyLink(_link(options, server.address, opened), faults, rng)
        continuous = options.motion == "continuous"
        client = RobotClient(DrivenRobot(base), link, continuous=continuous)
        region = base.world.truth.goal_truth(goal)
        shortest_m = region.distance(*base.position)
        try:
            with (
                recording(options, opened) as views,
                StopListener(server.address, opened.id, client.stop),
            ):
                views.await_watchers(status)
                ending, stopped_by = _search(
                    client, config.embodiment, server, opened, views, status
                )
                with interruptions_put_off("writing the page …"):
                    metrics = measure(
                        stopped=ending is SearchEnding.FOUND,
                        distance_to_goal_m=region.distance(*base.position),
                        shortest_path_m=shortest_m,
                        path_length_m=base.path_length_m,
                        success_distance_m=SUCCESS_DISTANCE_M,
                    )
                    told = status_of(server, opened)
                    found = None if told is None else told.start
                    result = {
                        "goal": goal.text,
                        "scene": options.scene,
                        "agent": options.agent or "hypernav",
                        "preset": options.preset or "default",
                        "detector": opened.detector_and_reasoner[0],
                        "reasoner": opened.detector_and_reasoner[1],
                        "seed": options.seed,
                        "start": start_values(start, start_z),
                        **found_start_values(found),
                        **memory_values(opened, told),
                        "outcome": _outcome(ending, metrics),
                        "steps": steps_of(client.steps, told),
                        **asdict(metrics),
                        **_mishap_numbers(base, client, link),
                        "config": config.model_dump(mode="json"),
                    }
                    views.finish(result)
                    status.stop()
                    _say(console, options, result)
                    if ending is SearchEnding.FAILED and told is not None:
                        console.print(f"  {escape(told.detail)}", soft_wrap=True)
                    if found is not None:
                        console.print(f"  start {escape(found.words)}", soft_wrap=True)
                if not isinstance(stopped_by, Terminated):
                    views.stay(console)
        finally:
            with interruptions_put_off(), suppress(RobotLinkError, RequestRefusedError):
                server.close_search(opened.id)
    if stopped_by is not None:
        raise stopped_by
    if ending is SearchEnding.MODEL_UNAVAILABLE:
        return ExitStatus.MODEL_UNAVAILABLE
    return ExitStatus.SUCCESS if metrics.success else ExitStatus.FAILURE


def _search(
    client: RobotClient,
    embodiment: Embodiment,
    server: HttpServer,
    opened: SearchOpened,
    views: Views,
    status: Status,
) -> tuple[SearchEnding | None, KeyboardInterrupt | None]:
    """Run the search to its end, and record what the server says about every step.

    Returns:
        Its ending, and what interrupted it; the robot stands then.
    """
    ending, known, camera = None, 0, embodiment.camera
    try:
        with closing(iter(client)) as steps:
            for step in steps:
                reply = step.reply
                ending = reply.ending
                status.update(escape(f"step {reply.sequence + 1} · {reply.mode} · {reply.reason}"))
                if views.are_open:
                    seen = step.sensed.observation(camera.intrinsics, camera.camera_to_base)
                    if (start := server.status(opened.id).start) is not None:
                        seen = seen.in_frame(start.robot_to_map)
                    for trace in server.trace(opened.id, since=known):
                        grid = server.grid(opened.id)
                        with interruptions_put_off():  # half a frame would break the video
                            views.add(trace, grid, seen)
                        known = trace.step + 1
                    views.keep_pace()
    except KeyboardInterrupt as stop:
        return ending, stop
    return ending, None


def _faults(options: Simulate) -> NetworkFaults:
    """What goes wrong on the network.

    Raises:
        ConfigError: A share or time is impossible.
    """
    shares = {"loss": options.loss, "duplicates": options.duplicates}
    for name, share in (shares | {"reordered": options.reordered}).items():
        check_option(f"--{name}", share, (0.0, 0.95), "a share of the messages")
    check_option("--jitter", options.jitter, (0.0, 60.0), "seconds")
    return NetworkFaults(
        loss_share=options.loss,
        jitter_s=options.jitter,
        duplicate_share=options.duplicates,
        reorder_share=options.reordered,
    )


def _mishaps(options: Simulate) -> MishapConfig:
    """What goes wrong with the robot.

    Raises:
        ConfigError: A share or length is impossible.
    """
    check_option("--stuck", options.stuck, (0.0, 0.95), "a share of the motions")
    if options.localisation is not None:
        check_option("--localisation", options.localisation, (0.0, 1.0), "metres")
    return MishapConfig(
        stuck_share=options.stuck,
        person=PersonConfig() if options.person else None,
        localisation_error_m=options.localisation,
    )


@contextmanager
def _placed(
    options: Simulate, config: HyPerNavConfig, mishaps: MishapConfig
) -> Iterator[SimulatedBase]:
    """The robot in its building."""
    if options.noise:
        world = config.world.model_copy(update={"noise": _NOISE})
        config = config.model_copy(update={"world": world})
    with closing(open_world(options.scene, config)) as opened:
        pace = _PACE if options.motion == "continuous" else None
        yield SimulatedBase(opened, config.world, mishaps, pace=pace)


def _link(options: Simulate, address: ServerAddress, opened: SearchOpened) -> Link:
    kind = WebSocketLink if options.link == "websocket" else HttpLink
    return kind(address, opened.id)


def _outcome(ending: SearchEnding | None, metrics: EpisodeMetrics) -> str:
    if ending is SearchEnding.MODEL_UNAVAILABLE:
        return Outcome.MODEL_UNAVAILABLE
    if ending in (SearchEnding.STOPPED, SearchEnding.CLOSED, SearchEnding.FAILED, None):
        return Outcome.INTERRUPTED
    if metrics.success:
        return Outcome.FOUND
    return Outcome.WRONG_PLACE if ending is SearchEnding.FOUND else Outcome.NOT_FOUND


def _mishap_numbers(
    base: SimulatedBase, client: RobotClient, link: FaultyLink
) -> dict[str, float | int | None]:
    """Counts of the mishaps, and of the robot's reactions."""
    return {
        "odometry_length_m": base.odometry_length_m,
        "robot_seconds": base.now_s,
        "blocked": client.blocked,
        "late_answers": client.watchdog.times_late,
        "sent_again": client.resent,
        "messages_lost": link.lost,
        "observations_doubled": link.doubled,
        "observations_reordered": link.reordered,
        "person_visits": 0 if base.person is None else base.person.visits,
        "smallest_gap_m": base.smallest_gap_m,
    }


def _say(console: Terminal, options: Simulate, result: dict[str, Any]) -> None:
    """The end of the search in a few lines."""
    console.print(ending_words(Outcome(result["outcome"]), Goal(options.goal)))
    console.print(
        f"  {result['steps']} steps, {result['path_length_m']:.1f} m driven "
        f"({result['odometry_length_m']:.1f} m by odometry), shortest "
        f"{result['shortest_path_m']:.1f} m, SPL {result['spl']:.2f}, "
        f"{result['robot_seconds']:.0f} s of driving",
        soft_wrap=True,
    )
    console.print(
        f"  {result['messages_lost']} messages lost, {result['observations_doubled']} doubled, "
        f"{result['observations_reordered']} reordered, {result['sent_again']} sent again; "
        f"{result['blocked']} motions blocked",
        soft_wrap=True,
    )
    if options.person:
        console.print(
            f"  a person stepped into the way {result['person_visits']} times; smallest gap "
            f"{result['smallest_gap_m']:.2f} m"
        )
    if options.out is not None:
        console.print(f"  open {escape(str(options.out / 'index.html'))}", soft_wrap=True)
