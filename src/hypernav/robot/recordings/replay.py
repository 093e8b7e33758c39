"""Runs a recording through mapping and local perception, to try a new camera."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from hypernav.core.embodiment import Embodiment
from hypernav.core.errors import RecordingError
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import Mode, ModuleClock, StepTrace
from hypernav.robot.recordings.recording import RecordedFrame, Recording
from hypernav.search.agents.step import SearchComponents
from hypernav.search.memory.memory import Memory

_MOST_FRAMES = 40
"""Number of frames, spread over the recording, in which the floor is searched."""
_STRIDE = 8
_FARTHEST_M = 5.0
_BIN_M = 0.02
_FLOOR_SHARE = 0.2
"""Smallest share of the floor's points in those of the fullest level."""


def world_to_map(recording: Recording) -> Transform:
    """The transform from the recording's world to the ``map`` frame.

    The world's axis that points up most in the images is up; the floor is the lowest level with
    many points; the first camera stands at x = y = 0 and looks along x.

    Raises:
        RecordingError: No image has depth, or the first camera looks straight up or down.
    """
    upright = _turned_upright(recording)
    floor_m = _floor_height(recording, upright)
    first = upright @ recording.frames[0].camera_to_world
    forward = first.rotation[:, 2]
    if math.hypot(forward[0], forward[1]) < 0.2:
        raise RecordingError(
            f"{recording.name}: the first camera looks straight up or down; begin the recording "
            "with a look along the floor"
        )
    yaw = math.atan2(forward[1], forward[0])
    c, s = math.cos(yaw), math.sin(yaw)
    to_start = Transform(np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]), np.zeros(3))
    x, y, _ = first.translation
    return to_start @ Transform(np.eye(3), np.array([-x, -y, -floor_m])) @ upright


def _turned_upright(recording: Recording) -> Transform:
    """The rotation that takes the world's upward axis to z."""
    ups = np.array([-frame.camera_to_world.rotation[:, 1] for frame in recording.frames])
    mean = ups.mean(axis=0)
    axis = int(np.abs(mean).argmax())
    up = np.zeros(3)
    up[axis] = math.copysign(1.0, float(mean[axis]))
    side = np.roll(np.abs(up), 1)
    return Transform(np.array([side, np.cross(up, side), up]), np.zeros(3))


def _floor_height(recording: Recording, upright: Transform) -> float:
    """Height of the lowest level with many points, metres."""
    every = max(len(recording.frames) // _MOST_FRAMES, 1)
    heights: list[Float64[np.ndarray, " n"]] = []
    for frame in recording.frames[::every]:
        depth = frame.depth()[::_STRIDE, ::_STRIDE]
        rows, columns = np.nonzero(is_measured(depth, 0.0, _FARTHEST_M))
        points = recording.camera.unproject_pixels(
            rows * _STRIDE, columns * _STRIDE, depth[rows, columns].astype(np.float64)
        )
        heights.append((upright @ frame.camera_to_world).apply(points)[:, 2])
    levels = np.concatenate(heights)
    if levels.size == 0:
        raise RecordingError(f"{recording.name}: no depth image has a return within 5 m")
    edges = np.arange(levels.min() - _BIN_M, levels.max() + 2 * _BIN_M, _BIN_M)
    counts, edges = np.histogram(levels, edges)
    # Noise and tilt spread a floor over several bins.
    smooth = np.convolve(counts, np.ones(5), mode="same")
    is_peak = (smooth >= np.roll(smooth, 1)) & (smooth >= np.roll(smooth, -1))
    lowest = np.flatnonzero(is_peak & (smooth > _FLOOR_SHARE * smooth.max()))[0]
    near = levels[np.abs(levels - edges[lowest] - _BIN_M / 2.0) < 2.5 * _BIN_M]
    return float(np.median(near))


@dataclass(frozen=True, eq=False)
class ReplayStep:
    """One frame, and what mapping and perception made of it.

    Attributes:
        observation: The frame in the ``map`` frame.
        trace: Pose, detections, goal area and times; it has no action.
        grid: The map so far.
    """

    observation: Observation
    trace: StepTrace
    grid: OccupancyGrid


class UprightRecording:
    """A recording in the ``map`` frame, as one observation per frame.

    Attributes:
        recording: The recording.
        to_map: Transform from its world to the ``map`` frame.
    """

    def __init__(self, recording: Recording) -> None:
        """Find the floor.

        Raises:
            RecordingError: No floor is visible, or an image cannot be read.
        """
        self.recording = recording
        self.to_map = world_to_map(recording)

    def robot(self, like: Embodiment) -> Embodiment:
        """A robot with the recording's camera, and all other values of a given robot.

        Raises:
            RecordingError: The camera is below the floor.
        """
        camera = self.recording.camera
        height_m = float(self._camera_to_map(self.recording.frames[0]).translation[2])
        if height_m <= 0.0:
            raise RecordingError(
                f"{self.recording.name}: the camera lies {-height_m:.2f} m below what seems to be "
                "the floor; are its poses and its camera's parameters right, and do these belong "
                "to images of this size?"
            )
        values = like.model_dump()
        values["camera"] |= {
            "width": camera.width,
            "height": camera.height,
            "hfov_deg": math.degrees(camera.hfov),
            "height_m": height_m,
        }
        return Embodiment.model_validate(values)

    def observation(self, frame: RecordedFrame) -> Observation:
        """A frame as an observation; the robot stands below the camera and faces the same way.

        Raises:
            RecordingError: An image cannot be read.
        """
        camera_to_map = self._camera_to_map(frame)
        x, y, _ = camera_to_map.translation
        forward = camera_to_map.rotation[:, 2]
        return Observation(
            rgb=frame.rgb(),
            depth=frame.depth(),
            camera=self.recording.camera,
            camera_to_map=camera_to_map,
            robot=Pose2(float(x), float(y), math.atan2(forward[1], forward[0])),
        )

    def _camera_to_map(self, frame: RecordedFrame) -> Transform:
        return self.to_map @ frame.camera_to_world


def replayed(
    upright: UprightRecording, components: SearchComponents, goal: Goal | None, *, every: int = 1
) -> Iterator[ReplayStep]:
    """Map every frame, and look for the goal in it if there is one.

    Args:
        upright: The recording.
        components: Mapping and local perception, as in a search.
        goal: What to look for; None only draws the map.
        every: Use one of so many frames.

    Raises:
        RecordingError: An image cannot be read.
    """
    floor, local = Memory(components.mapping, components.embodiment).floor, components.local
    components.log.drain()
    frames = upright.recording.frames[::every]
    for number, frame in enumerate(frames):
        clock = ModuleClock()
        seen = upright.observation(frame)
        with clock("map"):
            floor.integrate(seen)
        with clock("local"):
            detections = [] if goal is None else local.look(seen, goal, floor)
        target = floor.search.evidence.target
        trace = StepTrace(
            step=number,
            pose=(seen.robot.x, seen.robot.y, seen.robot.yaw),
            action=None,
            mode=Mode.LOOK_AROUND,
            reason=f"frame {frame.name}",
            destination=None if target is None else target.area.centre,
            goal_area=[] if target is None else target.area.outlines,
            detections=detections,
            exchanges=components.log.drain(),
            seconds=clock.seconds,
        )
        yield ReplayStep(seen, trace, floor.map.grid)
