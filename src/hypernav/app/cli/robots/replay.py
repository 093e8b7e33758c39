"""The command `hypernav robot replay`: recorded RGB-D frames through mapping and perception."""

import os
import time
from contextlib import closing
from dataclasses import asdict
from datetime import datetime
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

from rich.markup import escape

from hypernav.app.cli.guards.crashes import ExitStatus, crash_report
from hypernav.app.cli.guards.outputs import check_folder
from hypernav.app.cli.robot import Replay
from hypernav.app.cli.screen.terminal import Terminal
from hypernav.app.cli.screen.views import check_views, opened_views
from hypernav.app.show.video_frame import EpisodeInfo
from hypernav.core.config import check_option
from hypernav.core.errors import ConfigError
from hypernav.core.goal import Goal
from hypernav.lab.episodes.recorder import OUTPUT_FILES, EpisodeRecorder
from hypernav.robot.recordings.opening import open_recording
from hypernav.robot.recordings.replay import UprightRecording, replayed
from hypernav.robot.ros.topics import CameraTopics
from hypernav.search.agents.step import SearchComponents

_LONGEST_NAME = 80


@runtime_checkable
class _SeesByItself(Protocol):
    """An agent whose map and local perception can be asked without it."""

    @property
    def components(self) -> SearchComponents: ...


def run(options: Replay) -> int:
    """Run the command.

    Returns:
        The status of success.

    Raises:
        RecordingError: The recording cannot be read.
        TopicChoiceError: No topic of a bag fits, or several do.
        ConfigError: There is a goal but no detector, or a detector but no goal.
    """
    check_option("--every", options.every, (1, 100_000), "takes every n-th frame")
    if options.depth_per_metre is not None:
        check_option("--depth-per-metre", options.depth_per_metre, (1e-3, 1e6), "1000: millimetres")
    sees = options.who.detector is not None or options.who.vlm is not None
    if sees != (options.goal is not None):
        raise ConfigError(
            "--goal needs something that looks for it, --detector or --vlm, and they need a "
            "--goal; without both only the map is drawn"
        )
    name = os.path.basename(os.path.abspath(options.recording))[:_LONGEST_NAME]
    folder = options.out or Path("runs") / f"{datetime.now():%Y%m%d-%H%M%S}-{name}"
    check_folder(folder, OUTPUT_FILES)
    check_views(options.views.chosen, folder)
    with crash_report(folder):
        return _replay(options, folder)


def _replay(options: Replay, folder: Path) -> ExitStatus:
    topics = CameraTopics(options.colour_topic, options.depth_topic, options.camera_info_topic)
    console, unit = Terminal(quiet=options.quiet), options.depth_per_metre
    with closing(open_recording(options.recording, topics, depth_per_metre=unit)) as recording:
        for note in recording.notes:
            console.print(f"[yellow]{escape(note)}[/]", soft_wrap=True)
        return _mapped(options, folder, UprightRecording(recording))


def _mapped(options: Replay, folder: Path, upright: UprightRecording) -> ExitStatus:
    config = options.who.resolve()
    config = config.model_copy(update={"embodiment": upright.robot(config.embodiment)})
    goal = None if options.goal is None else Goal(options.goal)
    console, began = Terminal(quiet=options.quiet), time.perf_counter()
    detector, recording = "nothing: only the map is drawn", upright.recording
    with (
        closing(options.who.build(config, record=options.record)) as parts,
        console.status("reading …") as status,
    ):
        if not isinstance(parts.agent, _SeesByItself):
            raise ConfigError(f"--agent {options.who.agent} has no local perception of its own")
        if goal is not None:
            parts.check_goal(goal)
            detector = parts.detector_words
        info = EpisodeInfo(
            goal=options.goal or "nothing",
            agent="replay",
            detector=detector,
            reasoner="nothing: the recording is what it is",
            step_limit=len(recording.frames[:: options.every]),
        )
        with (
            EpisodeRecorder(folder, **asdict(info)) as recorder,
            opened_views(options.views.chosen, info, recorder) as views,
        ):
            views.await_watchers(status)
            sightings = 0
            steps = replayed(upright, parts.agent.components, goal, every=options.every)
            for step in steps:
                views.add(step.trace, step.grid, step.observation)
                sightings += any(one.accepted for one in step.trace.detections)
                status.update(f"frame {step.trace.step + 1}: {escape(step.trace.reason)}")
                views.keep_pace()
            count = len(recorder.steps)
            result: dict[str, Any] = {
                "goal": options.goal or "nothing",
                "scene": recording.name,
                "agent": "replay",
                "preset": options.who.preset,
                "detector": detector,
                "segmenter": parts.segmenter.words if goal else None,
                "outcome": "replayed",
                "detail": f"{count} recorded frames"
                + (f", the {options.goal} accepted in {sightings}." if goal else "."),
                "steps": count,
                "sightings": sightings,
                "notes": list(recording.notes),
                "camera_height_m": config.embodiment.camera.height_m,
                "seconds": {"total": round(time.perf_counter() - began, 3)},
                "config": config.model_dump(mode="json"),
            }
            views.finish(result)
            status.stop()
            console.print(f"replayed {result['detail']}", markup=False, soft_wrap=True)
            console.print(f"  open {folder / 'index.html'}", markup=False, soft_wrap=True)
            views.stay(console)
    return ExitStatus.SUCCESS
