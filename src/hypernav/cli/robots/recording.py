"""Page, video and views of a search that a command drives on a server."""

import logging
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import asdict
from typing import Any

from hypernav.cli.options.robot import Ros2, Simulate
from hypernav.cli.screen.views import Views, opened_views
from hypernav.core.errors import RequestRefusedError, RobotLinkError
from hypernav.episodes.recorder import EpisodeRecorder
from hypernav.robot.client.links import HttpServer
from hypernav.robot.wire.replies import SearchOpened, StartInMemory
from hypernav.show.video.frame import EpisodeInfo

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


def found_start_of(server: HttpServer, opened: SearchOpened) -> StartInMemory | None:
    """Where the robot took itself to be in the server's memory.

    Returns:
        None if it knew, or the server can't be asked any more.
    """
    try:
        return server.status(opened.id).start
    except (RobotLinkError, RequestRefusedError) as error:
        _LOG.warning("the result doesn't say where the search began: %s", error)
        return None


def steps_of(answers: int, start: StartInMemory | None) -> int:
    """Number of steps of a search, without the turns that found its start.

    Args:
        answers: Number of the server's answers.
        start: What the turns have shown; None if there were none.
    """
    return answers if start is None else answers - start.turns


def memory_values(opened: SearchOpened, start: StartInMemory | None) -> dict[str, Any]:
    """The memory that the search began with, for ``result.json``; empty if it began with none.

    Args:
        opened: What the server said when it opened the search.
        start: Where the robot took itself to be in the memory; None if it knew.
    """
    if opened.earlier_searches is None or (start is not None and not start.sure):
        return {}
    return {"memory": {"earlier_searches": opened.earlier_searches}}


def found_start_values(start: StartInMemory | None) -> dict[str, Any]:
    """The same for ``result.json``, which has the values of `hypernav find`."""
    frame = {"robot_frame", "robot_frame_z"}
    return (
        {} if start is None else {"found_start": start.model_dump(exclude=frame, exclude_none=True)}
    )
