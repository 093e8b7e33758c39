"""Searches for rerun: in an ``.rrd`` file, or live in its viewer."""

import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import rerun as rr

from hypernav.core.errors import ViewError
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.observation import Observation
from hypernav.core.trace import Mode, StepTrace
from hypernav.io.writing import OutputFile
from hypernav.show import captions
from hypernav.show.drawing import palette
from hypernav.show.video.frame import EpisodeInfo
from hypernav.show.views import rerun_archetypes as made
from hypernav.show.views.frame_data import FloorHeights, Line, at_height

_APPLICATION = "hypernav"
_HOST = "127.0.0.1"
_PATIENCE_S = 30.0
_LOOK_S = 0.1
_OPENING_S = 1.5
"""Time after which a listening viewer has noticed that there is no screen."""
_MOST_WORDS = 300
_MOST_AT_ONCE = 65_536


class _Entities:
    """The entities of a search, on one timeline: the number of the step."""

    def __init__(self, recording: rr.RecordingStream, info: EpisodeInfo) -> None:
        self._recording = recording
        self._trajectory: Line = []
        self._floors = FloorHeights()
        # Clock times would make the recordings of equal searches differ.
        recording.set_log_time_enabled(False)
        recording.set_log_tick_enabled(False)
        recording.send_recording_name(f"{info.goal} · {info.agent}")
        recording.send_blueprint(made.layout())
        recording.log("map", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        recording.log("map/robot/heading", made.HEADING, static=True)

    def log(
        self, step: StepTrace, grid: OccupancyGrid | None, observation: Observation | None
    ) -> None:
        self._trajectory.append((*step.pose[:2], step.z))
        floor_m = self._floors.of(step)
        log = self._recording.log
        self._recording.set_time(made.TIMELINE, sequence=step.step)
        if observation is not None:
            log("map/robot", made.transform(observation.robot.to_transform(step.z)))
            log("map/camera", made.transform(observation.camera_to_map))
            log("map/camera/image", made.pinhole(observation.camera), made.image(observation))
            log("map/camera/image/boxes", made.boxes(step.detections))
            log("map/camera/image/masks", made.masks(step.detections))
            log("map/points", made.points(observation))
        if grid is not None:
            log("map/cells", made.cells(grid, floor_m))
        path = at_height([step.pose[:2], *step.path] if step.path else [], step.z)
        area = [at_height([*outline, outline[0]], floor_m) for outline in step.goal_area]
        log("map/trajectory", made.lines([self._trajectory], palette.TRAJECTORY_NEW))
        log("map/path", made.lines([path], palette.PATH))
        log("map/destination", made.destination(step))
        log("map/goal_area", made.lines(area, palette.GOAL))
        if step.blocks:
            log("map/blocks", made.blocks(step, floor_m))
        elif step.mode is not Mode.EXPLORE:
            log("map/blocks", rr.Clear(recursive=False))
        for line in (
            f"{captions.floor_prefix(step)}{captions.MODES[step.mode]}: {step.reason}",
            *step.events,
        ):
            log("log", rr.TextLog(line, level=rr.TextLogLevel.INFO))
        if step.exchanges:
            log("answer", made.answers(step))

    def log_end(self, result: Mapping[str, Any]) -> None:
        headline = captions.headline(result)
        self._recording.log("log", rr.TextLog(headline.text, level=rr.TextLogLevel.INFO))


class RrdView:
    """A search as an ``.rrd`` file of rerun. However it ends, the file holds every step."""

    def __init__(self, path: Path, info: EpisodeInfo) -> None:
        """Open the file.

        Args:
            path: Path of the file; an existing file is replaced, missing folders are created.
            info: Goal and components of the search.

        Raises:
            OutputError: It cannot be written.
        """
        self._file = OutputFile(path)
        self._recording = rr.RecordingStream(_APPLICATION)
        self._relay = _saved_to(self._recording, self._file)
        self._entities = _Entities(self._recording, info)

    def add(
        self, step: StepTrace, grid: OccupancyGrid | None, observation: Observation | None
    ) -> None:
        """Write a step; see `hypernav.core.trace.View`."""
        self._entities.log(step, grid, observation)
        self._flush()

    def finish(self, result: Mapping[str, Any]) -> None:
        """Write how the search ended."""
        self._entities.log_end(result)
        self._flush()

    def close(self) -> None:
        """Finish the file."""
        self._recording.disconnect()
        self._relay.join()
        self._file.close()

    def _flush(self) -> None:
        self._recording.flush(timeout_sec=_PATIENCE_S)
        self._file.check()


def _saved_to(recording: rr.RecordingStream, file: OutputFile) -> threading.Thread:
    """Save a recording to a file by a thread: rerun itself prints, and waits for good, on errors.

    Returns:
        The thread, which ends after the recording.
    """
    taken, given = os.pipe()

    def relay() -> None:
        while data := os.read(taken, _MOST_AT_ONCE):
            file.write(data)
        os.close(taken)

    thread = threading.Thread(target=relay, name="rrd", daemon=True)
    thread.start()
    try:
        recording.save(f"/dev/fd/{given}")
    finally:
        os.close(given)
    return thread


class RerunView:
    """A search live in the viewer of rerun, which stays open after the search."""

    def __init__(self, info: EpisodeInfo) -> None:
        """Start the viewer, reachable from this machine only, and wait until it listens.

        Args:
            info: Goal and components of the search.

        Raises:
            ViewError: It does not start, for example because there is no screen.
        """
        self._recording = rr.RecordingStream(_APPLICATION)
        self._recording.connect_grpc(f"rerun+http://{_HOST}:{_started_viewer()}/proxy")
        self._entities = _Entities(self._recording, info)

    def add(
        self, step: StepTrace, grid: OccupancyGrid | None, observation: Observation | None
    ) -> None:
        """Send a step; see `hypernav.core.trace.View`. A closed viewer is no error."""
        self._entities.log(step, grid, observation)

    def finish(self, result: Mapping[str, Any]) -> None:
        """Send how the search ended."""
        self._entities.log_end(result)

    def close(self) -> None:
        """Send what is left, and leave the viewer open."""
        self._recording.disconnect()


def _started_viewer() -> int:
    """Start a viewer; returns its port.

    rerun's own function to start one would let it listen to the whole network.

    Raises:
        ViewError: It does not start.
    """
    with socket.create_server((_HOST, 0)) as probe:
        port = probe.getsockname()[1]
    command = [sys.executable, "-m", "rerun_cli", "--bind", _HOST, "--port", str(port)]
    with tempfile.TemporaryFile("w+") as said:
        viewer = subprocess.Popen(
            [*command, "--expect-data-soon"],
            env=os.environ | {"RERUN_APP_ONLY": "true", "RUST_LOG": "error", "NO_COLOR": "1"},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=said,
            start_new_session=True,  # so that Ctrl-C ends the search, not the viewer
        )
        listens = False
        try:
            end_s = time.monotonic() + _PATIENCE_S
            while time.monotonic() < end_s and viewer.poll() is None and not _answers(port):
                time.sleep(_LOOK_S)
            time.sleep(_OPENING_S)
            listens = viewer.poll() is None and _answers(port)
        finally:  # Ctrl-C during the wait as well
            if not listens and viewer.poll() is None:
                os.killpg(viewer.pid, signal.SIGKILL)
                viewer.wait()
        if listens:
            return port
        said.seek(0)
        reason = " ".join(said.read().split())[:_MOST_WORDS]
    raise ViewError(
        f"the viewer of rerun did not start: {reason}; without a screen, record a file with --rrd "
        "FILE and open it elsewhere"
    )


def _answers(port: int) -> bool:
    """Whether a program listens on a port of this machine."""
    try:
        socket.create_connection((_HOST, port), timeout=_LOOK_S).close()
    except OSError:
        return False
    return True
