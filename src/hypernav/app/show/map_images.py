"""Whole map images: for a model that is asked where to look, for people, and on disk."""

from collections.abc import Collection, Iterable, Sequence
from pathlib import Path

import cv2
import numpy as np
from jaxtyping import UInt8
from PIL import Image

from hypernav.app.show.climbs import (
    climbs,
    floor_heights_m,
    floor_words,
    names_floors,
    stairs_on,
)
from hypernav.app.show.legend import Layer, draw_legend
from hypernav.core.exploring.floors import SeenThing
from hypernav.core.exploring.insight import ThingGraph, ValueImage
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.trace import StepTrace, floor_of, on_floor, on_last_floor
from hypernav.search.drawing import palette, shapes
from hypernav.search.drawing.map_painter import XY, MapPainter, NumberedSquare, StairsMark
from hypernav.search.drawing.map_view import MapView
from hypernav.search.drawing.text import draw_text, text_width

_MAP_SIZE = 1200
_LEGEND_HEIGHT = 56

_LOW: palette.Rgb = (38, 70, 160)
_HIGH: palette.Rgb = (240, 200, 40)
_OPACITY = 0.45
_BAR = (96, 10)
_WORDS = 12


def draw_map(
    grid: OccupancyGrid,
    *,
    size: int = 768,
    view: MapView | None = None,
    robot: Pose2 | None = None,
    trajectory: Sequence[XY] = (),
    start: XY | None = None,
    path: Sequence[XY] = (),
    destination: XY | None = None,
    goal_area: Iterable[Sequence[XY]] = (),
    blocks: Sequence[NumberedSquare] = (),
    chosen: int | None = None,
    excluded: Collection[int] = (),
    block_opacity: float = 1.0,
    values: ValueImage | None = None,
    graph: ThingGraph | None = None,
    stairs: Sequence[StairsMark] = (),
    title: str = "",
) -> UInt8[np.ndarray, "_ _ 3"]:
    """Draw a map with everything that is known about it; y points up. All in metres.

    Args:
        grid: The map.
        size: Side of the image, pixels; unused if ``view`` is given.
        view: Window of the map; by default the explored area, fitted and centred.
        robot: Pose of the robot.
        trajectory: Past positions of the robot.
        start: Start position.
        path: Planned path.
        destination: Destination of the path.
        goal_area: Polygons around the cells that the goal was seen on.
        blocks: Numbered blocks.
        chosen: Number of the highlighted block.
        excluded: Numbers of the blocks that are hatched.
        block_opacity: Opacity of the blocks, 0 to 1.
        values: Values of the floor, drawn below everything but the map itself.
        graph: Things that are remembered.
        stairs: Ends of stairs that the robot took or tried.
        title: Words in the upper left corner.

    Returns:
        RGB.
    """
    painter = MapPainter(grid, size=size, view=view)
    if values is not None:
        draw_values(painter.image, painter.view, values)
    painter.blocks(blocks, chosen=chosen, excluded=excluded, opacity=block_opacity)
    painter.goal_area(goal_area)
    painter.trajectory(trajectory)
    if start is not None:
        painter.start(*start)
    painter.stairs(stairs, [trajectory, path])
    painter.path(path)
    painter.numbers(
        blocks,
        chosen=chosen,
        excluded=excluded,
        robot=robot,
        destination=destination,
        opacity=block_opacity,
    )
    if graph is not None:
        draw_graph(painter, graph)
    if destination is not None:
        painter.destination(*destination)
    painter.scale_bar()
    painter.title(title)
    if robot is not None:
        painter.robot(robot)
    return painter.image


def final_view(
    grid: OccupancyGrid, steps: Sequence[StepTrace], size: int, floor: int | None = None
) -> MapView:
    """The window that shows the explored area and the trajectory on a floor, by default the last.

    Args:
        grid: The last map of the floor.
        steps: The whole trace; may be empty.
        size: Side of the image, pixels.
        floor: Number of the floor.
    """
    return MapView.fit(grid, size, points=_trajectory(steps, floor))


def draw_result(
    grid: OccupancyGrid,
    steps: Sequence[StepTrace],
    *,
    size: int = _MAP_SIZE,
    robot: bool = True,
    floor: int | None = None,
) -> UInt8[np.ndarray, "_ _ 3"]:
    """Draw the map of a floor at the end of an episode, with the trajectory there.

    Args:
        grid: The last map of the floor.
        steps: The whole trace; may be empty.
        size: Side of the image, pixels.
        robot: Whether to draw the robot where it stopped.
        floor: Number of the floor; by default that of the end.
    """
    number = floor or (floor_of(steps[-1]) if steps else 1)
    last = steps[-1] if steps and floor_of(steps[-1]) == number else None
    trajectory = _trajectory(steps, floor)
    return draw_map(
        grid,
        view=final_view(grid, steps, size, floor),
        robot=Pose2(*last.pose) if last and robot else None,
        trajectory=trajectory,
        start=trajectory[0] if trajectory else None,
        goal_area=last.goal_area if last else (),
        stairs=stairs_on(number, climbs(steps)),
        title=floor_words(number, floor_of(steps[0]), floor_heights_m(steps))
        if names_floors(steps)
        else "",
    )


