"""A walk through a building for the page's script: positions, drives, and what each one shows."""

import base64
import io
import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float32, Float64, Int32, UInt8
from PIL import Image
from scipy import ndimage

from hypernav.core.embodiment import CameraConfig
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, wrap_angle
from hypernav.core.world import Instance
from hypernav.simulator.houses.export.building_views import camera_pose
from hypernav.simulator.houses.plan.floor_plan import FloorPlan
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer
from hypernav.simulator.worlds.scenes.scene import Scene
from hypernav.simulator.worlds.surface.walkable import WalkableGrid

MOST_POSITIONS = 140
"""Number of positions above which the spacing is increased, to limit the size of the page."""
_SPACINGS_M = (2.0, 2.5, 3.0)
_APART = 0.6
_REACH = 2.5
_SNAP = 0.25
"""Smallest distance of two positions, length of the longest drive, and largest shift of a position
from its lattice point, relative to the spacing."""
_ROOMY_M = 0.3
"""Clearance beyond which more clearance makes a position no better."""

Point = tuple[float, float]

SLICES = 8
"""Number of images side by side that make a panorama."""
_SLICE_WIDTH = 232
_LEAST_PIXELS = 200
"""Size from which an object counts as seen, pixels."""
_QUALITY = 50

_TURN_DEG = 30
_AHEAD = math.radians(40.0)


@dataclass(frozen=True)
class WalkGraph:
    """Positions and the drives between them.

    Attributes:
        positions: Standable points, metres, scene frame; the middles of rooms come first.
        neighbours: For every position, in increasing order, those that the robot can reach in a
            straight line, and return from.
    """

    positions: tuple[Point, ...]
    neighbours: tuple[tuple[int, ...], ...]


def walk_graph(grid: WalkableGrid, plan: FloorPlan) -> WalkGraph:
    """Spread positions over the largest connected floor.

    There is one near the middle of every room, in every door, and on a square lattice, each moved
    to where there is room around it. The lattice is 2 m wide, in large buildings 2.5 or 3 m, where
    more than `MOST_POSITIONS` would be needed. Where positions are not connected, some are added
    on the shortest path between them.
    """
    floor = _Floor(grid)
    graph = WalkGraph((), ())
    for spacing in _SPACINGS_M:
        graph = _graph_with(floor, plan, spacing)
        if len(graph.positions) <= MOST_POSITIONS:
            break
    return graph


class _Floor:
    """The largest connected floor and the clearance on it."""

    def __init__(self, grid: WalkableGrid) -> None:
        self.grid = grid
        self._free = grid.components == 0
        distance: Float64[np.ndarray, "rows columns"] = np.asarray(
            ndimage.distance_transform_edt(np.pad(self._free, 1))
        )
        self._clearance = distance[1:-1, 1:-1] * grid.cell_m

    def roomy_point(self, point: Point, reach_m: float) -> Point | None:
        """Middle of the cell near a point that has room around it; None if none is in reach."""
        cell_m, reach = self.grid.cell_m, max(round(reach_m / self.grid.cell_m), 1)
        row, column = self.grid.cell_of(*point)
        top, left = max(row - reach, 0), max(column - reach, 0)
        window = np.s_[top : max(row + reach + 1, 0), left : max(column + reach + 1, 0)]
        rows, columns = np.nonzero(self._free[window])
        if rows.size == 0:
            return None
        away_m = np.hypot(rows + top - row, columns + left - column) * cell_m
        room_m = np.minimum(self._clearance[window][rows, columns], _ROOMY_M)
        best = int(np.argmax(room_m - 0.5 * away_m))
        x0, y0 = self.grid.origin
        return (
            float(x0 + (columns[best] + left + 0.5) * cell_m),
            float(y0 + (rows[best] + top + 0.5) * cell_m),
        )

    def can_drive(self, a: Point, b: Point) -> bool:
        """Whether the robot can drive straight from one point to the other and back."""
        return all(
            math.dist(self.grid.step(*start, end[0] - start[0], end[1] - start[1]), end)
            < self.grid.cell_m
            for start, end in ((a, b), (b, a))
        )


def _graph_with(floor: _Floor, plan: FloorPlan, spacing: float) -> WalkGraph:
    points = _spread(floor, plan, spacing)
    links = {
        (a, b)
        for a, b in itertools.combinations(range(len(points)), 2)
        if math.dist(points[a], points[b]) <= _REACH * spacing
        and floor.can_drive(points[a], points[b])
    }
    _connect(floor, points, links)
    neighbours = _neighbours(len(points), links)
    return WalkGraph(tuple(points), tuple(tuple(sorted(own)) for own in neighbours))


