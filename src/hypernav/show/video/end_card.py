"""Last frame of a video: outcome and metrics of the episode."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from jaxtyping import UInt8

from hypernav.show import captions
from hypernav.show.drawing import palette, shapes
from hypernav.show.drawing.text import draw_text, wrapped
from hypernav.show.video.frame import HEIGHT, MAP_SIZE, WIDTH, EpisodeInfo, blank_frame, paste

TONES: dict[captions.Tone, palette.Rgb] = {
    "good": palette.SUCCESS,
    "bad": palette.FAILURE,
    "neutral": palette.MUTED,
}

_LEFT = 64
_TEXT_WIDTH = 540.0
_NUMBERS_HEIGHT = 180


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
