"""Keeps the steps of an episode and a few of its images until it is known whether to save them."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import UInt8

from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Transform
from hypernav.core.trace import StepTrace
from hypernav.lab.episodes.episode_run import EpisodeStep
from hypernav.lab.episodes.recorder import EpisodeRecorder

MAX_FRAMES = 48

Image = UInt8[np.ndarray, "height width 3"]


@dataclass(frozen=True, eq=False)
class _Frame:
    """What is needed to show a step: the camera image, or the true pose to draw it from."""

    camera_to_scene: Transform
    grid: OccupancyGrid | None
    image: Image | None


class Storyboard:
    """Keeps all steps of an episode, and frames of a few that are spread evenly over it.

    Whether an episode fails is known only at its end, and drawing all colour images would be most
    of the work of an evaluation. So only what is needed to show a limited number of frames is kept:
    whenever there are too many, every second one is dropped. Memory stays bounded for any length
    of the episode.
    """

    def __init__(self, camera_to_scene: Transform, max_frames: int = MAX_FRAMES) -> None:
        """Begin an episode.

        Args:
            camera_to_scene: True pose of the camera at the start, scene frame.
            max_frames: Greatest number of frames that are kept, besides that of the last step.
        """
        self._max_frames = max_frames
        self._stride = 1
        self._steps: list[StepTrace] = []
        self._frames: dict[int, _Frame] = {}
        self._camera_to_scene = camera_to_scene
        self._last: _Frame | None = None

    def watch(self, step: EpisodeStep, camera_to_scene: Transform, *, coloured: bool) -> None:
        """Add a step.

        Args:
            step: The step.
            camera_to_scene: True pose of the camera after the step, scene frame.
            coloured: Whether the world drew the colours of the step's image.
        """
        image = step.observation.rgb if coloured else None
        self._last = _Frame(self._camera_to_scene, step.grid, image)
        if len(self._steps) % self._stride == 0:
            # The agent's map changes with the next step.
            grid = None if step.grid is None else step.grid.copy()
            self._frames[len(self._steps)] = replace(self._last, grid=grid)
        self._steps.append(step.trace)
        self._camera_to_scene = camera_to_scene
        if len(self._frames) > self._max_frames:
            self._stride *= 2
            self._frames = {n: f for n, f in self._frames.items() if n % self._stride == 0}

    def record(self, recorder: EpisodeRecorder, draw: Callable[[Transform], Image]) -> None:
        """Give all steps to a recorder, the kept frames with their images.

        Args:
            recorder: Recorder of the episode.
            draw: Function that draws what the camera sees from a true pose.
        """
        if self._last is None:
            return
        frames = self._frames | {len(self._steps) - 1: self._last}
        for number, step in enumerate(self._steps):
            frame = frames.get(number)
            if frame is None:
                recorder.record(step, None, None)
            else:
                image = frame.image if frame.image is not None else draw(frame.camera_to_scene)
                recorder.record(step, frame.grid, image)
