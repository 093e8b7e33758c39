"""An image that shows what refinement does: a frame with its box, and the cells that come of it."""

import cv2
import numpy as np
from jaxtyping import Bool, Float64, UInt8

from hypernav.core.geometry.boxes import Box
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.observation import Observation
from hypernav.evaluation.refinement.footprint import SEEN_TOLERANCE_CELLS, Footprint
from hypernav.mapping.memory.goal_area import GoalArea
from hypernav.show.drawing import palette, shapes
from hypernav.show.drawing.map_painter import MapPainter
from hypernav.show.drawing.map_view import MapView
from hypernav.show.drawing.text import draw_text, text_width

_SIDE = 480
_GAP = 16
_TITLE = 40
_LEGEND = 40
_ON, _OFF, _FOOTPRINT = palette.GOAL, palette.PATH, palette.CHOSEN

Rgb = UInt8[np.ndarray, "_ _ 3"]


def draw_example(
    observation: Observation,
    grid: OccupancyGrid,
    box: Box,
    mask: Bool[np.ndarray, "height width"],
    areas: tuple[GoalArea | None, GoalArea | None],
    footprint: Footprint,
    *,
    goal: str,
) -> Rgb:
    """Draw the camera image beside the seen cells of the raw box and of the refined mask.

    Args:
        observation: Frame, with colours.
        grid: The robot's map at that moment.
        box: Box of the goal.
        mask: The refined mask.
        areas: Goal areas of the raw box and of the refined mask.
        footprint: True footprint of the goal.
        goal: Text of the goal.
    """
    camera = _camera_panel(observation, box, mask)
    view = _view(observation, areas, footprint)
    maps = [_map_panel(area, observation, grid, footprint, view) for area in areas]
    titles = [f"Box of the {goal}, and its refined mask", "Cells of the raw box", "Refined cells"]
    panels = [camera, *maps]
    width = sum(panel.shape[1] for panel in panels) + _GAP * (len(panels) + 1)
    image = np.full((_TITLE + _SIDE + _LEGEND, width, 3), palette.PAPER, dtype=np.uint8)
    left = _GAP
    for panel, title in zip(panels, titles, strict=True):
        image[_TITLE : _TITLE + _SIDE, left : left + panel.shape[1]] = panel
        draw_text(image, title, (left, _TITLE / 2), 17, bold=True)
        left += panel.shape[1] + _GAP
    _legend(image, camera.shape[1] + 2 * _GAP)
    return image


def _camera_panel(
    observation: Observation, box: Box, mask: Bool[np.ndarray, "height width"]
) -> Rgb:
    image = np.ascontiguousarray(observation.rgb)
    tinted = image.copy()
    tinted[mask] = _ON
    image = cv2.addWeighted(image, 0.55, tinted, 0.45, 0.0)
    x_min, y_min, x_max, y_max = box.pixels()
    cv2.rectangle(image, (x_min, y_min), (x_max - 1, y_max - 1), _OFF, 3)
    height, width = image.shape[:2]
    return cv2.resize(image, (round(width * _SIDE / height), _SIDE), interpolation=cv2.INTER_AREA)


def _view(
    observation: Observation, areas: tuple[GoalArea | None, GoalArea | None], footprint: Footprint
) -> MapView:
    """The window that shows the robot, all cells, and the part of the footprint beside them."""
    points = [np.array([observation.robot.xy]), footprint.centres()]
    points += [area.seen_points for area in areas if area is not None]
    low, high = np.concatenate(points).min(axis=0), np.concatenate(points).max(axis=0)
    return MapView.around((*low.tolist(), *high.tolist()), _SIDE)


def _map_panel(
    area: GoalArea | None,
    observation: Observation,
    grid: OccupancyGrid,
    footprint: Footprint,
    view: MapView,
) -> Rgb:
    painter = MapPainter(grid, view=view)
    size = footprint.resolution_m
    _cells(painter, footprint.centres(), size, _FOOTPRINT, opacity=0.5)
    if area is not None:
        on = footprint.holds(area.seen_points, within_cells=SEEN_TOLERANCE_CELLS)
        for points, color in ((area.seen_points[on], _ON), (area.seen_points[~on], _OFF)):
            _cells(painter, points, size, color)
    painter.scale_bar()
    painter.robot(observation.robot)
    return painter.image


def _cells(
    painter: MapPainter,
    points: Float64[np.ndarray, "n 2"],
    size: float,
    color: palette.Rgb,
    *,
    opacity: float = 1.0,
) -> None:
    half = 0.5 * size * painter.view.pixels_per_m
    for u, v in painter.view.to_pixels(points):
        low, high = (u - half, v - half), (u + half, v + half)
        shapes.rectangle(painter.image, low, high, color, opacity=opacity)


def _legend(image: Rgb, left: float) -> None:
    row = image.shape[0] - _LEGEND / 2
    entries = (
        (_ON, "seen cell on the goal"),
        (_OFF, "seen cell off the goal"),
        (palette.blend(palette.FREE, _FOOTPRINT, 0.5), "true footprint"),
        (palette.ROBOT, "robot"),
    )
    for color, words in entries:
        shapes.rectangle(image, (left, row - 7), (left + 14, row + 7), color)
        draw_text(image, words, (left + 22, row), 15)
        left += 22 + text_width(words, 15) + 28
