"""Navigation mesh files for habitat-sim."""

import numpy as np
from jaxtyping import Float32, Int64

from hypernav.core.embodiment import BodyConfig
from hypernav.datasets.habitat_frames import positions_to_habitat
from hypernav.worlds.navmesh.files.file_format import (
    DETAIL_MESH,
    POLYGON,
    SET_HEADER,
    SET_MAGIC,
    SETTINGS,
    TILE_HEADER,
    TILE_MAGIC,
    TILE_REFERENCE,
    TILE_VERSION,
    WALKABLE,
)
from hypernav.worlds.navmesh.files.polygon_mesh import PolygonMesh
from hypernav.worlds.navmesh.files.search_tree import search_tree

_LINK_BYTES = 12
_CELL_HEIGHT_M, _CLIMB_M, _SLOPE_DEG = 0.2, 0.2, 45.0
"""What habitat-sim computes its meshes with (``NavMeshSettings::setDefaults``)."""

_EDGE_FLAGS = (0b000001, 0b000100, 0b010000)
"""Flags of a detail triangle's edges that lie on the boundary of its polygon."""


def navmesh_bytes(
    mesh: PolygonMesh, body: BodyConfig, *, cell_m: float = 0.05, version: int = 2
) -> bytes:
    """The content of a file that habitat-sim takes as computed by itself.

    habitat-sim throws a mesh away and computes its own if the settings of the file differ in
    anything from those that it would compute with. So the file states these, whatever the mesh was
    made with: its defaults, with the radius and the height of its robot.

    Args:
        mesh: Polygons on which the middle of the robot may be.
        body: Robot as Habitat is configured for it; radius and height have to be the same there.
        cell_m: Accuracy of the mesh, metres.
        version: Version of the format, 1 or 2.
    """
    vertices = positions_to_habitat(mesh.vertices).astype(np.float32)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    header = np.zeros((), SET_HEADER)
    header["magic"], header["version"], header["tiles"] = SET_MAGIC, version, 1
    header["origin"] = low
    header["tile_width"], header["tile_height"] = high[0] - low[0], high[2] - low[2]
    header["most_tiles"], header["most_polygons"] = 1, len(mesh.polygons)
    tile = _tile_bytes(mesh, vertices, body, np.float32(1.0 / cell_m))
    reference = np.zeros((), TILE_REFERENCE)
    reference["reference"] = 1 << (len(mesh.polygons) - 1).bit_length()
    reference["size"] = len(tile)
    settings = _settings(body, cell_m).tobytes() if version > 1 else b""
    return header.tobytes() + settings + reference.tobytes() + tile


def _settings(body: BodyConfig, cell_m: float) -> np.ndarray:
    """The settings that habitat-sim would compute a mesh for this robot with."""
    settings = np.zeros((), SETTINGS)
    settings["cell_size"], settings["cell_height"] = cell_m, _CELL_HEIGHT_M
    settings["agent_height"], settings["agent_radius"] = body.height_m, body.radius_m
    settings["agent_max_climb"], settings["agent_max_slope"] = _CLIMB_M, _SLOPE_DEG
    settings["region_min_size"] = settings["region_merge_size"] = 20.0
    settings["edge_max_len"], settings["edge_max_error"] = 12.0, 1.3
    settings["verts_per_poly"] = POLYGON["vertices"].shape[0]
    settings["detail_sample_dist"], settings["detail_sample_max_error"] = 6.0, 1.0
    for name in ("low_hanging_obstacles", "ledge_spans", "walkable_low_height_spans"):
        settings[f"filter_{name}"] = 1
    return settings


def _tile_bytes(
    mesh: PolygonMesh,
    vertices: Float32[np.ndarray, "v 3"],
    body: BodyConfig,
    quantisation: np.float32,
) -> bytes:
    sizes = mesh.sizes
    polygons = np.zeros(len(mesh.polygons), POLYGON)
    polygons["first_link"] = 0xFFFFFFFF
    polygons["vertices"] = np.maximum(mesh.polygons, 0)
    polygons["neighbours"] = mesh.neighbours() + 1
    polygons["flags"], polygons["vertex_count"] = WALKABLE, sizes
    details = np.zeros(len(polygons), DETAIL_MESH)
    details["triangle_count"] = sizes - 2
    details["triangle_base"] = np.cumsum(sizes - 2) - (sizes - 2)
    triangles = _fans(sizes)
    tree = search_tree(mesh, vertices, quantisation)
    links = int(sizes.sum())
    header = np.zeros((), TILE_HEADER)
    header["magic"], header["version"] = TILE_MAGIC, TILE_VERSION
    header["polygons"] = header["detail_meshes"] = header["off_mesh_base"] = len(polygons)
    header["vertices"], header["most_links"] = len(vertices), links
    header["detail_triangles"], header["tree_nodes"] = len(triangles), len(tree)
    header["walkable_height"], header["walkable_radius"] = body.height_m, body.radius_m
    header["walkable_climb"] = body.max_step_m
    header["lowest"], header["highest"] = vertices.min(axis=0), vertices.max(axis=0)
    header["quantisation"] = quantisation
    parts = (header, vertices, polygons, bytes(links * _LINK_BYTES), details, triangles, tree)
    return b"".join(part if isinstance(part, bytes) else part.tobytes() for part in parts)


def _fans(sizes: Int64[np.ndarray, " p"]) -> np.ndarray:
    """Detail triangles of polygons of so many corners: three corners and the flags of the edges."""
    triangles = []
    for size in sizes.tolist():
        for k in range(1, size - 1):
            flags = _EDGE_FLAGS[1]
            flags |= _EDGE_FLAGS[0] if k == 1 else 0
            flags |= _EDGE_FLAGS[2] if k == size - 2 else 0
            triangles.append((0, k, k + 1, flags))
    return np.array(triangles, dtype=np.uint8)
