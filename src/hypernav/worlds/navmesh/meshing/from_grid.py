"""The walkable surface of a storey as the polygons of a navigation mesh."""

import numpy as np

from hypernav.core.errors import NavmeshError
from hypernav.worlds.navmesh.files.polygon_mesh import PolygonMesh
from hypernav.worlds.navmesh.meshing.outlines import outlines
from hypernav.worlds.navmesh.meshing.triangulation import fill, join
from hypernav.worlds.surface.walkable import WalkableGrid

_TOLERANCE = 0.34
"""Cells: 1.7 cm. Outlines are at least 0.7 cells apart, so that they stay apart."""


def mesh_from_grid(walkable: WalkableGrid) -> PolygonMesh:
    """Polygons over all standable cells, equal in area.

    Detour's search runs over the middles of sides, for which large polygons are better than small
    ones, so polygons are cut only as the outlines require. Heights are those of the floor at the
    outlines.

    Args:
        walkable: The walkable surface.

    Raises:
        NavmeshError: There are more polygons than a file has room for, or nothing to stand on.
    """
    lines = outlines(walkable.standable, _TOLERANCE)
    if not lines:
        raise NavmeshError("the walkable surface has no standable cell to write")
    counts = [len(line.points) for line in lines]
    first = np.cumsum([0, *counts])
    sides = np.concatenate(
        [
            start + np.stack([np.arange(count), np.roll(np.arange(count), -1)], axis=1)
            for start, count in zip(first, counts, strict=False)
        ]
    )
    points = np.concatenate([line.points for line in lines])
    cells = np.concatenate([line.cells for line in lines])
    heights = walkable.heights[cells[:, 0], cells[:, 1]].astype(np.float64)
    plane = points * walkable.cell_m + np.array(walkable.origin)
    vertices, triangles = fill(np.column_stack([plane, heights]), sides)
    return PolygonMesh.of(vertices, join(vertices, triangles))
