"""Page, video and views of a search that a command drives on a server."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import asdict

from hypernav.cli.options.robot import Ros2, Simulate
from hypernav.cli.screen.views import Views, opened_views
from hypernav.episodes.recorder import EpisodeRecorder
from hypernav.robot.wire.replies import SearchOpened
from hypernav.show.video.frame import EpisodeInfo


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
