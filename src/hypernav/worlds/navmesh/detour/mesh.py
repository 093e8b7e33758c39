"""A navigation mesh in memory: one set of arrays over all tiles, for the kernels."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int32, UInt8, UInt16

from hypernav.worlds.navmesh.detour.tile_links import links_between
from hypernav.worlds.navmesh.files.file_format import (
    EXTERNAL,
    WALKABLE,
    NavmeshFile,
    NavmeshTile,
)

WALL = -1
"""Marks a missing neighbour."""
OTHER_TILE = -2
"""Marks an edge to another tile; the links give the neighbours."""


class Mesh(NamedTuple):
    """Polygons, links between them, heights on them and the search trees, over all tiles.

    Attributes:
        vertices: Corners of polygons and vertices of detail meshes, Habitat's frame, metres.
        corners: Vertices of every polygon, counter-clockwise seen from above; only the first
            `corner_count` are used.
        corner_count: Number of corners of every polygon.
        neighbours: Polygon behind every edge, `WALL` or `OTHER_TILE`.
        walkable: Whether an agent may be on a polygon.
        link_start: First link of every polygon, and the number of links.
        link_polygon: Polygon that a link leads to.
        link_edge: Edge that it leads over.
        link_side: Direction of the tile that it leads to, `tile_links.WITHIN` in the same tile.
        link_low: Where on the edge it begins, 0 to 255.
        link_high: Where on the edge it ends, 0 to 255.
        triangle_start: First detail triangle of every polygon, and the number of triangles.
        triangles: Vertices of every detail triangle.
        triangle_flags: Two bits for each edge; the lower one says that it lies on the boundary.
        tile_x: Column of every tile; tiles by rows and columns.
        tile_y: Row of every tile.
        tile_low: Lowest corner of every tile, metres.
        tile_high: Highest corner of every tile, metres.
        tile_climb: Height that an agent climbs, metres.
        tile_quantisation: Steps of the tree's boxes per metre.
        tile_polygon: First polygon of every tile.
        tile_node: First node of every tile's tree, and the number of nodes.
        node_low: Lowest corner of every node's box, steps from the tile's.
        node_high: Highest corner of every node's box, steps from the tile's.
        node_index: Polygon of a leaf, or minus the number of nodes below an inner node.
        grid: Origin x and z and the sides of the tiles, metres.
    """

    vertices: Float32[np.ndarray, "v 3"]
    corners: Int32[np.ndarray, "p 6"]
    corner_count: Int32[np.ndarray, " p"]
    neighbours: Int32[np.ndarray, "p 6"]
    walkable: Bool[np.ndarray, " p"]
    link_start: Int32[np.ndarray, "starts"]
    link_polygon: Int32[np.ndarray, " l"]
    link_edge: Int32[np.ndarray, " l"]
    link_side: Int32[np.ndarray, " l"]
    link_low: Int32[np.ndarray, " l"]
    link_high: Int32[np.ndarray, " l"]
    triangle_start: Int32[np.ndarray, "starts"]
    triangles: Int32[np.ndarray, "t 3"]
    triangle_flags: UInt8[np.ndarray, " t"]
    tile_x: Int32[np.ndarray, " n"]
    tile_y: Int32[np.ndarray, " n"]
    tile_low: Float32[np.ndarray, "n 3"]
    tile_high: Float32[np.ndarray, "n 3"]
    tile_climb: Float32[np.ndarray, " n"]
    tile_quantisation: Float32[np.ndarray, " n"]
    tile_polygon: Int32[np.ndarray, " n"]
    tile_node: Int32[np.ndarray, "starts"]
    node_low: UInt16[np.ndarray, "m 3"]
    node_high: UInt16[np.ndarray, "m 3"]
    node_index: Int32[np.ndarray, " m"]
    grid: Float32[np.ndarray, "4"]


def mesh_of(file: NavmeshFile) -> Mesh:
    """Join the tiles of a file.

    Raises:
        NavmeshError: Too many edges lie on borders between its tiles.
    """
    tiles = sorted(file.tiles, key=lambda tile: tile.index)
    first = _starts([len(tile.polygons) for tile in tiles]).tolist()
    first_of = {tile.index: start for tile, start in zip(tiles, first, strict=False)}
    links = links_between(file.tiles, [first_of[tile.index] for tile in file.tiles])
    bases = _starts([len(t.vertices) + len(t.detail_vertices) for t in tiles]).tolist()
    parts = [_polygons(*known) for known in zip(tiles, bases, first, strict=False)]
    corners, neighbours, triangles, flags = (
        np.concatenate(part) for part in zip(*parts, strict=True)
    )
    # Detour visits the tiles of a row one after the other, the latest layer first.
    latest = {tile.index: -number for number, tile in enumerate(file.tiles)}
    ordered = sorted(tiles, key=lambda t: (int(t.header["y"]), int(t.header["x"]), latest[t.index]))
    nodes = np.concatenate([tile.tree for tile in ordered])
    polygons = np.concatenate([tile.polygons for tile in tiles])
    return Mesh(
        vertices=np.concatenate([v for t in tiles for v in (t.vertices, t.detail_vertices)]),
        corners=corners,
        corner_count=polygons["vertex_count"].astype(np.int32),
        neighbours=neighbours,
        walkable=(polygons["flags"] & WALKABLE) != 0,
        link_start=links.start,
        link_polygon=links.polygon,
        link_edge=links.edge,
        link_side=links.side,
        link_low=links.low,
        link_high=links.high,
        triangle_start=_starts(np.concatenate([t.details["triangle_count"] for t in tiles])),
        triangles=triangles,
        triangle_flags=flags,
        tile_x=_of_headers(ordered, "x"),
        tile_y=_of_headers(ordered, "y"),
        tile_low=_of_headers(ordered, "lowest"),
        tile_high=_of_headers(ordered, "highest"),
        tile_climb=_of_headers(ordered, "walkable_climb"),
        tile_quantisation=_of_headers(ordered, "quantisation"),
        tile_polygon=np.array([first_of[tile.index] for tile in ordered], dtype=np.int32),
        tile_node=_starts([len(tile.tree) for tile in ordered]),
        node_low=np.ascontiguousarray(nodes["lowest"]),
        node_high=np.ascontiguousarray(nodes["highest"]),
        node_index=np.ascontiguousarray(nodes["index"]),
        grid=np.array(
            [
                file.header["origin"][0],
                file.header["origin"][2],
                file.header["tile_width"],
                file.header["tile_height"],
            ],
            dtype=np.float32,
        ),
    )


def polygon_areas(mesh: Mesh) -> Float64[np.ndarray, " p"]:
    """Area of every polygon's surface in space, the sum of its detail triangles, square metres."""
    vertices = mesh.vertices[mesh.triangles].astype(np.float64)
    sides = vertices[:, 1:] - vertices[:, :-1]
    areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) / 2.0
    sums = np.concatenate([[0.0], np.cumsum(areas)])
    return np.diff(sums[mesh.triangle_start])


