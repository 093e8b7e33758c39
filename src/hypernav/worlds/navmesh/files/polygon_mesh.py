"""Polygons that share edges, from which a navigation mesh file is written."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from hypernav.core.errors import NavmeshError
from hypernav.worlds.navmesh.files.file_format import EXTERNAL, VERTICES_PER_POLYGON

_MOST_VERTICES = 0xFFFF


@dataclass(frozen=True, eq=False)
class PolygonMesh:
    """Convex polygons; where two share both ends of an edge, one can walk across.

    Attributes:
        vertices: Corners, scene frame (z up), metres.
        polygons: Corners of every polygon, counter-clockwise seen from above, padded with -1.
    """

    vertices: Float64[np.ndarray, "v 3"]
    polygons: Int64[np.ndarray, "p 6"]

    @staticmethod
    def of(
        vertices: Float64[np.ndarray, "v 3"], polygons: Sequence[Sequence[int]]
    ) -> "PolygonMesh":
        """Create it from polygons of 3 to 6 corners.

        Raises:
            NavmeshError: A file cannot hold so many, or a polygon has another number of corners.
        """
        sizes = {len(polygon) for polygon in polygons}
        if not polygons or not sizes <= set(range(3, VERTICES_PER_POLYGON + 1)):
            raise NavmeshError(
                f"expected polygons with 3 to {VERTICES_PER_POLYGON} corners, found "
                f"{sorted(sizes) or 'none'}"
            )
        if len(polygons) >= EXTERNAL or len(vertices) > _MOST_VERTICES:
            raise NavmeshError(
                f"expected less than {EXTERNAL:,} polygons with {_MOST_VERTICES:,} corners, found "
                f"{len(polygons):,} with {len(vertices):,}; choose larger cells"
            )
        padded = np.full((len(polygons), VERTICES_PER_POLYGON), -1, dtype=np.int64)
        for row, polygon in zip(padded, polygons, strict=True):
            row[: len(polygon)] = polygon
        return PolygonMesh(vertices, padded)

    @property
    def sizes(self) -> Int64[np.ndarray, " p"]:
        """Number of corners of every polygon."""
        return (self.polygons >= 0).sum(axis=1)

    def neighbours(self) -> Int64[np.ndarray, "p 6"]:
        """Polygon on the other side of every edge, -1 where there is none.

        Raises:
            NavmeshError: An edge belongs to more than two polygons, or to two on the same side.
        """
        owner, edge = np.nonzero(self.polygons >= 0)
        ends = np.stack(
            [
                self.polygons[owner, edge],
                self.polygons[owner, (edge + 1) % self.sizes[owner]],
            ],
            axis=1,
        )
        forward = ends[:, 0] * len(self.vertices) + ends[:, 1]
        backward = ends[:, 1] * len(self.vertices) + ends[:, 0]
        order = np.argsort(forward)
        if (np.diff(forward[order]) == 0).any():
            raise NavmeshError("two polygons lie on the same side of an edge")
        found = order[np.minimum(np.searchsorted(forward[order], backward), len(order) - 1)]
        neighbours = np.full(self.polygons.shape, -1, dtype=np.int64)
        neighbours[owner, edge] = np.where(forward[found] == backward, owner[found], -1)
        return neighbours
