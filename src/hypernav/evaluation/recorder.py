"""The files that record an episode."""

import json
import math
from collections import Counter
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from jaxtyping import UInt8

from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.trace import StepTrace
from hypernav.mapping.ros_map import save_ros_map
from hypernav.perception.exchanges import unusable_answers
from hypernav.show.drawing.map_images import write_map_png
from hypernav.show.pages.episode_page import write_page
from hypernav.show.video.episode_video import EpisodeVideo


class EpisodeRecorder:
    """Writes trace and video while the episode runs, and maps, result and page when it ends.

    An interruption loses nothing that was recorded: the trace is flushed step by step, and leaving
    the ``with`` block finishes the video in any case.

    ============================ =====================================================
    ``trace.jsonl``              one `StepTrace` per line, equal for equal runs
    ``timings.jsonl``            seconds per module, one line for each step
    ``trajectory.tum``           ``step x y z qx qy qz qw`` in the ``map`` frame
    ``episode.mp4``              camera image, map and decision of every step
    ``map.png``                  the final map with the whole trajectory
    ``map.pgm``, ``map.yaml``    the final map for ROS
    ``result.json``              outcome, measures, times and configuration
    ``index.html``               all of it on one page
    ============================ =====================================================
    """

    def __init__(
        self,
        folder: Path,
        *,
        goal: str,
        agent: str,
        detector: str,
        reasoner: str,
        step_limit: int,
    ) -> None:
        """Open the files.

        Args:
            folder: Folder of the files; created if missing, and files of an earlier run replaced.
            goal: The object to find.
            agent: Name of the agent.
            detector: Description of the detector, for people.
            reasoner: Description of the reasoner, for people.
            step_limit: Maximum number of steps of the episode.
        """
        folder.mkdir(parents=True, exist_ok=True)
        self.folder = folder
        self.steps: list[StepTrace] = []
        self._grid: OccupancyGrid | None = None
        self._trace = (folder / "trace.jsonl").open("w", encoding="utf-8")
        self._timings = (folder / "timings.jsonl").open("w", encoding="utf-8")
        self._video = EpisodeVideo(
            folder / "episode.mp4",
            goal,
            agent,
            detector=detector,
            reasoner=reasoner,
            step_limit=step_limit,
        )

    def __enter__(self) -> "EpisodeRecorder":
        """Start recording."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close trace and video."""
        self._trace.close()
        self._timings.close()
        self._video.close()

    @property
    def unusable_answers(self) -> Counter[str]:
        """Number of a model's answers so far that were of no use, by reason."""
        return sum(map(unusable_answers, self.steps), Counter[str]())

    def add(
        self,
        step: StepTrace,
        grid: OccupancyGrid | None,
        image: UInt8[np.ndarray, "height width 3"] | None,
    ) -> None:
        """Record a step.

        Args:
            step: Trace of the step.
            grid: The agent's map; None if it has none.
            image: Camera image, RGB; None if the video passes over the step.
        """
        self.steps.append(step)
        self._trace.write(step.model_dump_json(exclude={"seconds"}) + "\n")
        self._trace.flush()
        timing = {"step": step.step, "seconds": step.seconds}
        self._timings.write(json.dumps(timing) + "\n")
        self._timings.flush()
        if grid is None or image is None:
            self._video.pass_over(step)
        else:
            self._grid = grid
            self._video.add(image, step, grid)

    def finish(self, result: dict[str, Any]) -> None:
        """Write the files that are complete only at the end of the episode.

        Args:
            result: Content of ``result.json``; infinite lengths become null.
        """
        self._video.finish(result)
        self._video.close()
        result = {key: _finite(value) for key, value in result.items()}
        text = json.dumps(result, indent=2, ensure_ascii=False, allow_nan=False)
        (self.folder / "result.json").write_text(text + "\n", encoding="utf-8")
        lines = [_tum_line(step) for step in self.steps]
        (self.folder / "trajectory.tum").write_text("".join(lines), encoding="utf-8")
        if self._grid is not None:
            save_ros_map(self._grid.cropped(), self.folder)
            write_map_png(self.folder / "map.png", self._grid, self.steps)
        write_page(
            self.folder, result, self.steps, self._grid, frame_counts=self._video.frame_counts
        )


def _finite(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _tum_line(step: StepTrace) -> str:
    x, y, yaw = step.pose
    qz, qw = math.sin(yaw / 2.0), math.cos(yaw / 2.0)
    return f"{step.step} {x:.6f} {y:.6f} 0 0 0 {qz:.9f} {qw:.9f}\n"