def _starts(counts: Sequence[int] | np.ndarray) -> Int32[np.ndarray, "starts"]:
    """Where each of several runs begins, and where the last one ends."""
    return np.concatenate([[0], np.cumsum(counts, dtype=np.int64)]).astype(np.int32)


def _of_headers(tiles: list[NavmeshTile], field: str) -> np.ndarray:
    return np.array([tile.header[field] for tile in tiles])


def _polygons(tile: NavmeshTile, base: int, first: int) -> tuple[np.ndarray, ...]:
    """Corners and neighbours of a tile's polygons, their triangles, and the triangles' flags."""
    polygons, details = tile.polygons, tile.details
    corners = polygons["vertices"].astype(np.int32) + base
    edges = polygons["neighbours"].astype(np.int32)
    neighbours = np.where(
        edges & EXTERNAL != 0, OTHER_TILE, np.where(edges == 0, WALL, first + edges - 1)
    ).astype(np.int32)
    counts = details["triangle_count"].astype(np.int64)
    owner = np.repeat(np.arange(len(details)), counts)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    chosen = tile.detail_triangles[details["triangle_base"][owner] + number]
    local = chosen[:, :3].astype(np.int64)
    own = polygons["vertex_count"][owner][:, None].astype(np.int64)
    further = base + len(tile.vertices) + details["vertex_base"][owner][:, None] + local - own
    of_polygon = np.take_along_axis(corners[owner], np.minimum(local, own - 1), axis=1)
    triangles = np.where(local < own, of_polygon, further).astype(np.int32)
    return corners, neighbours, triangles, np.ascontiguousarray(chosen[:, 3])
