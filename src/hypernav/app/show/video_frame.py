"""One frame of an episode's video: camera image, map and the latest decision; how long it stays."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate

import cv2
import numpy as np
from jaxtyping import UInt8

from hypernav.app.show import captions
from hypernav.app.show.legend import Layer, draw_legend
from hypernav.core.exploring.insight import Insight
from hypernav.core.trace import BlockRecord, DetectionRecord, Exchange, StepTrace
from hypernav.search.drawing import palette, shapes
from hypernav.search.drawing.shapes import ArrowStyle, draw_arrows
from hypernav.search.drawing.text import draw_text, shortened, text_width, wrapped

WIDTH, HEIGHT = 1280, 720
MAP_SIZE = 568

_MARGIN = 24
_CAMERA = (640, 480)
_TOP = 80
_MAP_LEFT = WIDTH - _MARGIN - MAP_SIZE
_NOTES_TOP = _TOP + _CAMERA[1] + 12
_BARS_WIDTH = 168
_LEGEND = (
    Layer.TRAJECTORY,
    Layer.ROBOT,
    Layer.PATH,
    Layer.DESTINATION,
    Layer.GOAL,
    Layer.CHOSEN,
)

_BLANK = np.full((HEIGHT, WIDTH, 3), palette.GROUND, dtype=np.uint8)

Image = UInt8[np.ndarray, "_ _ 3"]

_LABEL_TEXT = 18
_CHIP_HEIGHT = 26

_WINDOW_TEXT = 16

FRAMES_PER_SECOND = 6
ENDING_FRAMES = 4 * FRAMES_PER_SECOND
EVERY_STEP = frozenset({"ground", "score view"})
"""Kinds of questions that are asked at every step, and do not change the destination."""
_AT_A_STEP = 1
_AT_A_DECISION = 6


@dataclass(frozen=True)
class EpisodeInfo:
    """Goal and components of an episode, the same on all frames.

    Attributes:
        goal: Text of the goal.
        agent: Name of the agent.
        detector: Name of the detector; empty if unknown.
        reasoner: Name of the reasoner; empty if unknown.
        step_limit: Largest number of steps; None if there is no limit.
    """

    goal: str
    agent: str
    detector: str = ""
    reasoner: str = ""
    step_limit: int | None = None

    @property
    def has_detector(self) -> bool:
        """Whether the agent has a detector, which searches every image for the goal."""
        return self.detector != captions.ITS_OWN

    @property
    def credits(self) -> str:
        """Agent, and detector and reasoner where it has them, on one line."""
        parts = [self.agent]
        if self.detector and self.has_detector:
            parts.append(f"sees with {captions.component_caption(self.detector)}")
        if self.reasoner and self.reasoner != captions.ITS_OWN:
            parts.append(f"decides with {captions.component_caption(self.reasoner)}")
        return "   ·   ".join(parts)


@dataclass(frozen=True)
class Decision:
    """Latest question that changed the destination.

    Attributes:
        step: Step at which it was asked.
        exchange: Question and answer.
        blocks: Blocks to choose from; empty if it was not about the map.
    """

    step: int
    exchange: Exchange
    blocks: tuple[BlockRecord, ...] = ()


def draw_frame(
    title: EpisodeInfo,
    step: StepTrace,
    rgb: Image,
    map_image: Image,
    decision: Decision | None,
) -> Image:
    """Draw one frame.

    Args:
        title: Goal and components of the episode.
        step: Trace of this step.
        rgb: Camera image of this step.
        map_image: Map image, `MAP_SIZE` squared.
        decision: Latest decision so far.

    Returns:
        RGB, `HEIGHT` by `WIDTH`.
    """
    frame = blank_frame()
    _draw_header(frame, title, step)
    if step.insight is not None:
        rgb = draw_insight(rgb, step.insight)
    camera = draw_camera(rgb, step.detections, width=_CAMERA[0], height=_CAMERA[1])
    paste(frame, camera, _MARGIN, _TOP)
    paste(frame, map_image, _MAP_LEFT, _TOP)
    _draw_notes(frame, title, step, decision)
    draw_legend(frame, _LEGEND, left=_MAP_LEFT, middle=_TOP + MAP_SIZE + 26, size=13, gap=1.0)
    return frame


def blank_frame() -> Image:
    """A frame with nothing on it."""
    return _BLANK.copy()


def paste(frame: Image, image: Image, left: int, top: int) -> None:
    """Put an image onto the frame, in place, with a thin border."""
    height, width = image.shape[:2]
    frame[top : top + height, left : left + width] = image
    cv2.rectangle(frame, (left - 1, top - 1), (left + width, top + height), palette.FAINT, 1)


def _draw_header(frame: Image, title: EpisodeInfo, step: StepTrace) -> None:
    shapes.rectangle(frame, (0, 0), (WIDTH, 64), palette.PAPER)
    shapes.rectangle(frame, (0, 64), (WIDTH, 65), palette.FAINT)
    goal = shortened(f"Find {captions.quoted(title.goal)}", 26, 640.0, bold=True)
    draw_text(frame, goal, (_MARGIN, 21), 26, bold=True)
    line = shortened(title.credits, 16, WIDTH - 2.0 * _MARGIN)
    draw_text(frame, line, (_MARGIN, 50), 16, color=palette.MUTED)
    draw_badge(frame, captions.MODES[step.mode], palette.MODES[step.mode], _MAP_LEFT, 21)
    limit = f" of {title.step_limit}" if title.step_limit is not None else ""
    count = f"{captions.floor_prefix(step)}step {step.step + 1}{limit}"
    draw_text(frame, count, (WIDTH - _MARGIN, 21), 20, align=1.0)


def draw_badge(frame: Image, text: str, color: palette.Rgb, left: float, middle: float) -> None:
    """Draw a word on a coloured background with round ends, in place."""
    width = text_width(text, 18, bold=True) + 28.0
    shapes.rounded_box(frame, left, middle - 15.0, width, 30.0, color, radius=15.0)
    ink = palette.ink_on(color)
    draw_text(frame, text, (left + 14.0, middle), 18, bold=True, color=ink)


def _draw_notes(
    frame: Image, title: EpisodeInfo, step: StepTrace, decision: Decision | None
) -> None:
    """Draw mode, detections and latest decision below the camera image."""
    width = float(_CAMERA[0])
    reason = captions.sentence(step.reason or captions.MODES_EXPLAINED[step.mode])
    line = shortened(reason, 21, width, bold=True)
    draw_text(frame, line, (_MARGIN, _NOTES_TOP + 9), 21, bold=True)
    if title.has_detector or step.exchanges or step.detections:
        sees = shortened(f"Camera: {captions.camera_caption(step)}", 18, width)
        draw_text(frame, sees, (_MARGIN, _NOTES_TOP + 35), 18, color=palette.MUTED)
    if decision is not None:
        shapes.rectangle(
            frame, (_MARGIN, _NOTES_TOP + 50), (_MARGIN + width, _NOTES_TOP + 51), palette.FAINT
        )
        _draw_decision(frame, decision, _NOTES_TOP + 64)


def _draw_decision(frame: Image, decision: Decision, top: int) -> None:
    exchange = decision.exchange
    width = float(_CAMERA[0])
    if exchange.probabilities:
        width -= _BARS_WIDTH + 24.0
        draw_bars(frame, exchange.probabilities, round(_MARGIN + width + 24.0), top)
    who = captions.component_caption(exchange.asked)
    asked = f"Step {decision.step + 1}, asked {who}: {captions.final_question(exchange.question)}"
    for line in wrapped(asked, 17, width, lines=2):
        draw_text(frame, line, (_MARGIN, top), 17, color=palette.MUTED)
        top += 20
    top += 2
    for line in wrapped(captions.quoted(exchange.answer), 18, width, lines=2):
        draw_text(frame, line, (_MARGIN, top), 18)
        top += 21


def draw_bars(frame: Image, probabilities: dict[str, float], left: int, top: int) -> None:
    """Draw the likeliest answers as small bars, in place; the longest bar fills its row."""
    ranked = sorted(probabilities.items(), key=lambda item: -item[1])[:3]
    longest = max(ranked[0][1], 1e-9)
    draw_text(frame, "how likely it held", (left, top), 13, color=palette.MUTED)
    low, full = left + 44, _BARS_WIDTH - 44 - 42
    for row, (answer, share) in enumerate(ranked):
        middle, bold = top + 20 * (row + 1), row == 0
        name = shortened(answer, 13, 38.0, bold=bold)
        draw_text(frame, name, (low - 8, middle), 13, bold=bold, align=1.0)
        length = max(full * min(max(share, 0.0) / longest, 1.0), 1.0)
        color = palette.CHOSEN if bold else palette.EXCLUDED
        shapes.rectangle(frame, (low, middle - 6), (low + length, middle + 6), color)
        at = (low + length + 6, middle)
        draw_text(frame, f"{share:.0%}", at, 12, color=palette.MUTED)


def draw_camera(
    rgb: UInt8[np.ndarray, "_ _ 3"],
    detections: list[DetectionRecord],
    *,
    width: int,
    height: int,
) -> UInt8[np.ndarray, "_ _ 3"]:
    """Draw a camera image with boxes, mask outlines and labels, fitted into a panel.

    An accepted detection is green; a rejected one is grey, with the reason.

    Args:
        rgb: The camera image.
        detections: Detections in this image.
        width: Width of the panel, pixels.
        height: Height of the panel, pixels.

    Returns:
        RGB, ``height`` by ``width``.
    """
    scale = min(width / rgb.shape[1], height / rgb.shape[0])
    size = (max(round(rgb.shape[1] * scale), 1), max(round(rgb.shape[0] * scale), 1))
    smaller = scale < 1.0
    image = (
        rgb.copy()
        if size == rgb.shape[1::-1]
        else cv2.resize(rgb, size, interpolation=cv2.INTER_AREA if smaller else cv2.INTER_LINEAR)
    )
    for detection in sorted(detections, key=lambda each: (each.accepted, each.score)):
        _draw_detection(image, detection, scale)
    panel = np.full((height, width, 3), palette.OCCUPIED, dtype=np.uint8)
    top, left = (height - size[1]) // 2, (width - size[0]) // 2
    panel[top : top + size[1], left : left + size[0]] = image
    return panel


def _draw_detection(
    image: UInt8[np.ndarray, "_ _ 3"], detection: DetectionRecord, scale: float
) -> None:
    color = palette.GOAL if detection.accepted else palette.BLOCK
    outlines = [np.array(outline, dtype=np.float64) * scale for outline in detection.outlines]
    shapes.polygon(image, outlines, color, opacity=0.35)
    for outline in outlines:
        shapes.line(image, outline, palette.PAPER, 1.0, closed=True)
    left, top, right, bottom = (value * scale for value in detection.box)
    corners = np.array([[left, top], [right, top], [right, bottom], [left, bottom], [left, top]])
    if detection.accepted:
        shapes.line(image, corners, palette.PAPER, 5.0)
        shapes.line(image, corners, color, 3.0)
    else:
        shapes.line(image, corners, color, 2.0)
        shapes.dashed_line(image, corners, palette.PAPER, 2.0, dash=8.0, gap=8.0)
    _draw_label(image, _label(detection), left, top, color)


def _label(detection: DetectionRecord) -> str:
    label = f"{detection.label} {detection.score:.2f}"
    if detection.accepted:
        return label
    return f"{label} · {detection.reason or 'not accepted'}"


def _draw_label(
    image: UInt8[np.ndarray, "_ _ 3"], text: str, left: float, top: float, color: palette.Rgb
) -> None:
    height, width = image.shape[:2]
    text = shortened(text, _LABEL_TEXT, width - 16.0, bold=True)
    chip = text_width(text, _LABEL_TEXT, bold=True) + 14.0
    u = min(max(left - 1.5, 0.0), max(width - chip, 0.0))
    above = top - _CHIP_HEIGHT
    v = above if above >= 0.0 else min(max(top, 0.0), height - float(_CHIP_HEIGHT))
    shapes.rectangle(image, (u, v), (u + chip, v + _CHIP_HEIGHT), color)
    at = (u + 7.0, v + _CHIP_HEIGHT / 2.0)
    draw_text(image, text, at, _LABEL_TEXT, bold=True, color=palette.ink_on(color))


def draw_insight(image: UInt8[np.ndarray, "_ _ 3"], insight: Insight) -> UInt8[np.ndarray, "_ _ 3"]:
    """Draw marks and window into a copy of the camera image; what was chosen is orange."""
    drawn = image.copy()
    if insight.marks:
        style = ArrowStyle(shafts=insight.foot is not None)
        chosen = [mark.number for mark in insight.marks if mark.chosen]
        marks = {mark.number: mark.pixel for mark in insight.marks}
        foot = insight.foot or (0.0, 0.0)
        drawn = draw_arrows(drawn, marks, foot, style, chosen=chosen)
    if insight.window is not None:
        left, top, right, bottom = insight.window.box
        corners = np.array([[left, top], [right, top], [right, bottom], [left, bottom]])
        shapes.polygon(drawn, [corners], palette.CHOSEN, opacity=0.25)
        shapes.line(drawn, corners, palette.CHOSEN, 3.0, closed=True)
        label = insight.window.label
        wide = text_width(label, _WINDOW_TEXT, bold=True) + 12.0
        shapes.rectangle(drawn, (left, top), (left + wide, top + 24.0), palette.CHOSEN)
        ink = palette.ink_on(palette.CHOSEN)
        draw_text(drawn, label, (left + 6.0, top + 12.0), _WINDOW_TEXT, bold=True, color=ink)
    return drawn


def decisions(step: StepTrace) -> list[Exchange]:
    """Questions of a step that changed the destination."""
    return [one for one in step.exchanges if one.kind not in EVERY_STEP]


def frame_count(step: StepTrace) -> int:
    """Frames of a step: one second for a decision or an event, else a sixth of one."""
    return _AT_A_DECISION if decisions(step) or step.events else _AT_A_STEP


def start_times(frame_counts: Sequence[int]) -> list[float]:
    """Time at which each step appears, seconds from the start of the video.

    Args:
        frame_counts: Number of frames of each step. A skipped step has none, and appears with the
            next one that is shown.
    """
    return [frame / FRAMES_PER_SECOND for frame in accumulate(frame_counts, initial=0)][:-1]
