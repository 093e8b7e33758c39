"""The page and video of a search that a command drives on a server."""

from contextlib import AbstractContextManager, nullcontext

from hypernav.cli.robot_options import Ros2, Simulate
from hypernav.evaluation.recorder import EpisodeRecorder
from hypernav.robot.wire.replies import SearchOpened


def recording(
    options: Simulate | Ros2, opened: SearchOpened
) -> AbstractContextManager[EpisodeRecorder | None]:
    """The recorder of a search, or nothing where no folder is named."""
    if options.out is None:
        return nullcontext()
    detector, reasoner = opened.detector_and_reasoner
    return EpisodeRecorder(
        options.out,
        goal=options.goal,
        agent=options.agent or "hypernav",
        detector=detector,
        reasoner=reasoner,
        step_limit=options.max_steps,
    )
