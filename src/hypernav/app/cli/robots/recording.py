"""Page, video and views of a search that a command drives on a server."""

import logging
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import asdict
from typing import Any

from hypernav.app.cli.robot import Ros2, Simulate
from hypernav.app.cli.screen.views import Views, opened_views
from hypernav.app.show.video_frame import EpisodeInfo
from hypernav.core.errors import RequestRefusedError, RobotLinkError
from hypernav.lab.episodes.recorder import EpisodeRecorder
from hypernav.robot.client.links import HttpServer
from hypernav.robot.wire.replies import SearchOpened, StartInMemory, Status

_LOG = logging.getLogger(__name__)


@contextmanager
def recording(options: Simulate | Ros2, opened: SearchOpened) -> Iterator[Views]:
    """All outputs of a search: its page if a folder is named, and the views asked for.

    Raises:
        OutputError: A file cannot be written.
        ViewError: A viewer does not start.
    """
    detector, reasoner = opened.detector_and_reasoner
    info = EpisodeInfo(
        goal=options.goal,
        agent=options.agent or "hypernav",
        detector=detector,
        reasoner=reasoner,
        step_limit=options.max_steps,
    )
    with ExitStack() as files:
        recorder = None
        if options.out is not None:
            recorder = files.enter_context(EpisodeRecorder(options.out, **asdict(info)))
        yield files.enter_context(opened_views(options.views.chosen, info, recorder))


def status_of(server: HttpServer, opened: SearchOpened) -> Status | None:
    """What the server says of a search at its end.

    Returns:
        None if the server can't be asked any more.
    """
    try:
        return server.status(opened.id)
    except (RobotLinkError, RequestRefusedError) as error:
        _LOG.warning("the result doesn't say where the search began: %s", error)
        return None


def steps_of(answers: int, status: Status | None) -> int:
    """Number of steps of a search, without the turns that found its start.

    Args:
        answers: Number of the server's answers.
        status: What the server says of the search; None if it can't be asked.
    """
    if status is None:
        return answers
    if not _has_step(status):
        return 0
    return answers if status.start is None else answers - status.start.turns


def memory_values(opened: SearchOpened, status: Status | None) -> dict[str, Any]:
    """The memory that the search began with, for ``result.json``; empty if it began with none.

    Args:
        opened: What the server said when it opened the search.
        status: What it says of the search; None if it can't be asked.
    """
    if opened.earlier_searches is None:
        return {}
    is_lost = status is not None and status.start is not None and not status.start.sure
    if is_lost or (status is not None and not _has_step(status)):
        return {}
    return {"memory": {"earlier_searches": opened.earlier_searches}}


def _has_step(status: Status) -> bool:
    """Whether the agent has decided anything: it has no pose while a robot finds its start."""
    return status.pose is not None


def found_start_values(start: StartInMemory | None) -> dict[str, Any]:
    """Where the robot took itself to be in the memory, for ``result.json``, as in `hypernav find`.

    Args:
        start: The same; None if it knew, or had not found out.
    """
    frame = {"robot_frame", "robot_frame_z"}
    return (
        {} if start is None else {"found_start": start.model_dump(exclude=frame, exclude_none=True)}
    )
