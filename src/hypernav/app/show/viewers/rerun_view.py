"""Observation, map and trace of a step as archetypes of rerun, in the ``map`` frame (z up)."""

import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import rerun as rr
from rerun import blueprint as rrb
from scipy.spatial.transform import Rotation

from hypernav.app.show import captions
from hypernav.app.show.video_frame import EpisodeInfo
from hypernav.app.show.viewers.frame_data import (
    FloorHeights,
    Line,
    at_height,
    cloud,
    colour_jpeg,
    map_colors,
)
from hypernav.core.errors import ViewError
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Transform
from hypernav.core.observation import Observation
from hypernav.core.trace import DetectionRecord, Exchange, Mode, StepTrace
from hypernav.io.writing import OutputFile
from hypernav.search.drawing import palette

TIMELINE = "step"

_LINE_M, _POINT_M, _MARK_M, _ARROW_M = 0.02, 0.015, 0.12, 0.5
_FRUSTUM_M = 0.4
_STEPS_PER_SECOND = 5.0
_SEE_THROUGH = 0.999
"""Opacity of the map: at 1 its transparent cells would be black."""

HEADING = rr.Arrows3D(vectors=[[_ARROW_M, 0.0, 0.0]], colors=[palette.ROBOT], radii=[0.04])
"""An arrow ahead, in the frame of the robot."""

_APPLICATION = "hypernav"
_HOST = "127.0.0.1"
_PATIENCE_S = 30.0
_LOOK_S = 0.1
_OPENING_S = 1.5
"""Time after which a listening viewer has noticed that there is no screen."""
_MOST_WORDS = 300
_MOST_AT_ONCE = 65_536


def layout() -> rrb.Blueprint:
    """A layout of the viewer: building and map beside camera image, last answer and log.

    The points of all steps so far are shown together, so that the building grows.
    """
    since_start = rrb.VisibleTimeRanges(
        timeline=TIMELINE,
        start=rrb.TimeRangeBoundary.infinite(),
        end=rrb.TimeRangeBoundary.cursor_relative(),
    )
    return rrb.Blueprint(
        rrb.Horizontal(
            rrb.Vertical(
                rrb.Spatial3DView(
                    origin="map", name="Building", overrides={"map/points": [since_start]}
                ),
                rrb.Spatial3DView(
                    origin="map",
                    name="Map",
                    contents=["$origin/**", "- $origin/points", "- $origin/camera/**"],
                    background=[*palette.UNKNOWN_STRONG, 255],
                    line_grid=False,
                ),
            ),
            rrb.Vertical(
                rrb.Spatial2DView(origin="map/camera/image", name="Camera"),
                rrb.TextDocumentView(origin="answer", name="Last answer"),
                rrb.TextLogView(origin="log", name="Log"),
                row_shares=[3, 2, 2],
            ),
            column_shares=[3, 2],
        ),
        rrb.TimePanel(timeline=TIMELINE, fps=_STEPS_PER_SECOND, state="collapsed"),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
    )


def transform(child_to_parent: Transform) -> rr.Transform3D:
    """A pose in its parent's frame."""
    quaternion = Rotation.from_matrix(child_to_parent.rotation).as_quat()
    return rr.Transform3D(
        translation=child_to_parent.translation, quaternion=rr.Quaternion(xyzw=quaternion)
    )


def cells(grid: OccupancyGrid, floor_m: float) -> rr.GridMap:
    """The explored part of the map, as an image with its first row on top, at a floor's height."""
    seen = grid.cropped()
    rows, columns = seen.cells.shape
    return rr.GridMap(
        data=map_colors(seen)[::-1].tobytes(),
        format=rr.components.ImageFormat(
            width=columns, height=rows, color_model="RGBA", channel_datatype="U8"
        ),
        cell_size=seen.resolution_m,
        translation=[*seen.origin, floor_m],
        opacity=_SEE_THROUGH,
    )


def lines(strips: Sequence[Line], color: palette.Rgb) -> rr.LineStrips3D:
    """Lines just above their points; those of a single point are left out."""
    lifted = [[(x, y, z + _LINE_M) for x, y, z in strip] for strip in strips if len(strip) > 1]
    return rr.LineStrips3D(lifted, colors=[color] * len(lifted), radii=_LINE_M)


