"""Transfers the marks of an annotated mesh to the triangles of the drawn one.

The annotated mesh need not have the triangles of the drawn one. So points are spread over it, and
every drawn triangle gets the mark (a colour or a number) of the point nearest to its centre.
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Float64, Int64

from hypernav.core.errors import SceneError

NO_MARK = -1
"""Mark of a triangle that is far from the annotated mesh."""
MOST_POINTS = 8_000_000

_SPACING_M = 0.05
_REACH_M = 0.25
_GOLDEN = 1.324717957244746
"""Multiples of the two-dimensional golden ratio, modulo 1, are spread evenly for any number."""


class Spread(NamedTuple):
    """Points on triangles.

    Attributes:
        points: Positions.
        face: Triangle of every point.
        weights: Shares of its corners.
    """

    points: Float64[np.ndarray, "n 3"]
    face: Int64[np.ndarray, "n"]
    weights: Float64[np.ndarray, "n 3"]


def nearest_marks(
    points: Float64[np.ndarray, "n 3"],
    marks: Int64[np.ndarray, "n"],
    vertices: Float32[np.ndarray, "vertices 3"],
    faces: np.ndarray,
) -> Int64[np.ndarray, "faces"]:
    """The mark of the point that is nearest to the middle of every triangle.

    Args:
        points: Points on the annotated mesh, scene frame, metres.
        marks: Their marks.
        vertices: Positions of the drawn mesh, scene frame, metres.
        faces: Vertex numbers of its triangles.

    Returns:
        Marks; `NO_MARK` where no point is within 0.25 m.
    """
    from scipy.spatial import KDTree  # imported here, because only scans need it and it takes time

    middles = vertices[faces].mean(axis=1, dtype=np.float64)
    tree = KDTree(points, balanced_tree=False, compact_nodes=False)
    _, nearest = tree.query(middles, distance_upper_bound=_REACH_M)
    return np.append(marks, NO_MARK)[nearest]


def spread_points(path: Path, corners: Float64[np.ndarray, "faces 3 3"], most: int) -> Spread:
    """Points 5 cm apart on triangles, at least the middle of each.

    Args:
        path: File of the triangles, for the error.
        corners: Corners of the triangles, metres; those with non-finite corners get no point.
        most: Largest number of points.

    Raises:
            SceneError: The triangles would need more points.
    """
    whole = np.flatnonzero(np.isfinite(corners).all(axis=(1, 2)))
    more = _points_of_faces(corners[whole])
    if len(whole) + int(more.sum()) > most:
        raise SceneError(f"{path}: its surface is too large for a building; are its units metres?")
    place, weights = _spread(more)
    face = whole[place]
    return Spread(np.einsum("nk,nkd->nd", weights, corners[face]), face, weights)


def _points_of_faces(corners: Float64[np.ndarray, "faces 3 3"]) -> Int64[np.ndarray, "faces"]:
    """Numbers of points besides the centre that faces get by their size."""
    sides = corners[:, 1:] - corners[:, :1]
    areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) / 2.0
    return np.minimum(areas / _SPACING_M**2, float(MOST_POINTS)).astype(np.int64)


def _spread(
    more: Int64[np.ndarray, "faces"],
) -> tuple[Int64[np.ndarray, "n"], Float64[np.ndarray, "n 3"]]:
    """Faces and barycentric weights of points, the middles of all faces first."""
    face = np.repeat(np.arange(len(more)), more)
    place = np.arange(len(face)) - np.repeat(np.cumsum(more) - more, more) + 1
    u, v = (place / _GOLDEN) % 1.0, (place / _GOLDEN**2) % 1.0
    folded = u + v > 1.0
    u, v = np.where(folded, 1.0 - u, u), np.where(folded, 1.0 - v, v)
    middles = np.full((len(more), 3), 1.0 / 3.0)
    weights = np.concatenate([middles, np.column_stack([1.0 - u - v, u, v])])
    return np.concatenate([np.arange(len(more)), face]), weights