def _spread(floor: _Floor, plan: FloorPlan, spacing: float) -> list[Point]:
    rows, columns = floor.grid.components.shape
    x0, y0 = floor.grid.origin
    wanted = [
        *(room.inner.centre for room in plan.rooms),
        *(opening.middle for opening in plan.openings if opening.is_passable),
        *(
            (float(x), float(y))
            for y in np.arange(y0 + spacing / 2, y0 + rows * floor.grid.cell_m, spacing)
            for x in np.arange(x0 + spacing / 2, x0 + columns * floor.grid.cell_m, spacing)
        ),
    ]
    points = list[Point]()
    for place in wanted:
        point = floor.roomy_point(place, _SNAP * spacing)
        if point is not None and not any(
            math.dist(point, other) < _APART * spacing and floor.can_drive(point, other)
            for other in points
        ):
            points.append(point)
    return points


def _connect(floor: _Floor, points: list[Point], links: set[tuple[int, int]]) -> None:
    """Add drives, and positions if necessary, until all positions are connected."""
    while len(reached := _reached(len(points), links)) < len(points):
        others = [n for n in range(len(points)) if n not in reached]
        field = floor.grid.distance_field(np.array([points[n] for n in sorted(reached)]))
        b = min(others, key=lambda n: field.distance(*points[n]))
        end = field.path(*points[b])[-1]
        a = min(sorted(reached), key=lambda n: math.dist(points[n], end))
        _bridge(floor, points, links, a, b)


def _reached(count: int, links: set[tuple[int, int]]) -> set[int]:
    """Positions that can be reached from the first."""
    neighbours = _neighbours(count, links)
    reached, ahead = {0}, [0]
    while ahead:
        new = [n for n in neighbours[ahead.pop()] if n not in reached]
        reached.update(new)
        ahead += new
    return reached


def _neighbours(count: int, links: set[tuple[int, int]]) -> list[list[int]]:
    neighbours = [list[int]() for _ in range(count)]
    for a, b in sorted(links):
        neighbours[a].append(b)
        neighbours[b].append(a)
    return neighbours


def _bridge(
    floor: _Floor, points: list[Point], links: set[tuple[int, int]], a: int, b: int
) -> None:
    """Link two positions, through the middle of the path between them if necessary."""
    if floor.can_drive(points[a], points[b]):
        links.add((min(a, b), max(a, b)))
        return
    path = np.array(floor.grid.shortest_path(points[a], points[b]))
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
    half = along[-1] / 2
    middle = float(np.interp(half, along, path[:, 0])), float(np.interp(half, along, path[:, 1]))
    points.append(floor.roomy_point(middle, min(half / 2, _ROOMY_M)) or middle)
    between = len(points) - 1
    _bridge(floor, points, links, a, between)
    _bridge(floor, points, links, between, b)


@dataclass(frozen=True)
class Sighting:
    """An object that a panorama shows.

    Attributes:
        instance: Number of the object in its scene.
        yaw: Direction of the middle column that shows it, radians in the scene frame.
        distance_m: Median horizontal distance of its visible part, metres.
        pixels: Number of pixels that show it.
    """

    instance: int
    yaw: float
    distance_m: float
    pixels: int


@dataclass(frozen=True, eq=False)
class Panorama:
    """Slices of a circle side by side: images of a pinhole camera, each turned further right.

    The first slice begins at a yaw of 180°. Drawn on the faces of a prism, the panorama gives the
    camera's perspective without kinks at the seams.

    Attributes:
        rgb: Colours.
        depth: Metres along the axis of the slice's camera; 0 where nothing was hit.
        instance_ids: Instance of every pixel, -1 where nothing was hit.
    """

    rgb: UInt8[np.ndarray, "height width 3"]
    depth: Float32[np.ndarray, "height width"]
    instance_ids: Int32[np.ndarray, "height width"]

    def webp(self) -> bytes:
        """The colours as a file."""
        file = io.BytesIO()
        Image.fromarray(self.rgb).save(file, "WEBP", quality=_QUALITY, method=2)
        return file.getvalue()

    def sightings(self, instances: tuple[Instance, ...]) -> list[Sighting]:
        """The labelled objects that are large enough to be noticed, largest first."""
        yaws = column_yaws()
        off_axis = np.tile(np.arctan(slice_camera().ray_slopes()[0]), SLICES)
        distances = self.depth / np.cos(off_axis)[None, :]
        pixels = np.bincount(self.instance_ids[self.instance_ids >= 0], minlength=len(instances))
        found = []
        for number in np.flatnonzero(pixels >= _LEAST_PIXELS).tolist():
            if instances[number].label is None:
                continue
            shown = self.instance_ids == number
            columns = np.flatnonzero(shown.any(axis=0))
            middle = np.exp(1j * yaws[columns]).mean()
            column = columns[np.argmax((np.exp(1j * yaws[columns]) * np.conj(middle)).real)]
            found.append(
                Sighting(
                    number,
                    float(yaws[column]),
                    float(np.median(distances[shown])),
                    int(pixels[number]),
                )
            )
        return sorted(found, key=lambda sighting: (-sighting.pixels, sighting.instance))


