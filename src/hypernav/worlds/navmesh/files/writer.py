"""Navigation mesh files for habitat-sim."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Int64

from hypernav.core.embodiment import BodyConfig
from hypernav.datasets.habitat_frames import positions_to_habitat
from hypernav.worlds.navmesh.files.file_format import (
    DETAIL_MESH,
    POLYGON,
    SET_HEADER,
    SET_MAGIC,
    TILE_ARRAYS,
    TILE_HEADER,
    TILE_MAGIC,
    TILE_REFERENCE,
    TILE_VERSION,
    WALKABLE,
)
from hypernav.worlds.navmesh.files.polygon_mesh import PolygonMesh
from hypernav.worlds.navmesh.files.search_tree import MOST_STEPS, search_tree
from hypernav.worlds.navmesh.files.settings import settings_for

_LINK_BYTES = 12

_EDGE_FLAGS = (0b000001, 0b000100, 0b010000)
"""Flags of a detail triangle's edges that lie on the boundary of its polygon."""


def navmesh_bytes(
    mesh: PolygonMesh, body: BodyConfig, *, cell_m: float = 0.05, version: int = 2
) -> bytes:
    """The content of a file that habitat-sim accepts as computed by itself.

    habitat-sim discards a mesh and computes its own if any setting in the file differs from those
    that it would use. So the file states habitat-sim's defaults with the radius and the height of
    its robot, however the mesh was made.

    Args:
        mesh: Polygons on which the middle of the robot may be.
        body: Robot; Habitat has to be configured with the same radius and height.
        cell_m: Accuracy of the mesh, metres.
        version: Version of the format, 1 or 2.
    """
    vertices = positions_to_habitat(mesh.vertices).astype(np.float32)
    sizes = mesh.sizes
    details = np.zeros(len(sizes), DETAIL_MESH)
    details["triangle_count"] = sizes - 2
    details["triangle_base"] = np.cumsum(sizes - 2) - (sizes - 2)
    header = np.zeros((), TILE_HEADER)
    header["walkable_height"], header["walkable_radius"] = body.height_m, body.radius_m
    header["walkable_climb"] = body.max_step_m
    header["lowest"], header["highest"] = vertices.min(axis=0), vertices.max(axis=0)
    header["quantisation"] = np.float32(1.0 / cell_m)
    steps = (vertices - vertices.min(axis=0)) * header["quantisation"]
    corners = np.where(mesh.polygons >= 0, mesh.polygons, mesh.polygons[:, :1])
    low = np.clip(np.floor(steps[corners].min(axis=1)), 0, MOST_STEPS).astype(np.uint16)
    high = np.clip(np.ceil(steps[corners].max(axis=1)), 0, MOST_STEPS).astype(np.uint16)
    arrays = {
        "vertices": vertices,
        "polygons": polygon_records(mesh.polygons, mesh.neighbours()),
        "details": details,
        "detail_vertices": np.zeros((0, 3), dtype=np.float32),
        "detail_triangles": _fans(sizes),
        "tree": search_tree(low, high),
    }
    return file_of_tile(header, arrays, settings_for(body, cell_m) if version > 1 else None)


def file_of_tile(
    header: np.ndarray, arrays: Mapping[str, np.ndarray], settings: np.ndarray | None
) -> bytes:
    """The content of a file of one tile.

    Args:
        header: Record of type `TILE_HEADER` with the robot, the bounds and the steps of the tree;
            the rest is filled in.
        arrays: The arrays of `TILE_ARRAYS` except links.
        settings: What the mesh was computed with; None for version 1 of the format.
    """
    polygons = arrays["polygons"]
    links = int(polygons["vertex_count"].sum())
    header["magic"], header["version"] = TILE_MAGIC, TILE_VERSION
    for array in TILE_ARRAYS:
        header[array.length] = links if array.name == "links" else len(arrays[array.name])
    header["off_mesh_base"] = len(polygons)
    content = {"links": bytes(links * _LINK_BYTES)} | {k: v.tobytes() for k, v in arrays.items()}
    tile = header.tobytes() + b"".join(content[array.name] for array in TILE_ARRAYS)
    whole = np.zeros((), SET_HEADER)
    whole["magic"], whole["tiles"] = SET_MAGIC, 1
    whole["version"] = 1 if settings is None else 2
    whole["origin"] = header["lowest"]
    sides = header["highest"] - header["lowest"]
    whole["tile_width"], whole["tile_height"] = sides[0], sides[2]
    whole["most_tiles"], whole["most_polygons"] = 1, len(polygons)
    reference = np.zeros((), TILE_REFERENCE)
    reference["reference"] = 1 << (len(polygons) - 1).bit_length()
    reference["size"] = len(tile)
    told = b"" if settings is None else settings.tobytes()
    return whole.tobytes() + told + reference.tobytes() + tile


def polygon_records(
    polygons: Int64[np.ndarray, "p 6"], neighbours: Int64[np.ndarray, "p 6"]
) -> np.ndarray:
    """Records of type `POLYGON`.

    Args:
        polygons: Corners of every polygon, padded with -1.
        neighbours: Polygon behind every edge, -1 where there is none.
    """
    records = np.zeros(len(polygons), POLYGON)
    records["first_link"] = 0xFFFFFFFF
    records["vertices"] = np.maximum(polygons, 0)
    records["neighbours"] = neighbours + 1
    records["flags"], records["vertex_count"] = WALKABLE, (polygons >= 0).sum(axis=1)
    return records


def _fans(sizes: Int64[np.ndarray, " p"]) -> np.ndarray:
    """Detail triangles of polygons with a number of corners: three corners and the edge flags."""
    triangles = []
    for size in sizes.tolist():
        for k in range(1, size - 1):
            flags = _EDGE_FLAGS[1]
            flags |= _EDGE_FLAGS[0] if k == 1 else 0
            flags |= _EDGE_FLAGS[2] if k == size - 2 else 0
            triangles.append((0, k, k + 1, flags))
    return np.array(triangles, dtype=np.uint8)
