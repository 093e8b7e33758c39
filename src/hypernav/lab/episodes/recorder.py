"""The files that record an episode."""

import json
import math
import re
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import UInt8

from hypernav.app.show.episode_page import write_page
from hypernav.app.show.episode_video import EpisodeVideo
from hypernav.app.show.map_images import write_map_png
from hypernav.app.show.spatial.cloud import ColouredCloud
from hypernav.app.show.spatial.view import camera_frame
from hypernav.core.errors import OutputError
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.observation import Observation
from hypernav.core.trace import StepTrace, floor_of, json_values
from hypernav.io.writing import AppendOnlyFile
from hypernav.search.mapping.ros_map import save_ros_map
from hypernav.search.perception.exchanges import unusable_answers

OUTPUT_FILES = (
    *("trace.jsonl", "timings.jsonl", "trajectory.tum", "episode.mp4", "map.png", "map.pgm"),
    *("map.yaml", "result.json", "index.html"),
)
"""Names of the files that a recorder writes to its folder."""
_FLOOR_MAP = re.compile(r"map_floor_\d+\.(png|pgm|yaml)")
"""Names of the maps of floors, which only a search over several floors has."""
_RESERVE_BYTES = 2_000_000


class EpisodeRecorder:
    """Writes trace and video while the episode runs, and maps, result and page when it ends.

    It is a `hypernav.core.trace.View`.

    An interruption loses nothing that was recorded: the trace is flushed step by step, and leaving
    the ``with`` block finishes the video in any case.

    ============================ =====================================================
    ``trace.jsonl``              one `StepTrace` per line, equal for equal runs
    ``timings.jsonl``            seconds per module, one line for each step
    ``trajectory.tum``           ``step x y z qx qy qz qw`` in the ``map`` frame
    ``episode.mp4``              camera image, map and decision of every step
    ``map.png``                  the final map with the trajectory on it
    ``map.pgm``, ``map.yaml``    the final map for ROS
    ``map_floor_N.*``            the same three of floor N, if the robot was on several floors
    ``result.json``              outcome, measures, times and configuration
    ``index.html``               all of it on one page
    ============================ =====================================================
    """

    def __init__(
        self, folder: Path, *, goal: str, agent: str, detector: str, reasoner: str, step_limit: int
    ) -> None:
        """Open the files.

        Args:
            folder: Folder of the files; created if missing, and files of an earlier run replaced.
            goal: The object to find.
            agent: Name of the agent.
            detector: Description of the detector, for people.
            reasoner: Description of the reasoner, for people.
            step_limit: Maximum number of steps of the episode.

        Raises:
            OutputError: They cannot be written.
        """
        self.folder = folder
        self.steps: list[StepTrace] = []
        self._grid: OccupancyGrid | None = None
        self._maps: dict[int, OccupancyGrid] = {}
        self._cloud: ColouredCloud | None = None
        self._eye = list[list[float]]()
        with _written_to(folder):
            folder.mkdir(parents=True, exist_ok=True)
            for path in folder.iterdir():  # a file written in place may be one elsewhere, too
                if path.name in OUTPUT_FILES or _FLOOR_MAP.fullmatch(path.name):
                    path.unlink()
            # An unnamed file reserves disk space for result and page until they are written.
            self._reserve = tempfile.TemporaryFile(dir=folder, buffering=0)  # noqa: SIM115
            self._reserve.write(bytes(_RESERVE_BYTES))
            self._trace = AppendOnlyFile(folder / "trace.jsonl")
            self._timings = AppendOnlyFile(folder / "timings.jsonl")
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

    def __exit__(self, *error: object) -> None:
        """Close all files."""
        self.close()

    def close(self) -> None:
        """Close all files; a video that cannot be finished is removed, for it would not play."""
        self._reserve.close()
        self._trace.close()
        self._timings.close()
        self._attempt("episode.mp4", self._video.close)

    @property
    def unusable_answers(self) -> Counter[str]:
        """Number of a model's unusable answers so far, by reason."""
        return sum(map(unusable_answers, self.steps), Counter[str]())

    def add(
        self, step: StepTrace, grid: OccupancyGrid | None, observation: Observation | None
    ) -> None:
        """Record a step with what the camera saw; see `record`."""
        if observation is None:
            self.record(step, grid, None)
            return
        self.record(step, grid, observation.rgb)
        if self._cloud is None:
            self._cloud = ColouredCloud()
            base_to_map = observation.robot.to_transform(step.z)
            camera_to_base = base_to_map.inverse() @ observation.camera_to_map
            self._eye = camera_frame(observation.camera, camera_to_base)
        self._cloud.add(
            observation.rgb,
            observation.depth,
            observation.camera,
            observation.camera_to_map,
            floor=floor_of(step),
        )

    def record(
        self,
        step: StepTrace,
        grid: OccupancyGrid | None,
        image: UInt8[np.ndarray, "height width 3"] | None,
    ) -> None:
        """Record a step.

        Args:
            step: Trace of the step.
            grid: The agent's map; None if it has none.
            image: Camera image, RGB; None if the video skips the step.

        Raises:
            OutputError: The disk is full; what was recorded before is kept.
        """
        timing = {"step": step.step, "seconds": step.seconds}
        with _written_to(self.folder):
            self._trace.append(step.model_dump_json(exclude={"seconds"}).encode() + b"\n")
            self._timings.append(json.dumps(timing).encode() + b"\n")
            self.steps.append(step)
            if grid is None or image is None:
                self._video.pass_over(step)
            else:
                self._grid = self._maps[floor_of(step)] = grid
                self._video.add(image, step, grid)

    def finish(self, result: Mapping[str, Any]) -> None:
        """Write the files that are complete only at the end of the episode.

        Args:
            result: Content of ``result.json``; infinite lengths become null.

        Raises:
            OutputError: Some of them could not be written; the message names them.
        """
        result = json_values(result)
        self._reserve.close()
        missing = [
            name
            for name, write in (
                ("result.json", lambda: self._write_result(result)),
                ("episode.mp4", lambda: self._finish_video(result)),
                ("trajectory.tum", self._write_trajectory),
                ("map.pgm", self._write_ros_map),
                ("map.png", self._write_map),
                *self._maps_of_floors(),
                ("index.html", lambda: self._write_page(result)),
            )
            if not self._attempt(name, write)
        ]
        if missing:
            why = (
                "is the disk full? All other files are there"
                if self.folder.is_dir()
                else "the folder was removed or replaced while the search ran"
            )
            raise OutputError(f"{self.folder}: {', '.join(missing)} could not be written; {why}")

    def _attempt(self, name: str, write: Callable[[], object]) -> bool:
        """Whether a file could be written; an incomplete file is removed."""
        try:
            write()
        except OSError:
            with suppress(OSError):  # the folder may be gone, too
                (self.folder / name).unlink()
            return False
        return True

    def _write_result(self, result: Mapping[str, Any]) -> None:
        text = json.dumps(result, indent=2, ensure_ascii=False, allow_nan=False)
        (self.folder / "result.json").write_text(text + "\n", encoding="utf-8")

    def _finish_video(self, result: Mapping[str, Any]) -> None:
        try:
            self._video.finish(result)
        finally:
            self._video.close()

    def _write_trajectory(self) -> None:
        lines = [_tum_line(step) for step in self.steps]
        (self.folder / "trajectory.tum").write_text("".join(lines), encoding="utf-8")

    def _write_ros_map(self) -> None:
        if self._grid is not None:
            save_ros_map(self._grid.cropped(), self.folder)

    def _write_map(self) -> None:
        if self._grid is not None:
            write_map_png(self.folder / "map.png", self._grid, self.steps)

    def _maps_of_floors(self) -> Iterator[tuple[str, Callable[[], object]]]:
        """Names of the maps of single floors, with what writes each; none for one floor."""
        for floor, grid in sorted(self._maps.items()) if len(self._maps) > 1 else ():
            name = f"map_floor_{floor}"
            yield f"{name}.pgm", partial(save_ros_map, grid.cropped(), self.folder, name)
            path = self.folder / f"{name}.png"
            yield path.name, partial(write_map_png, path, grid, self.steps, floor=floor)

    def _write_page(self, result: Mapping[str, Any]) -> None:
        page = partial(
            write_page,
            self.folder,
            result,
            self.steps,
            self._maps,
            frame_counts=self._video.frame_counts,
            cloud=self._cloud,
            eye=self._eye,
        )
        try:
            page()
        except OSError:  # There may be space for a page that only links to the video.
            page(embed_limit_bytes=0)


@contextmanager
def _written_to(folder: Path) -> Iterator[None]:
    """Turn errors of writing in the block into one that names the folder.

    Raises:
        OutputError: The block cannot write.
    """
    try:
        yield
    except OSError as error:
        raise OutputError(
            f"{folder} cannot be written ({error.strerror}); what was recorded up to now is there. "
            "Free some space, or choose another folder"
        ) from error


def _tum_line(step: StepTrace) -> str:
    x, y, yaw = step.pose
    qz, qw = math.sin(yaw / 2.0), math.cos(yaw / 2.0)
    return f"{step.step} {x:.6f} {y:.6f} {step.z:g} 0 0 {qz:.9f} {qw:.9f}\n"
