"""Samples of heights within a polygon, as ``buildPolyDetail`` of Recast."""

import math

import numpy as np
from jaxtyping import Float32, Int64

from hypernav.worlds.navmesh.recast.detail.heights import Patch, Sampling
from hypernav.worlds.navmesh.recast.detail.segments import (
    Point,
    Points,
    is_inside,
    squared_to_sides,
)

_HALF, _ONE, _TWO = np.float32(0.5), np.float32(1.0), np.float32(2.0)
_INSIDE = np.float32(1e-4)
_JITTER = np.float32(0.1)
_JITTER_RANGE = np.float32(65535.0)
_JITTER_X, _JITTER_Z = 0x8DA6B343, 0xD8163841


class InnerSamples:
    """Samples on a grid within a polygon that are not vertices yet."""

    def __init__(self, outline: Points, patch: Patch, sampling: Sampling) -> None:
        """Take the samples.

        Args:
            outline: The polygon.
            patch: Heights.
            sampling: How they are sampled.
        """
        spacing, low, high = sampling.spacing, outline.min(axis=0), outline.max(axis=0)
        x, z = (
            np.arange(math.floor(low[axis] / spacing), math.ceil(high[axis] / spacing))
            for axis in (0, 2)
        )
        rows = np.stack([np.tile(x, len(z)), np.repeat(z, len(x))], axis=1)
        middle = np.full(len(rows), (high[1] + low[1]) * _HALF)
        grid = rows.astype(np.float32) * spacing
        points = np.stack([grid[:, 0], middle, grid[:, 1]], axis=1)
        least = squared_to_sides(points, outline).min(axis=1)
        within = is_inside(points, outline) & ~(-least > -spacing / _TWO)
        points = points[within]
        points[:, 1] = patch.at(points, sampling).astype(np.float32) * sampling.cell_height
        # Moved a little aside, because even grids triangulate badly.
        number = np.arange(len(points))
        points[:, 0] += _jitter(number, _JITTER_X) * sampling.cell * _JITTER
        points[:, 2] += _jitter(number, _JITTER_Z) * sampling.cell * _JITTER
        self._points, self._most_error = points, sampling.most_error

    def take_worst(self, vertices: Points, triangles: Int64[np.ndarray, "t 3"]) -> Point | None:
        """The sample whose height is farthest from the triangles', if that is too far."""
        if len(self._points) == 0 or len(triangles) == 0:
            return None
        gaps = _height_gaps(self._points, vertices[triangles])
        worst = int(gaps.argmax())
        if not gaps[worst] > self._most_error:
            return None
        point = self._points[worst]
        self._points = np.delete(self._points, worst, axis=0)
        return point


def _jitter(number: Int64[np.ndarray, " n"], factor: int) -> Float32[np.ndarray, " n"]:
    low = ((number * factor) & 0xFFFF).astype(np.float32)
    return low / _JITTER_RANGE * _TWO - _ONE


def _height_gaps(p: Points, corners: Float32[np.ndarray, "t 3 3"]) -> Float32[np.ndarray, " n"]:
    """Least distance in height of points to the triangles above or below them; -1 beside all."""
    a, c = corners[:, 0], corners[:, 2]
    ux, uy, uz = (c - a).T
    vx, vy, vz = (corners[:, 1] - a).T
    wx, wz = p[:, None, 0] - a[:, 0], p[:, None, 2] - a[:, 2]
    uu, uv, uw = ux * ux + uz * uz, ux * vx + uz * vz, ux * wx + uz * wz
    vv, vw = vx * vx + vz * vz, vx * wx + vz * wz
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        inverse = _ONE / (uu * vv - uv * uv)
        s, t = (vv * uw - uv * vw) * inverse, (uu * vw - uv * uw) * inverse
        gaps = np.abs(a[:, 1] + uy * s + vy * t - p[:, None, 1])
        inside = (s >= -_INSIDE) & (t >= -_INSIDE) & (s + t <= _ONE + _INSIDE)
    least = np.where(inside, gaps, np.inf).min(axis=1)
    return np.where(least < np.inf, least, -_ONE)