def _trajectory(steps: Sequence[StepTrace], floor: int | None) -> list[XY]:
    walk = on_last_floor(steps) if floor is None else on_floor(steps, floor)
    return [step.pose[:2] for step in walk]


def write_map_png(
    path: Path,
    grid: OccupancyGrid,
    steps: Sequence[StepTrace],
    *,
    size: int = _MAP_SIZE,
    floor: int | None = None,
) -> Path:
    """Write the map of a floor at the end of an episode as a PNG, with a legend below it.

    Args:
        path: The file; missing folders are created.
        grid: The last map of the floor.
        steps: The whole trace; may be empty.
        size: Width of the image, pixels.
        floor: Number of the floor; by default that of the end.

    Returns:
        The path.
    """
    image = np.full((size + _LEGEND_HEIGHT, size, 3), palette.PAPER, dtype=np.uint8)
    image[:size] = draw_result(grid, steps, size=size, floor=floor)
    layers = [Layer.FREE, Layer.OCCUPIED, Layer.UNKNOWN]
    if steps:
        layers += [Layer.START, Layer.TRAJECTORY]
    if steps and floor in (None, floor_of(steps[-1])):
        layers += [Layer.ROBOT, Layer.GOAL] if steps[-1].goal_area else [Layer.ROBOT]
    draw_legend(image, layers, left=20, middle=size + _LEGEND_HEIGHT / 2, size=17)
    path.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(image).save(path, optimize=True)
    return path


def _color_table() -> UInt8[np.ndarray, "256 3"]:
    shares = np.linspace(0.0, 1.0, 256)
    return np.array([palette.blend(_LOW, _HIGH, float(share)) for share in shares], np.uint8)


_COLORS = _color_table()


def draw_values(image: UInt8[np.ndarray, "_ _ 3"], view: MapView, values: ValueImage) -> None:
    """Tint the floor that has a value, from blue for the lowest to yellow for the highest.

    Args:
        image: Image of the map, changed in place.
        view: Metres to pixels.
        values: Values of the floor.
    """
    grades = values.grades
    if not grades.any():
        return
    known = grades[grades > 0]
    low, high = int(known.min()), int(known.max())
    scaled = np.clip((grades.astype(np.float32) - low) / max(high - low, 1) * 255.0, 0.0, 255.0)
    # From pixels of the image to cells of the values; y points up in the map, down in the image.
    per_pixel = 1.0 / (view.pixels_per_m * values.cell_m)
    left = (view.left_m - values.x_min) / values.cell_m
    top = (view.top_m - values.y_min) / values.cell_m
    middle = 0.5 * per_pixel - 0.5
    matrix = np.array([[per_pixel, 0.0, left + middle], [0.0, -per_pixel, top - middle - 1.0]])
    size = (image.shape[1], image.shape[0])
    flags = cv2.INTER_NEAREST | cv2.WARP_INVERSE_MAP
    cover = cv2.warpAffine((grades > 0).astype(np.uint8), matrix, size, flags=flags) > 0
    shades = np.asarray(cv2.warpAffine(scaled.astype(np.uint8), matrix, size, flags=flags))
    colors = _COLORS[shades.astype(np.intp)]
    mixed = (1.0 - _OPACITY) * image + _OPACITY * colors
    image[cover] = np.rint(mixed[cover]).astype(np.uint8)
    _draw_bar(image, (low - 1) / 254.0, (high - 1) / 254.0)


def _draw_bar(image: UInt8[np.ndarray, "_ _ 3"], low: float, high: float) -> None:
    """Draw the colour scale in the upper left corner."""
    width, height = _BAR
    words = [f"value {low:.2f}", f"{high:.2f}"]
    left = 10.0 + text_width(words[0], _WORDS) + 6.0
    right = left + width + 6.0 + text_width(words[1], _WORDS) + 6.0
    shapes.rectangle(image, (4.0, 4.0), (right, 24.0), palette.PAPER, opacity=0.8)
    draw_text(image, words[0], (10.0, 14.0), _WORDS, color=palette.INK)
    draw_text(image, words[1], (left + width + 6.0, 14.0), _WORDS, color=palette.INK)
    bar = np.repeat(_COLORS[np.linspace(0, 255, width).astype(int)][None], height, axis=0)
    part = image[9 : 9 + height, round(left) : round(left) + width]
    part[:] = bar[: part.shape[0], : part.shape[1]]


def draw_graph(painter: MapPainter, graph: ThingGraph) -> None:
    """Draw dots for things, lines between near ones, and names of those that the reasoner is told.

    Args:
        painter: Painter of the map.
        graph: The things.
    """
    at = [painter.view.pixel_of(*thing.position) for thing in graph.things]
    unit = painter.view.size / 768.0
    for a, b in graph.near:
        shapes.line(painter.image, np.array([at[a], at[b]]), palette.BLOCK, 1.2 * unit)
    for middle in at:
        shapes.disc(painter.image, middle, max(4.0 * unit, 2.5), palette.BLOCK)
    painter.labels([SeenThing(one.label, one.position) for one in graph.things if one.told])
