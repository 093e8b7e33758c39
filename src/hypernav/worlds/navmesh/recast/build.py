"""Navigation meshes from triangles: runs the stages of Recast."""

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Int32, Int64

from hypernav.core.errors import NavmeshError
from hypernav.worlds.navmesh.files.file_format import DETAIL_MESH, EXTERNAL, TILE_HEADER, TREE_NODE
from hypernav.worlds.navmesh.files.search_tree import MOST_STEPS, search_tree
from hypernav.worlds.navmesh.files.settings import robot_in_voxels
from hypernav.worlds.navmesh.files.writer import file_of_tile, polygon_records
from hypernav.worlds.navmesh.recast.contour_kernels import trace_contours
from hypernav.worlds.navmesh.recast.detail_kernels import detail_meshes
from hypernav.worlds.navmesh.recast.filter_kernels import (
    drop_ledges,
    drop_low_ceilings,
    keep_low_obstacles,
)
from hypernav.worlds.navmesh.recast.hole_kernels import join_holes
from hypernav.worlds.navmesh.recast.open_space_kernels import (
    OpenSpace,
    erode,
    open_space,
    smooth_distances,
)
from hypernav.worlds.navmesh.recast.polygon_kernels import convex_polygons, neighbours
from hypernav.worlds.navmesh.recast.rasterization_kernels import rasterize, walkable_triangles
from hypernav.worlds.navmesh.recast.region_kernels import join_regions
from hypernav.worlds.navmesh.recast.watershed_kernels import watershed

_MOST_COLUMNS = 100_000_000
_MOST_CORNERS = 0xFFFE


class _Polygons(NamedTuple):
    """Polygons of Recast.

    Attributes:
        vertices: Column x, height in voxels, column z.
        corners: Vertices of every polygon, padded with -1.
        regions: Region of every polygon.
    """

    vertices: Int64[np.ndarray, "v 3"]
    corners: Int64[np.ndarray, "p 6"]
    regions: Int64[np.ndarray, " p"]


def compute_navmesh(
    vertices: Float32[np.ndarray, "v 3"], triangles: Int32[np.ndarray, "t 3"], settings: np.ndarray
) -> bytes:
    """The file of the navigation mesh that habitat-sim computes from the same triangles.

    Args:
        vertices: Positions in Habitat's frame, metres; they also set the bounds.
        triangles: Vertex numbers, counter-clockwise seen from the walkable side. Where surfaces
            touch, the order of triangles matters.
        settings: Record of type `SETTINGS`, see `settings_for`.

    Returns:
        The content of the file; only its links are made at loading.

    Raises:
        NavmeshError: There is nothing to walk on, or more than a mesh can hold.
    """
    bounds = np.stack([vertices.min(axis=0), vertices.max(axis=0)])
    space = _walkable_space(vertices, triangles, settings, bounds)
    regions, polygons = _regions_and_polygons(space, settings)
    return _file(space, regions, polygons, settings, bounds)


def _walkable_space(
    vertices: Float32[np.ndarray, "v 3"],
    triangles: Int32[np.ndarray, "t 3"],
    settings: np.ndarray,
    bounds: Float32[np.ndarray, "2 3"],
) -> OpenSpace:
    cell, cell_height = settings["cell_size"][()], settings["cell_height"][()]
    height, climb, radius = robot_in_voxels(settings)
    width, _, depth = ((bounds[1] - bounds[0]) / cell + np.float32(0.5)).astype(np.int64).tolist()
    if not 0 < width * depth <= _MOST_COLUMNS:
        raise NavmeshError(
            f"expected a scene of up to {_MOST_COLUMNS:,} columns of {cell:g} m, found "
            f"{width:,} × {depth:,}; are its units metres?"
        )
    slope = settings["agent_max_slope"] / np.float32(180.0) * np.float32(math.pi)
    walkable = walkable_triangles(vertices, triangles, np.float32(math.cos(slope)))
    start, solid = rasterize(
        vertices, triangles, walkable, bounds, width, depth, cell, cell_height, climb
    )
    if settings["filter_low_hanging_obstacles"]:
        keep_low_obstacles(start, solid, climb)
    if settings["filter_ledge_spans"]:
        drop_ledges(start, solid, width, height, climb)
    if settings["filter_walkable_low_height_spans"]:
        drop_low_ceilings(start, solid, height)
    space = open_space(start, solid, width, height, climb)
    erode(space, radius)
    return space