def blocks(step: StepTrace, floor_m: float) -> rr.LineStrips3D:
    """The numbered blocks of a question, at a floor's height; the chosen one stands out."""
    chosen = [one.chosen for one in step.exchanges if one.chosen is not None]
    squares, colors = [], []
    for block in step.blocks:
        left, bottom, side = block.x_min, block.y_min, block.size_m
        corners = ((0, 0), (1, 0), (1, 1), (0, 1), (0, 0))
        square = [(left + x * side, bottom + y * side) for x, y in corners]
        squares.append(at_height(square, floor_m + _LINE_M))
        is_chosen = bool(chosen) and block.number == chosen[-1]
        colors.append(palette.CHOSEN if is_chosen else palette.FAINT)
    labels = [str(block.number) for block in step.blocks]
    return rr.LineStrips3D(squares, colors=colors, labels=labels, radii=_LINE_M)


def pinhole(camera: PinholeCamera) -> rr.Pinhole:
    """The intrinsics of the camera."""
    return rr.Pinhole(
        focal_length=(camera.fx, camera.fy),
        principal_point=(camera.cx, camera.cy),
        resolution=(camera.width, camera.height),
        image_plane_distance=_FRUSTUM_M,
    )


def image(observation: Observation) -> rr.EncodedImage:
    """The colour image."""
    return rr.EncodedImage(contents=colour_jpeg(observation), media_type="image/jpeg")


def points(observation: Observation) -> rr.Points3D:
    """The thinned depth image as coloured points in the map."""
    positions, colors = cloud(observation)
    return rr.Points3D(positions, colors=colors, radii=_POINT_M)


def masks(detections: Sequence[DetectionRecord]) -> rr.LineStrips2D:
    """Outlines of the refined masks over the colour image."""
    outlines = [(line, _color(one)) for one in detections for line in one.outlines]
    return rr.LineStrips2D(
        [[*line, line[0]] for line, _ in outlines], colors=[color for _, color in outlines]
    )


def boxes(detections: Sequence[DetectionRecord]) -> rr.Boxes2D:
    """Boxes and labels over the colour image; green is accepted."""
    return rr.Boxes2D(
        array=[one.box for one in detections],
        array_format=rr.Box2DFormat.XYXY,
        labels=[captions.detections_caption([one]) for one in detections],
        colors=[_color(one) for one in detections],
    )


def _color(detection: DetectionRecord) -> palette.Rgb:
    return palette.GOAL if detection.accepted else palette.CHOSEN


def _words(step: int, exchange: Exchange) -> str:
    asked = captions.answerer_caption(exchange)
    return (
        f"## {captions.question_caption(exchange)}\n\n{exchange.answer}\n\n"
        f"*Step {step}, {asked}*\n\n> {captions.final_question(exchange.question)}"
    )


def destination(step: StepTrace) -> rr.Points3D:
    """Where the robot is going, if anywhere."""
    marks = [] if step.destination is None else [(*step.destination, step.z + _LINE_M)]
    return rr.Points3D(marks, colors=[palette.PATH] * len(marks), radii=_MARK_M)


def answers(step: StepTrace) -> rr.TextDocument:
    """The questions of a step and their answers."""
    return document("\n\n".join(_words(step.step, one) for one in step.exchanges))


def document(text: str) -> rr.TextDocument:
    """A text in Markdown."""
    return rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN)


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
        recording.send_blueprint(layout())
        recording.log("map", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        recording.log("map/robot/heading", HEADING, static=True)

    def log(
        self, step: StepTrace, grid: OccupancyGrid | None, observation: Observation | None
    ) -> None:
        self._trajectory.append((*step.pose[:2], step.z))
        floor_m = self._floors.of(step)
        log = self._recording.log
        self._recording.set_time(TIMELINE, sequence=step.step)
        if observation is not None:
            log("map/robot", transform(observation.robot.to_transform(step.z)))
            log("map/camera", transform(observation.camera_to_map))
            log("map/camera/image", pinhole(observation.camera), image(observation))
            log("map/camera/image/boxes", boxes(step.detections))
            log("map/camera/image/masks", masks(step.detections))
            log("map/points", points(observation))
        if grid is not None:
            log("map/cells", cells(grid, floor_m))
        path = at_height([step.pose[:2], *step.path] if step.path else [], step.z)
        area = [at_height([*outline, outline[0]], floor_m) for outline in step.goal_area]
        log("map/trajectory", lines([self._trajectory], palette.TRAJECTORY_NEW))
        log("map/path", lines([path], palette.PATH))
        log("map/destination", destination(step))
        log("map/goal_area", lines(area, palette.GOAL))
        if step.blocks:
            log("map/blocks", blocks(step, floor_m))
        elif step.mode is not Mode.EXPLORE:
            log("map/blocks", rr.Clear(recursive=False))
        for line in (
            f"{captions.floor_prefix(step)}{captions.MODES[step.mode]}: {step.reason}",
            *step.events,
        ):
            log("log", rr.TextLog(line, level=rr.TextLogLevel.INFO))
        if step.exchanges:
            log("answer", answers(step))

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
