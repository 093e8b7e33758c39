"""Islands of a navigation mesh: connected polygons, counted as by habitat-sim."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int32

from hypernav.worlds.navmesh.detour.island_kernels import label_islands
from hypernav.worlds.navmesh.detour.mesh import Mesh, polygon_areas

_LEAST_AREA_M2 = 1e-5
"""habitat-sim makes smaller polygons not walkable, because searches there crash."""


@dataclass(frozen=True, eq=False)
class Islands:
    """The islands of a mesh, in the order of their first polygons.

    Attributes:
        of_polygon: Island of every polygon.
        areas_m2: Area of every island that can be walked on.
        radii_m: Greatest distance of a corner of its polygons from their mean, of every island.
    """

    of_polygon: Int32[np.ndarray, " p"]
    areas_m2: Float64[np.ndarray, " i"]
    radii_m: Float64[np.ndarray, " i"]


def find_islands(mesh: Mesh) -> tuple[Islands, Mesh]:
    """Count the islands, and close polygons that are too small to walk on.

    Returns:
        The islands, and the mesh without those polygons. Islands are counted first, as in
        habitat-sim, so removing a polygon may leave an island in two parts.
    """
    of_polygon = label_islands(mesh)
    count = int(of_polygon.max()) + 1
    areas = polygon_areas(mesh)
    walkable = mesh.walkable & (areas >= _LEAST_AREA_M2)
    used = np.arange(mesh.corners.shape[1]) < mesh.corner_count[:, None]
    corners = mesh.vertices[mesh.corners[used]].astype(np.float64)
    island = np.repeat(of_polygon, mesh.corner_count)
    sizes = np.bincount(island, minlength=count)
    means = np.stack(
        [np.bincount(island, corners[:, axis], minlength=count) / sizes for axis in range(3)],
        axis=1,
    )
    radii = np.zeros(count)
    np.maximum.at(radii, island, np.linalg.norm(corners - means[island], axis=1))
    areas_m2 = np.bincount(of_polygon, np.where(walkable, areas, 0.0), minlength=count)
    return Islands(of_polygon, areas_m2, radii), mesh._replace(walkable=walkable)