def _regions_and_polygons(
    space: OpenSpace, settings: np.ndarray
) -> tuple[Int32[np.ndarray, " s"], _Polygons]:
    distance, greatest = smooth_distances(space)
    regions, count = watershed(space, distance, greatest)
    least, mergeable = (int(settings[f"region_{name}_size"] ** 2) for name in ("min", "merge"))
    count = join_regions(space, regions, count, least, mergeable)
    longest = int(settings["edge_max_len"] / settings["cell_size"])
    corners, start, owner = trace_contours(space, regions, settings["edge_max_error"][()], longest)
    corners, begin, length = join_holes(corners, start, owner, count)
    if length.sum() >= _MOST_CORNERS:
        raise NavmeshError(
            f"expected a mesh with less than {_MOST_CORNERS:,} corners, found {length.sum():,}; "
            "choose larger cells"
        )
    polygons = _Polygons(*convex_polygons(corners, begin, length, owner))
    if not 0 < len(polygons.corners) < EXTERNAL:
        raise NavmeshError(
            f"expected a mesh of up to {EXTERNAL - 1:,} polygons, found {len(polygons.corners):,}; "
            "is there a floor that the robot fits on, and is the scene the right way up?"
        )
    return regions, polygons


def _file(
    space: OpenSpace,
    regions: Int32[np.ndarray, " s"],
    polygons: _Polygons,
    settings: np.ndarray,
    bounds: Float32[np.ndarray, "2 3"],
) -> bytes:
    cell, cell_height = settings["cell_size"][()], settings["cell_height"][()]
    spacing = cell * settings["detail_sample_dist"]
    error = cell_height * settings["detail_sample_max_error"]
    reach = max(1, math.ceil(settings["edge_max_error"]))
    points, point_start, triangles, triangle_start = detail_meshes(
        space, regions, *polygons, bounds[0], cell, cell_height, spacing, (error, reach)
    )
    own = (polygons.corners >= 0).sum(axis=1)
    extra = np.diff(point_start) - own
    details = np.zeros(len(own), DETAIL_MESH)
    details["vertex_base"] = np.cumsum(extra) - extra
    details["vertex_count"], details["triangle_base"] = extra, triangle_start[:-1]
    details["triangle_count"] = np.diff(triangle_start)
    is_extra = np.arange(len(points)) >= np.repeat(point_start[:-1] + own, np.diff(point_start))
    header = np.zeros((), TILE_HEADER)
    header["walkable_height"] = settings["agent_height"]
    header["walkable_radius"] = settings["agent_radius"]
    header["walkable_climb"] = settings["agent_max_climb"]
    header["lowest"], header["highest"] = bounds
    header["highest"][1] += np.float32(robot_in_voxels(settings)[0]) * cell_height
    header["quantisation"] = np.float32(1.0) / cell
    scale = np.array([cell, cell_height, cell], dtype=np.float32)
    steps = np.clip((points - bounds[0]) * header["quantisation"], 0, MOST_STEPS).astype(np.uint16)
    low = np.minimum.reduceat(steps, point_start[:-1])
    high = np.maximum.reduceat(steps, point_start[:-1])
    arrays = {
        "vertices": bounds[0] + polygons.vertices.astype(np.float32) * scale,
        "polygons": polygon_records(
            polygons.corners, neighbours(polygons.corners, len(polygons.vertices))
        ),
        "details": details,
        "detail_vertices": points[is_extra],
        "detail_triangles": triangles,
        # Detour reserves space for one node more than it needs.
        "tree": np.concatenate([search_tree(low, high), np.zeros(1, TREE_NODE)]),
    }
    return file_of_tile(header, arrays, settings)
