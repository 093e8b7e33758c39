"""Navigation meshes from triangles: one stage of Recast after the other."""

import math

import numpy as np
from jaxtyping import Float32, Int32

from hypernav.core.errors import NavmeshError
from hypernav.simulator.worlds.navmesh.file_format import (
    DETAIL_MESH,
    EXTERNAL,
    TILE_HEADER,
    TREE_NODE,
    robot_in_voxels,
)
from hypernav.simulator.worlds.navmesh.navmesh_writer import (
    MOST_STEPS,
    file_of_tile,
    polygon_records,
    search_tree,
)
from hypernav.simulator.worlds.navmesh.recast_detour.recast_contours import (
    join_holes,
    trace_contours,
)
from hypernav.simulator.worlds.navmesh.recast_detour.recast_detail import Sampling, detail_meshes
from hypernav.simulator.worlds.navmesh.recast_detour.recast_polygons import (
    Polygons,
    convex_polygons,
    neighbours,
)
from hypernav.simulator.worlds.navmesh.recast_detour.recast_regions import join_regions, watershed
from hypernav.simulator.worlds.navmesh.recast_detour.recast_voxels import (
    OpenSpace,
    drop_ledges,
    drop_low_ceilings,
    erode,
    keep_low_obstacles,
    open_space,
    rasterize,
    smooth_distances,
    walkable_triangles,
)

_MOST_COLUMNS = 100_000_000
_MOST_CORNERS = 0xFFFE


def compute_navmesh(
    vertices: Float32[np.ndarray, "v 3"], triangles: Int32[np.ndarray, "t 3"], settings: np.ndarray
) -> bytes:
    """The file of the navigation mesh that habitat-sim computes from the same triangles.

    Args:
        vertices: Positions in Habitat's frame, metres; they also set the bounds.
        triangles: Vertex numbers, counter-clockwise seen from the side that can be stood on. Where
            surfaces touch, their order counts.
        settings: Record of type `SETTINGS`, see `settings_for`.

    Returns:
        The content of the file; only its links are left to those who load it.

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
    cells = np.array([cell, cell_height])
    solid = rasterize(vertices, triangles, walkable, bounds, (depth, width), cells, climb)
    if settings["filter_low_hanging_obstacles"]:
        keep_low_obstacles(solid, climb)
    if settings["filter_ledge_spans"]:
        drop_ledges(solid, width, height, climb)
    if settings["filter_walkable_low_height_spans"]:
        drop_low_ceilings(solid, height)
    space = open_space(solid, width, height, climb)
    erode(space, radius)
    return space


def _regions_and_polygons(
    space: OpenSpace, settings: np.ndarray
) -> tuple[Int32[np.ndarray, " s"], Polygons]:
    distance, greatest = smooth_distances(space)
    regions, count = watershed(space, distance, greatest)
    least, mergeable = (int(settings[f"region_{name}_size"] ** 2) for name in ("min", "merge"))
    regions, count = join_regions(space, regions, count, least, mergeable)
    longest = int(settings["edge_max_len"] / settings["cell_size"])
    contours = join_holes(
        trace_contours(space, regions, np.float32(settings["edge_max_error"]), longest)
    )
    corners = sum(len(contour.corners) for contour in contours)
    if corners >= _MOST_CORNERS:
        raise NavmeshError(
            f"expected a mesh with less than {_MOST_CORNERS:,} corners, found {corners:,}; "
            "choose larger cells"
        )
    polygons = convex_polygons(contours)
    if not 0 < len(polygons.corners) < EXTERNAL:
        raise NavmeshError(
            f"expected a mesh of up to {EXTERNAL - 1:,} polygons, found {len(polygons.corners):,}; "
            "is there a floor that the robot fits on, and is the scene the right way up?"
        )
    return regions, polygons


def _file(
    space: OpenSpace,
    regions: Int32[np.ndarray, " s"],
    polygons: Polygons,
    settings: np.ndarray,
    bounds: Float32[np.ndarray, "2 3"],
) -> bytes:
    cell, cell_height = settings["cell_size"][()], settings["cell_height"][()]
    sampling = Sampling(
        cell=np.float32(cell),
        cell_height=np.float32(cell_height),
        spacing=np.float32(cell * settings["detail_sample_dist"]),
        most_error=np.float32(cell_height * settings["detail_sample_max_error"]),
        reach=max(1, math.ceil(settings["edge_max_error"])),
    )
    meshes = detail_meshes(space, regions, polygons, bounds[0], sampling)
    own = (polygons.corners >= 0).sum(axis=1)
    extra = np.array([len(mesh.points) for mesh in meshes]) - own
    faces = np.array([len(mesh.triangles) for mesh in meshes])
    details = np.zeros(len(own), DETAIL_MESH)
    details["vertex_base"] = np.cumsum(extra) - extra
    details["vertex_count"], details["triangle_count"] = extra, faces
    details["triangle_base"] = np.cumsum(faces) - faces
    header = np.zeros((), TILE_HEADER)
    header["walkable_height"] = settings["agent_height"]
    header["walkable_radius"] = settings["agent_radius"]
    header["walkable_climb"] = settings["agent_max_climb"]
    header["lowest"], header["highest"] = bounds
    header["highest"][1] += np.float32(robot_in_voxels(settings)[0]) * cell_height
    header["quantisation"] = np.float32(1.0) / cell
    scale = np.array([cell, cell_height, cell], dtype=np.float32)
    low, high = (
        ((np.stack(corner) - bounds[0]) * header["quantisation"])
        .clip(0, MOST_STEPS)
        .astype(np.uint16)
        for corner in zip(
            *((m.points.min(axis=0), m.points.max(axis=0)) for m in meshes), strict=True
        )
    )
    arrays = {
        "vertices": bounds[0] + polygons.vertices.astype(np.float32) * scale,
        "polygons": polygon_records(polygons.corners, neighbours(polygons.corners)),
        "details": details,
        "detail_vertices": np.concatenate(
            [mesh.points[corners:] for mesh, corners in zip(meshes, own, strict=True)]
        ),
        "detail_triangles": np.concatenate([mesh.triangles for mesh in meshes]),
        # Detour leaves room for one node more than it needs.
        "tree": np.concatenate([search_tree(low, high), np.zeros(1, TREE_NODE)]),
    }
    return file_of_tile(header, arrays, settings)