def slice_camera() -> PinholeCamera:
    """Camera of one slice, high enough for the robot's camera in every direction."""
    half = math.pi / SLICES
    focal = _SLICE_WIDTH / 2.0 / math.tan(half)
    height = 2 * math.ceil(focal * half_slope() / math.cos(half))
    return PinholeCamera(_SLICE_WIDTH, height, focal, focal, _SLICE_WIDTH / 2.0, height / 2.0)


def half_slope() -> float:
    """Tangent of half the vertical field of view of the robot's camera."""
    camera = CameraConfig().intrinsics
    return camera.height / 2.0 / camera.fy


def column_yaws() -> Float64[np.ndarray, " width"]:
    """Direction of every column of a panorama, radians in the scene frame, falling from pi."""
    middles = math.pi - (np.arange(SLICES) + 0.5) * 2.0 * math.pi / SLICES
    off_axis = np.arctan(slice_camera().ray_slopes()[0])
    return (middles[:, None] - off_axis[None, :]).ravel()


def draw_panorama(
    position: tuple[float, float], *, grid: WalkableGrid, renderer: CpuRenderer
) -> Panorama:
    """Draw what the robot's camera sees around a position.

    Args:
        position: Standable point, metres, scene frame.
        grid: Where the robot can stand.
        renderer: Renderer of the scene.
    """
    camera, config = slice_camera(), CameraConfig()
    views = [
        renderer.render(camera, camera_pose(grid, config, Pose2(*position, yaw)))
        for yaw in math.pi - (np.arange(SLICES) + 0.5) * 2.0 * math.pi / SLICES
    ]
    return Panorama(
        np.concatenate([view.rgb for view in views], axis=1),
        np.concatenate([view.depth for view in views], axis=1),
        np.concatenate([view.instance_ids for view in views], axis=1),
    )


def walk_data(
    scene: Scene,
    plan: FloorPlan,
    graph: WalkGraph,
    *,
    grid: WalkableGrid,
    renderer: CpuRenderer,
    progress: Callable[[int, int], None] | None = None,
) -> dict[str, Any]:
    """Positions, with the visible objects and the panorama of each.

    Args:
        scene: Scene of the building.
        plan: Floor plan of the building.
        graph: Positions and drives of the walk.
        grid: Where the robot can stand.
        renderer: Renderer of the scene.
        progress: Function that is called with the numbers of drawn panoramas and of all.

    Returns:
        Plain data for JSON. Angles are degrees, counter-clockwise from the x axis; distances are
        tenths of a metre.
    """
    labels = {i.id: i.label for i in scene.instances if i.label is not None}
    names = sorted({label.category for label in labels.values()})
    index = {name: n for n, name in enumerate(names)}
    positions, panoramas, sights = [], [], list[list[Sighting]]()
    for number, (point, neighbours) in enumerate(
        zip(graph.positions, graph.neighbours, strict=True), start=1
    ):
        panorama = draw_panorama(point, grid=grid, renderer=renderer)
        sights.append(panorama.sightings(scene.instances))
        panoramas.append(_as_text(panorama))
        positions.append(
            {
                "at": [round(c, 3) for c in point],
                "room": _room_at(plan, point),
                "next": list(neighbours),
                "seen": [
                    [
                        index[labels[sight.instance].category],
                        round(math.degrees(wrap_angle(sight.yaw))),
                        round(10.0 * sight.distance_m),
                    ]
                    for sight in sights[-1]
                ],
            }
        )
        if progress is not None:
            progress(number, len(graph.positions))
    names_of_rooms = [position["room"] for position in positions]
    middles = [names_of_rooms.index(name) for name in dict.fromkeys(names_of_rooms)]
    at, heading = _best_start({at: sights[at] for at in middles})
    return {
        "start": {"at": at, "heading": heading},
        "turn": _TURN_DEG,
        "slices": SLICES,
        "slope": round(half_slope(), 6),
        "names": names,
        "where": {
            name: [
                [round((i.box_min[k] + i.box_max[k]) / 2.0, 2) for k in (0, 1)]
                for i in scene.instances
                if i.id in labels and labels[i.id].category == name
            ]
            for name in names
        },
        "positions": positions,
        "panoramas": panoramas,
    }


def _as_text(panorama: Panorama) -> str:
    return base64.b64encode(panorama.webp()).decode("ascii")


def _room_at(plan: FloorPlan, point: tuple[float, float]) -> str:
    """Name of the room that a point lies in; empty outside all rooms."""
    for room in plan.rooms:
        if room.cell.x0 <= point[0] <= room.cell.x1 and room.cell.y0 <= point[1] <= room.cell.y1:
            return room.name
    return ""


def _best_start(sights: dict[int, list[Sighting]]) -> tuple[int, int]:
    """Position and heading (degrees) of a view with most objects."""

    def shown(at: int, heading: int) -> int:
        yaw = math.radians(heading)
        return sum(abs(wrap_angle(sight.yaw - yaw)) < _AHEAD for sight in sights[at])

    poses = [(at, heading) for at in sights for heading in range(0, 360, _TURN_DEG)]
    return max(poses, key=lambda pose: shown(*pose))
