"""The surfaces of a building as coloured points, gathered from images with depth."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float, Int64, UInt8

from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Transform

MOST_POINTS = 600_000
"""Number of points that a page holds; beyond it they are set further apart."""
_FINEST_M = 0.04
_ROWS = 120
"""Number of rows of an image that are read; the others repeat what these show."""
_MERGED_AT = 3_000_000
_FARTHEST_M = 8.0
"""Depth, metres, beyond which the points of an image lie too far apart to make a surface."""
_BITS = 16
_MIDDLE = 1 << (_BITS - 1)
_REACH_M = 1000.0
"""Distance from the first camera, metres, along each axis, within which points are kept; on the
finest lattice its cells have numbers of 16 bits."""

Points = tuple[Int64[np.ndarray, "n 3"], UInt8[np.ndarray, "n 3"]]
"""Cells ``(x, y, z)`` of a cloud, the lowest first, and their colours."""


class ColouredCloud:
    """Points on a cubic lattice, on every floor, each in the colour of its first image.

    The lattice is made coarser whenever there are too many points, so memory stays bounded.

    Attributes:
        spacing_m: Side of a cube of the lattice, metres.
        origin: Corner ``(x, y, z)`` of the cell 0, 0, 0, metres: near the first camera, since map
            frames may lie far from the building.
    """

    def __init__(self, most_points: int = MOST_POINTS) -> None:
        """Begin without points.

        Args:
            most_points: Greatest number of points of all floors together.
        """
        self.spacing_m = _FINEST_M
        self.origin: tuple[float, float, float] | None = None
        self._most = most_points
        self._kept = dict[int, tuple[Int64[np.ndarray, " n"], UInt8[np.ndarray, "n 3"]]]()
        self._new = dict[int, list[tuple[Int64[np.ndarray, " n"], UInt8[np.ndarray, "n 3"]]]]()
        self._waiting = 0

    def add(
        self,
        rgb: UInt8[np.ndarray, "height width 3"],
        depth: Float[np.ndarray, "rows columns"],
        camera: PinholeCamera,
        camera_to_map: Transform,
        *,
        floor: int,
    ) -> None:
        """Add what an image shows.

        Args:
            rgb: Colours.
            depth: Metres along the optical axis, 0 where nothing is known; every n-th pixel of the
                colours' rows and columns, n from 1.
            camera: Intrinsics of the colours.
            camera_to_map: Pose of the camera.
            floor: Number of the floor that it was on.
        """
        ratio = -(-rgb.shape[0] // depth.shape[0])
        stride = max(depth.shape[0] // _ROWS, 1)
        depth = depth[::stride, ::stride]
        rows, columns = np.nonzero((depth > 0.0) & (depth < _FARTHEST_M))
        if not rows.size:
            return
        v, u = rows * stride * ratio, columns * stride * ratio
        points = camera_to_map.apply(camera.unproject_pixels(v, u, depth[rows, columns]))
        if self.origin is None:
            x, y, z = np.round(camera_to_map.translation).tolist()
            self.origin = (x, y, z)
        points -= self.origin
        near = (np.abs(points) < _REACH_M).all(axis=1)
        cells = np.floor(points[near] / self.spacing_m).astype(np.int64)
        v, u = v[near], u[near]
        codes, first = np.unique(_codes(cells), return_index=True)
        self._new.setdefault(floor, []).append((codes, rgb[v[first], u[first]]))
        self._waiting += codes.size
        if self._waiting > _MERGED_AT:
            self._merge()

    def points(self) -> Mapping[int, Points]:
        """Cells and colours by the number of the floor; a cell's middle is half a cell further."""
        self._merge()
        return {floor: (_cells(codes), rgb) for floor, (codes, rgb) in self._kept.items()}

    def _merge(self) -> None:
        for floor, parts in self._new.items():
            parts = [self._kept[floor], *parts] if floor in self._kept else parts
            self._kept[floor] = _first(*map(np.concatenate, zip(*parts, strict=True)))
        self._new, self._waiting = {}, 0
        while sum(codes.size for codes, _ in self._kept.values()) > self._most:
            self._coarsen()

    def _coarsen(self) -> None:
        """Set the points twice as far apart: eight cells become one, so nothing drifts."""
        self.spacing_m *= 2.0
        for floor, (codes, rgb) in self._kept.items():
            self._kept[floor] = _first(_codes(_cells(codes) >> 1), rgb)


def _first(
    codes: Int64[np.ndarray, " n"], rgb: UInt8[np.ndarray, "n 3"]
) -> tuple[Int64[np.ndarray, " m"], UInt8[np.ndarray, "m 3"]]:
    """Every code once, in order, with the first colour."""
    codes, first = np.unique(codes, return_index=True)
    return codes, rgb[first]


def _codes(cells: Int64[np.ndarray, "n 3"]) -> Int64[np.ndarray, " n"]:
    """One number for each cell; cells side by side have numbers near each other."""
    x, y, z = (cells + _MIDDLE).T
    return (z << 2 * _BITS) | (y << _BITS) | x


def _cells(codes: Int64[np.ndarray, " n"]) -> Int64[np.ndarray, "n 3"]:
    mask = (1 << _BITS) - 1
    return np.stack([codes & mask, codes >> _BITS & mask, codes >> 2 * _BITS], axis=1) - _MIDDLE
