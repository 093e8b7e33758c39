"""Whole map images: for a model that is asked where to look, for people, and on disk."""

from collections.abc import Collection, Iterable, Sequence
from pathlib import Path

import numpy as np
from jaxtyping import UInt8
from PIL import Image

from hypernav.core.exploring.insight import ThingGraph, ValueImage
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.trace import StepTrace, on_last_floor
from hypernav.show.drawing import palette
from hypernav.show.drawing.insight_overlays import draw_graph, draw_values
from hypernav.show.drawing.legend import Layer, draw_legend
from hypernav.show.drawing.map_painter import XY, MapPainter, NumberedSquare
from hypernav.show.drawing.map_view import MapView

_MAP_SIZE = 1200
_LEGEND_HEIGHT = 56


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
    if robot is not None:
        painter.robot(robot)
    return painter.image


def final_view(grid: OccupancyGrid, steps: Sequence[StepTrace], size: int) -> MapView:
    """The window that shows the explored area and the trajectory on the last floor."""
    return MapView.fit(grid, size, points=[step.pose[:2] for step in on_last_floor(steps)])


def draw_result(
    grid: OccupancyGrid, steps: Sequence[StepTrace], *, size: int = _MAP_SIZE, robot: bool = True
) -> UInt8[np.ndarray, "_ _ 3"]:
    """Draw the map at the end of an episode, with the trajectory on its floor.

    Args:
        grid: The last map.
        steps: The whole trace; may be empty.
        size: Side of the image, pixels.
        robot: Whether to draw the robot where it stopped.
    """
    last = steps[-1] if steps else None
    trajectory = [step.pose[:2] for step in on_last_floor(steps)]
    return draw_map(
        grid,
        view=final_view(grid, steps, size),
        robot=Pose2(*last.pose) if last and robot else None,
        trajectory=trajectory,
        start=trajectory[0] if trajectory else None,
        goal_area=last.goal_area if last else (),
    )


def write_map_png(
    path: Path, grid: OccupancyGrid, steps: Sequence[StepTrace], *, size: int = _MAP_SIZE
) -> Path:
    """Write the map at the end of an episode as a PNG, with a legend below it.

    Args:
        path: The file; missing folders are created.
        grid: The last map.
        steps: The whole trace; may be empty.
        size: Width of the image, pixels.

    Returns:
        The path.
    """
    image = np.full((size + _LEGEND_HEIGHT, size, 3), palette.PAPER, dtype=np.uint8)
    image[:size] = draw_result(grid, steps, size=size)
    layers = [Layer.FREE, Layer.OCCUPIED, Layer.UNKNOWN]
    if steps:
        layers += [Layer.START, Layer.TRAJECTORY, Layer.ROBOT]
    if steps and steps[-1].goal_area:
        layers.append(Layer.GOAL)
    draw_legend(image, layers, left=20, middle=size + _LEGEND_HEIGHT / 2, size=17)
    path.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(image).save(path, optimize=True)
    return path
