"""The video of an episode, written while it runs."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import UInt8

from hypernav.app.show import captions
from hypernav.app.show.climbs import (
    Climb,
    climbs,
    floor_heights_m,
    floor_words,
    names_floors,
    stairs_on,
)
from hypernav.app.show.map_images import draw_map, draw_result
from hypernav.app.show.video_frame import (
    ENDING_FRAMES,
    FRAMES_PER_SECOND,
    HEIGHT,
    MAP_SIZE,
    WIDTH,
    Decision,
    EpisodeInfo,
    blank_frame,
    decisions,
    draw_frame,
    frame_count,
    paste,
)
from hypernav.core.exploring.insight import ThingGraph, ValueImage
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.trace import Mode, StepTrace, floor_of, on_last_floor
from hypernav.search.drawing import palette, shapes
from hypernav.search.drawing.map_view import SteadyView
from hypernav.search.drawing.text import draw_text, wrapped

if TYPE_CHECKING:
    import av

_RISE_M = 0.1
"""Least height above or below a floor, metres, that the title gives for a robot on stairs."""
_BLOCKS_STAY_STEPS = 5
# Codes of the video standard: BT.709 colours in the narrow range, which players expect for HD.
_BT709, _NARROW_RANGE = 1, 1
_KEY_FRAME_EVERY = 60

TONES: dict[captions.Tone, palette.Rgb] = {
    "good": palette.SUCCESS,
    "bad": palette.FAILURE,
    "neutral": palette.MUTED,
}

_LEFT = 64
_TEXT_WIDTH = 540.0
_NUMBERS_HEIGHT = 180


class VideoFile:
    """An H.264 video that browsers play, written frame by frame.

    Closing it at any moment leaves a file that plays up to the last frame.
    """

    def __init__(self, path: Path, width: int, height: int, frames_per_second: int) -> None:
        """Open the file.

        Args:
            path: Path of the file; missing folders are created.
            width: Width, pixels; even.
            height: Height, pixels; even.
            frames_per_second: Frame rate, constant.
        """
        import av  # imported here, so that a robot that writes no video loads no encoder

        path.parent.mkdir(parents=True, exist_ok=True)
        # The index goes to the front, so that a browser can seek before it has the whole file.
        self._container = av.open(str(path), "w", format="mp4", options={"movflags": "faststart"})
        self._stream = self._container.add_stream(
            "libx264",
            rate=frames_per_second,
            # Text and lines stay sharp, and 500 steps take less than 5 MB.
            options={"preset": "veryfast", "crf": "32.5", "aq-mode": "2"},
        )
        self._stream.width, self._stream.height = width, height
        self._stream.pix_fmt = "yuv420p"
        context = self._stream.codec_context
        context.color_primaries = context.color_trc = context.colorspace = _BT709
        context.color_range = _NARROW_RANGE
        # A key frame every few seconds, so that seeking is quick. One thread: workers of an
        # evaluation share the machine, and the bytes are the same everywhere.
        context.gop_size = _KEY_FRAME_EVERY
        context.thread_count = 1
        # With frames of unequal length, reordered frames would make the file appear too short.
        context.max_b_frames = 0
        self._frames = 0
        self._error: OSError | None = None
        self._last: av.VideoFrame | None = None

    @property
    def frames(self) -> int:
        """Length of the video so far, frames."""
        return self._frames

    def write(self, image: UInt8[np.ndarray, "height width 3"], repeat: int = 1) -> None:
        """Append an image.

        Args:
            image: RGB, of the video's size.
            repeat: Number of frames that the image stays.
        """
        import av

        frame = av.VideoFrame.from_ndarray(image, format="rgb24")
        self._last = frame.reformat(format="yuv420p", dst_colorspace=_BT709)
        # A repeated image is encoded once; the next one gets a later time.
        self._encode(self._last, self._frames)
        self._frames += repeat

    def close(self) -> None:
        """Finish the file."""
        if self._error is not None:
            self._container.close()
            return
        try:
            if self._last is not None and self._last.pts != self._frames - 1:
                # The last image has no successor, so a second copy marks its end.
                self._encode(self._last, self._frames - 1)
            self._container.mux(self._stream.encode(None))
        finally:
            self._container.close()

    def _encode(self, frame: "av.VideoFrame", at: int) -> None:
        frame.pts = at
        if self._error is not None:
            raise self._error  # FFmpeg crashes if it is used again after it could not write.
        try:
            self._container.mux(self._stream.encode(frame))
        except OSError as error:
            self._error = error
            raise


class EpisodeVideo:
    """Records an episode as a video: camera image, map and decisions.

    Use it as a context manager. However the block ends, even by an interrupt, the file plays up to
    the last step that was added.

    Examples:
        >>> with EpisodeVideo(folder / "episode.mp4", "bed", "hypernav") as video:  # doctest: +SKIP
        ...     video.add(observation.rgb, agent.last_step, agent.grid)
        ...     video.finish(result)
    """

    def __init__(
        self,
        path: Path,
        goal: str,
        agent: str,
        *,
        detector: str = "",
        reasoner: str = "",
        step_limit: int | None = None,
    ) -> None:
        """Open the file.

        Args:
            path: Path of the file, ``.mp4``; missing folders are created.
            goal: Text of the goal.
            agent: Name of the agent.
            detector: Name of the detector; empty if unknown.
            reasoner: Name of the reasoner; empty if unknown.
            step_limit: Largest number of steps; None if there is no limit.
        """
        self._title = EpisodeInfo(goal, agent, detector, reasoner, step_limit)
        self._file = VideoFile(path, WIDTH, HEIGHT, FRAMES_PER_SECOND)
        self._view = SteadyView(MAP_SIZE)
        self._steps: list[StepTrace] = []
        self._climbs: list[Climb] = []
        self._frame_counts: list[int] = []
        self._decision: Decision | None = None
        self._values: ValueImage | None = None
        self._graph: ThingGraph | None = None
        self._grid: OccupancyGrid | None = None
        self._closed = False

    def __enter__(self) -> "EpisodeVideo":
        """Return the video, open for steps."""
        return self

    def __exit__(self, *error: object) -> None:
        """Finish the file."""
        self.close()

    @property
    def frame_counts(self) -> Sequence[int]:
        """Number of frames of each step; 0 for a skipped one."""
        return self._frame_counts

    def add(
        self,
        image: UInt8[np.ndarray, "height width 3"],
        step: StepTrace,
        grid: OccupancyGrid,
    ) -> None:
        """Add a step.

        Args:
            image: Camera image of the step, RGB.
            step: Trace of the step.
            grid: Map after the observation was integrated.
        """
        self._grid = grid
        self._note(step, frame_count(step))
        frame = draw_frame(self._title, step, image, self._map_image(step, grid), self._decision)
        self._file.write(frame, frame_count(step))

    def pass_over(self, step: StepTrace) -> None:
        """Add a step that is not shown; trajectory and decision of the next one include it."""
        self._note(step, 0)

    def _note(self, step: StepTrace, frames: int) -> None:
        self._steps.append(step)
        if any(one.mode is Mode.CLIMB for one in self._steps[-2:]):  # other steps tell nothing new
            self._climbs = climbs(self._steps)
        self._frame_counts.append(frames)
        if step.insight is not None:
            self._values = step.insight.values or self._values
            self._graph = step.insight.graph or self._graph
        if asked := decisions(step):
            self._decision = Decision(step.step, asked[-1], tuple(step.blocks))

    def finish(self, result: Mapping[str, Any]) -> None:
        """Add the end card with the outcome.

        Args:
            result: Content of `result.json`; missing entries show as a dash.
        """
        map_image = None
        if self._grid is not None:
            map_image = draw_result(self._grid, self._steps, size=MAP_SIZE)
        self._file.write(draw_end_card(self._title, result, map_image), ENDING_FRAMES)

    def close(self) -> None:
        """Finish the file; does nothing the second time."""
        if self._closed:
            return
        self._closed = True
        try:
            if self._file.frames == 0:
                # A file without any frame would not open.
                self._file.write(draw_end_card(self._title, {"outcome": "interrupted"}, None))
        finally:
            self._file.close()

    def _map_image(self, step: StepTrace, grid: OccupancyGrid) -> UInt8[np.ndarray, "_ _ 3"]:
        trajectory = [past.pose[:2] for past in on_last_floor(self._steps)]
        decision = self._decision
        age = step.step - decision.step if decision is not None else _BLOCKS_STAY_STEPS
        fresh = decision if decision is not None and age < _BLOCKS_STAY_STEPS else None
        return draw_map(
            grid,
            view=self._view.follow(grid, trajectory),
            robot=Pose2(*step.pose),
            trajectory=trajectory,
            start=trajectory[0],
            path=step.path,
            destination=step.destination,
            goal_area=step.goal_area,
            blocks=fresh.blocks if fresh else (),
            chosen=fresh.exchange.chosen if fresh else None,
            excluded=fresh.exchange.excluded if fresh else (),
            block_opacity=1.0 - 0.8 * age / _BLOCKS_STAY_STEPS,
            values=self._values,
            graph=self._graph,
            stairs=stairs_on(floor_of(step), self._climbs),
            title=self._map_title(step),
        )

    def _map_title(self, step: StepTrace) -> str:
        """The floor that a map shows; the robot is on it, or on stairs from it."""
        if not names_floors([step]):
            return ""
        heights_m = floor_heights_m(self._steps)
        words = floor_words(floor_of(step), floor_of(self._steps[0]), heights_m)
        if step.mode is not Mode.CLIMB:
            return words
        rise_m = step.z - heights_m.get(floor_of(step), step.z)
        far = f", {abs(rise_m):.1f} m {'up' if rise_m > 0.0 else 'down'}"
        return f"{words}, robot on the stairs{far if abs(rise_m) >= _RISE_M else ''}"


def draw_end_card(
    title: EpisodeInfo, result: Mapping[str, Any], map_image: UInt8[np.ndarray, "_ _ 3"] | None
) -> UInt8[np.ndarray, "_ _ 3"]:
    """Draw the card that ends a video.

    Args:
        title: Goal and components of the episode.
        result: Content of `result.json`; missing entries show as a dash.
        map_image: Final map, `MAP_SIZE` squared, if there is one.

    Returns:
        RGB, `HEIGHT` by `WIDTH`.
    """
    ending = captions.headline({"goal": title.goal, **result})
    frame = blank_frame()
    shapes.rectangle(frame, (0, 0), (12, HEIGHT), TONES[ending.tone])
    lines = wrapped(ending.text, 38, _TEXT_WIDTH, lines=3, bold=True)
    details = wrapped(ending.detail, 17, _TEXT_WIDTH, lines=2)
    y = HEIGHT / 2.0 - (50 * len(lines) + 26 * len(details) + _NUMBERS_HEIGHT) / 2.0
    for line in lines:
        draw_text(frame, line, (_LEFT, y), 38, bold=True, color=TONES[ending.tone])
        y += 50
    for line in details:
        draw_text(frame, line, (_LEFT, y), 17, color=palette.MUTED)
        y += 26
    _draw_numbers(frame, result, y + 36)
    for row, line in enumerate(wrapped(title.credits, 14, _TEXT_WIDTH, lines=3)):
        draw_text(frame, line, (_LEFT, HEIGHT - 104 + 22 * row), 14, color=palette.MUTED)
    if map_image is not None:
        paste(frame, map_image, WIDTH - 56 - MAP_SIZE, (HEIGHT - MAP_SIZE) // 2)
    return frame


def _draw_numbers(frame: UInt8[np.ndarray, "_ _ 3"], result: Mapping[str, Any], top: float) -> None:
    shown = (
        ("success", captions.number(result.get("success"))),
        ("SPL", captions.number(result.get("spl"))),
        ("steps", captions.number(result.get("steps"))),
        ("path walked", captions.number(result.get("path_length_m"), 1, "m")),
        ("shortest path", captions.number(result.get("shortest_path_m"), 1, "m")),
        ("distance to goal", captions.number(result.get("distance_to_goal_m"), 2, "m")),
    )
    for index, (name, value) in enumerate(shown):
        at = (_LEFT + 180.0 * (index % 3), top + 104.0 * (index // 3))
        draw_text(frame, name, at, 15, color=palette.MUTED)
        draw_text(frame, value, (at[0], at[1] + 34), 28, bold=True)
