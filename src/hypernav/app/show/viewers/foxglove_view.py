"""Searches for Foxglove: in an MCAP file, or live over a WebSocket."""

import json
import time
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import foxglove
from foxglove import channels, websocket
from foxglove import messages as fg

from hypernav.app.show import captions
from hypernav.app.show.video_frame import EpisodeInfo
from hypernav.app.show.viewers import foxglove_messages as made
from hypernav.app.show.viewers.frame_data import FloorHeights, Line
from hypernav.core.errors import ViewError
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.observation import Observation
from hypernav.core.trace import Mode, StepTrace, json_values
from hypernav.io.writing import OutputFile

_SECOND_NS = 1_000_000_000
_HOST, _PORT = "127.0.0.1", 8765
_STEP_NS = _SECOND_NS
"""Time between two recorded steps; constant, so that equal searches give equal messages."""


class _Watchers(websocket.ServerListener):
    """Notes that somebody has subscribed."""

    came = False

    def on_subscribe(self, client: websocket.Client, channel: websocket.ChannelView) -> None:
        self.came = True


class _Topics:
    """The topics of a search, to which every step is published."""

    def __init__(self, context: foxglove.Context) -> None:
        self._context = context  # keeps all channels open
        self._trajectory: Line = []
        self._floors = FloorHeights()
        self._asked: StepTrace | None = None
        self._tf = channels.FrameTransformsChannel("/tf", context=context)
        self._pose = channels.PoseInFrameChannel("/robot/pose", context=context)
        self._image = channels.CompressedImageChannel("/camera/image", context=context)
        self._camera = channels.CameraCalibrationChannel("/camera/calibration", context=context)
        self._seen = channels.ImageAnnotationsChannel("/camera/detections", context=context)
        self._points = channels.PointCloudChannel("/camera/points", context=context)
        self._map = channels.GridChannel("/map", context=context)
        self._scene = channels.SceneUpdateChannel("/plan", context=context)
        self._log = channels.LogChannel("/log", context=context)
        self._step = foxglove.Channel("/step", schema=made.STEP_SCHEMA, context=context)
        self._questions = foxglove.Channel(
            "/questions", schema=made.QUESTION_SCHEMA, context=context
        )

    def publish(
        self,
        step: StepTrace,
        grid: OccupancyGrid | None,
        observation: Observation | None,
        time_ns: int,
    ) -> None:
        stamp = fg.Timestamp(*divmod(time_ns, _SECOND_NS))
        self._note(step)
        floor_m = self._floors.of(step)
        if observation is not None:
            self._tf.log(made.transforms(stamp, observation, step.z), log_time=time_ns)
            self._image.log(made.image(stamp, observation), log_time=time_ns)
            self._camera.log(made.calibration(stamp, observation.camera), log_time=time_ns)
            self._seen.log(made.annotations(stamp, step.detections), log_time=time_ns)
            self._points.log(made.point_cloud(stamp, observation), log_time=time_ns)
        if grid is not None:
            self._map.log(made.map_grid(stamp, grid, floor_m), log_time=time_ns)
        self._pose.log(made.robot_pose(stamp, step), log_time=time_ns)
        plan = made.scene(stamp, step, self._trajectory, self._asked, floor_m)
        self._scene.log(plan, log_time=time_ns)
        for line in made.log(stamp, step):
            self._log.log(line, log_time=time_ns)
        self._step.log(made.step_fields(step), log_time=time_ns)
        for exchange in step.exchanges:
            self._questions.log(made.question_fields(step.step, exchange), log_time=time_ns)

    def publish_end(self, result: Mapping[str, Any], time_ns: int) -> None:
        stamp = fg.Timestamp(*divmod(time_ns, _SECOND_NS))
        words = captions.headline(result).text
        line = fg.Log(timestamp=stamp, level=fg.LogLevel.Info, message=words, name="result")
        self._log.log(line, log_time=time_ns)

    def _note(self, step: StepTrace) -> None:
        self._trajectory.append((*step.pose[:2], step.z))
        if step.blocks:
            self._asked = step
        elif step.mode is not Mode.EXPLORE:
            self._asked = None


class McapView:
    """A search as an MCAP file, for Foxglove, Lichtblick and everything else that reads MCAP.

    Steps are a second apart. However the search ends, the file is complete up to its last step.
    """

    def __init__(self, path: Path, info: EpisodeInfo) -> None:
        """Open the file.

        Args:
            path: Path of the file; an existing file is replaced, missing folders are created.
            info: Goal and components of the search.

        Raises:
            OutputError: It cannot be written.
        """
        self._file = OutputFile(path)
        context = foxglove.Context()
        options = foxglove.mcap.MCAPWriteOptions(profile="hypernav", compression_threads=0)
        self._writer = foxglove.open_mcap(self._file, context=context, writer_options=options)
        self._topics = _Topics(context)
        self._steps = 0
        self._is_open = True
        known = {name: str(value) for name, value in asdict(info).items() if value}
        self._writer.write_metadata("search", known)

    def add(
        self, step: StepTrace, grid: OccupancyGrid | None, observation: Observation | None
    ) -> None:
        """Write a step; see `hypernav.core.trace.View`."""
        self._topics.publish(step, grid, observation, self._steps * _STEP_NS)
        self._steps += 1
        self._file.check()

    def finish(self, result: Mapping[str, Any]) -> None:
        """Write the result, as metadata and as the last line of the log, and finish the file."""
        self._topics.publish_end(result, self._steps * _STEP_NS)
        values = {name: json.dumps(value) for name, value in json_values(result).items()}
        self._writer.write_metadata("result", values)
        self.close()
        self._file.check()

    def close(self) -> None:
        """Finish the file; does nothing the second time."""
        if self._is_open:
            self._is_open = False
            self._writer.close()
            self._file.close()


class FoxgloveView:
    """A search live in Foxglove, which connects to a WebSocket of this machine.

    Times are real; a late subscriber misses the earlier messages.
    """

    def __init__(self, info: EpisodeInfo) -> None:
        """Start listening, on the port that Foxglove suggests or another.

        Args:
            info: Goal and components of the search.
        """
        context = foxglove.Context()
        self._topics = _Topics(context)
        self._watchers = _Watchers()
        self._server = _listening(f"hypernav: {info.goal}", context, self._watchers)

    @property
    def address(self) -> str:
        """The address of the WebSocket, and that of Foxglove in a browser."""
        return f"ws://{_HOST}:{self._server.port} in Foxglove, or {self._server.app_url()}"

    def has_watcher(self) -> bool:
        """Whether anybody has subscribed to a topic."""
        return self._watchers.came

    def add(
        self, step: StepTrace, grid: OccupancyGrid | None, observation: Observation | None
    ) -> None:
        """Send a step; see `hypernav.core.trace.View`."""
        self._topics.publish(step, grid, observation, time.time_ns())

    def finish(self, result: Mapping[str, Any]) -> None:
        """Say how the search ended, in the log."""
        self._topics.publish_end(result, time.time_ns())

    def close(self) -> None:
        """Stop listening."""
        self._server.stop()


def _listening(
    name: str, context: foxglove.Context, listener: _Watchers
) -> websocket.WebSocketServer:
    """A server on the usual port or, if that is taken, on another."""
    for port in (_PORT, 0):
        try:
            return foxglove.start_server(
                name=name, host=_HOST, port=port, context=context, server_listener=listener
            )
        except RuntimeError as error:
            refused = error
    raise ViewError(f"Foxglove's server cannot listen on {_HOST} ({refused})")
