"""Navigation mesh files for habitat-sim, written from polygons that share edges.

The tree in which Detour searches for polygons near a position is built as by ``createBVTree``.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64, UInt16

from hypernav.core.embodiment import BodyConfig
from hypernav.core.errors import NavmeshError
from hypernav.lab.datasets.habitat_format import positions_to_habitat
from hypernav.simulator.worlds.navmesh.file_format import (
    DETAIL_MESH,
    EXTERNAL,
    POLYGON,
    SET_HEADER,
    SET_MAGIC,
    TILE_ARRAYS,
    TILE_HEADER,
    TILE_MAGIC,
    TILE_REFERENCE,
    TILE_VERSION,
    TREE_NODE,
    VERTICES_PER_POLYGON,
    WALKABLE,
    settings_for,
)

_MOST_VERTICES = 0xFFFF
MOST_STEPS = 0xFFFF
"""Largest coordinate of a box."""
_LINK_BYTES = 12
_EDGE_FLAGS = (0b000001, 0b000100, 0b010000)
"""Flags of a detail triangle's edges that lie on the boundary of its polygon."""


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
            [self.polygons[owner, edge], self.polygons[owner, (edge + 1) % self.sizes[owner]]],
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


def search_tree(low: UInt16[np.ndarray, "p 3"], high: UInt16[np.ndarray, "p 3"]) -> np.ndarray:
    """Nodes of the tree, parents first: records of type `file_format.TREE_NODE`.

    Args:
        low: Lowest corner of every polygon's box, in steps from the lowest corner of the mesh.
        high: Its highest corner.
    """
    nodes: list[tuple[np.ndarray, np.ndarray, int]] = []
    # Each entry is a run of polygons, or the number of a node whose descendants are complete.
    waiting: list[np.ndarray | int] = [np.arange(len(low))]
    while waiting:
        run = waiting.pop()
        if isinstance(run, int):
            box_low, box_high, _ = nodes[run]
            nodes[run] = (box_low, box_high, run - len(nodes))
            continue
        box_low, box_high = low[run].min(axis=0), high[run].max(axis=0)
        nodes.append((box_low, box_high, int(run[0])))
        if len(run) > 1:
            axis = int(np.argmax(box_high - box_low))
            ordered = run[np.argsort(low[run, axis], kind="stable")]
            half = len(run) // 2
            waiting += [len(nodes) - 1, ordered[half:], ordered[:half]]
    return np.array(nodes, dtype=TREE_NODE)


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
    settings_bytes = b"" if settings is None else settings.tobytes()
    return whole.tobytes() + settings_bytes + reference.tobytes() + tile


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
