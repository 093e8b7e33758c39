"""Runs a recording through mapping and local perception, to try a new camera."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

from hypernav.agents.step import SearchComponents
from hypernav.core.embodiment import Embodiment
from hypernav.core.errors import RecordingError
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import Mode, ModuleClock, StepTrace
from hypernav.mapping.memory.memory import Memory
from hypernav.robot.recordings.recording import RecordedFrame, Recording
from hypernav.robot.recordings.upright import world_to_map


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
    upright: UprightRecording,
    components: SearchComponents,
    goal: Goal | None,
    *,
    every: int = 1,
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
