"""The content of a view in three dimensions, for ``spatial.html.j2`` and ``spatial.js``.

Positions are metres in the ``map`` frame, z up. Of every floor the view shows the map, and the
points of a cloud up to a height above it, so that one looks into the rooms from above.
"""

import base64
import gzip
import io
from collections.abc import Mapping, Sequence
from functools import cache
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from hypernav.app.show.climbs import floor_heights_m, floor_words
from hypernav.app.show.episode_summary import runs
from hypernav.app.show.spatial.cloud import ColouredCloud
from hypernav.app.show.templating import data_uri, mode_name, plain
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Transform
from hypernav.core.trace import Ending, StepTrace, floor_of
from hypernav.search.drawing import palette

_THREE = Path(__file__).parent / "three"
_FAR_M = 0.7
"""Distance from a camera, metres, at which the frame of its image is drawn."""

View = dict[str, Any]
"""What the script of the view reads, as plain data."""


@cache
def library() -> dict[str, str]:
    """Name and text of three.js and its controls, compressed, as base64."""
    return {
        name: _packed((_THREE / file).read_bytes())
        for name, file in (("three", "three.module.min.js"), ("controls", "OrbitControls.js"))
    }


def _packed(content: bytes) -> str:
    return base64.b64encode(gzip.compress(content, mtime=0)).decode("ascii")


def search_view(
    steps: Sequence[StepTrace],
    maps: Mapping[int, OccupancyGrid],
    cloud: ColouredCloud | None,
    eye: list[list[float]],
) -> View | None:
    """What a search saw, where it drove, and what it took for the goal.

    Args:
        steps: Trace of the search.
        maps: Last map of every floor, by its number.
        cloud: What its camera saw; None if that was not kept.
        eye: `camera_frame` of its camera in the frame of the robot; empty if that was not kept.

    Returns:
        The content; None without a step on a floor with a map.
    """
    steps = [step for step in steps if floor_of(step) in maps]
    if not steps:
        return None
    start, heights = floor_of(steps[0]), floor_heights_m(steps)
    floors = [
        floor_plate(floor, floor_words(floor, start, heights), heights.get(floor, 0.0), grid)
        for floor, grid in sorted(maps.items())
    ]
    return {
        "floors": floors,
        "cloud": None if cloud is None else packed_cloud(cloud),
        "paths": _paths(steps),
        "marks": _candidates(steps, heights),
        "boxes": [],
        "views": [],
        "eye": eye,
        "robots": {
            step.step: [floor_of(step), *_at(step), round(step.pose[2], 3)] for step in steps
        },
    }


def floor_plate(floor: int, words: str, z: float, grid: OccupancyGrid) -> dict[str, Any]:
    """The map of a floor as an image that lies in it, where unknown cells are transparent."""
    grid = grid.cropped(0.0)
    table = np.zeros((256, 4), dtype=np.uint8)
    table[Cell.FREE] = (*palette.FREE, 255)
    table[Cell.OCCUPIED] = (*palette.OCCUPIED, 255)
    file = io.BytesIO()
    Image.fromarray(table[grid.cells[::-1]]).save(file, "PNG", optimize=True)
    rows, columns = grid.cells.shape
    return {
        "number": floor,
        "words": words,
        "z": round(z, 3),
        "image": data_uri(file.getvalue(), "image/png"),
        "corner": list(grid.origin),
        "size": [columns * grid.resolution_m, rows * grid.resolution_m],
    }


def packed_cloud(cloud: ColouredCloud) -> dict[str, Any]:
    """A cloud as compressed numbers of 16 bits: x, y, z and colour of all points.

    Each coordinate counts from that of the point before, a colour has 5, 6 and 5 bits.
    """
    floors = cloud.points()
    cells = np.concatenate([np.zeros((0, 3), np.int64), *(one[0] for one in floors.values())])
    rgb = np.concatenate([np.zeros((0, 3), np.uint8), *(one[1] for one in floors.values())])
    red, green, blue = rgb.astype(np.uint16).T
    colours = (red >> 3) << 11 | (green >> 2) << 5 | blue >> 3
    steps = np.diff(cells, axis=0, prepend=np.zeros((1, 3), np.int64))
    numbers = np.concatenate([steps.T.ravel().astype(np.int16).view(np.uint16), colours])
    return {
        "spacing": cloud.spacing_m,
        "origin": cloud.origin or (0.0, 0.0, 0.0),
        "counts": {floor: len(one[0]) for floor, one in floors.items()},
        "numbers": _packed(numbers.astype("<u2").tobytes()),
    }


def camera_frame(camera: PinholeCamera, camera_to_map: Transform) -> list[list[float]]:
    """A camera's position and the corners of its image in front of it, clockwise."""
    u, v = np.array([0.0, 1.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0, 1.0])
    corners = camera.unproject(u * camera.width, v * camera.height, np.full(4, _FAR_M))
    points = camera_to_map.apply(np.concatenate([np.zeros((1, 3)), corners]))
    return points.round(3).tolist()


def _at(step: StepTrace) -> list[float]:
    return [round(step.pose[0], 3), round(step.pose[1], 3), round(step.z, 3)]


def _paths(steps: Sequence[StepTrace]) -> list[dict[str, Any]]:
    """The parts of the path in one mode on one floor, each from the end of the one before."""
    parts = []
    for (floor, mode), first, count in runs(steps, lambda step: (floor_of(step), step.mode)):
        points = [_at(step) for step in steps[first : first + count + 1]]
        points = [point for point, _ in groupby(points)]
        if len(points) > 1:
            parts.append({"floor": floor, "color": f"--{mode_name(mode)}", "points": points})
    return parts


def _candidates(steps: Sequence[StepTrace], heights: Mapping[int, float]) -> list[dict[str, Any]]:
    """What looked like the goal: its last area, and whether the search ended with it."""
    marks = []
    found = runs(steps, lambda step: (floor_of(step), bool(step.goal_area)))
    for (floor, has_area), first, count in found:
        if not has_area:
            continue
        last = steps[first + count - 1]
        is_goal = last is steps[-1] and last.ending is Ending.FOUND
        marks.append(
            {
                "floor": floor,
                "z": heights.get(floor, 0.0),
                "color": "--good" if is_goal else "--bad",
                "words": "the goal, as the robot says" if is_goal else "looked like the goal",
                "rings": plain(last.goal_area),
            }
        )
    return marks
