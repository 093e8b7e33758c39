"""A navigation mesh in memory: one set of arrays over all tiles, for the kernels.

Links between polygons are those that Detour makes when it loads tiles: ``connectIntLinks`` of
``dtNavMesh`` joins polygons within a tile, ``connectExtLinks`` those on both sides of a border
between tiles. habitat-sim itself writes one tile for a building. Islands are connected polygons,
counted as by habitat-sim.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int32, UInt8, UInt16

from hypernav.simulator.worlds.navmesh.file_format import (
    EXTERNAL,
    VERTICES_PER_POLYGON,
    WALKABLE,
    NavmeshFile,
    NavmeshTile,
)
from hypernav.simulator.worlds.navmesh.navmesh_reader import expect
from hypernav.simulator.worlds.navmesh.recast_detour.detour_kernels import label_islands

WITHIN = 255
"""Side of a link within a tile."""
_TOWARDS = {0: (1, 0), 2: (0, 1), 4: (-1, 0), 6: (0, -1)}
_MOST_BORDER_EDGES = 20_000
"""Largest number of border edges; the time grows with its square. Buildings have some hundred."""
_MOST_CONNECTIONS = 4
_APART_M = np.float32(0.01)
"""Largest distance between borders of two tiles. Edges that only touch at an end are not joined."""
WALL = -1
"""Marks a missing neighbour."""
OTHER_TILE = -2
"""Marks an edge to another tile; the links give the neighbours."""
_LEAST_AREA_M2 = 1e-5
"""habitat-sim makes smaller polygons not walkable, because searches there crash."""


def links_between(
    tiles: Sequence[NavmeshTile], first: Sequence[int]
) -> tuple[Int32[np.ndarray, "_"], ...]:
    """The links between all polygons, polygon by polygon, in the order of Detour's search.

    Args:
        tiles: Tiles in the order in which they are loaded.
        first: Number of every tile's first polygon, over all tiles.

    Returns:
        ``link_start``, ``link_polygon``, ``link_edge``, ``link_side``, ``link_low`` and
        ``link_high`` of `Mesh`.

    Raises:
        NavmeshError: More edges lie on borders between tiles than in any building.
    """
    inner = np.concatenate(
        [_within(tile, start) for tile, start in zip(tiles, first, strict=True)], dtype=np.int32
    )
    outer = np.array(list(_across(tiles, first)), dtype=np.int32).reshape(-1, 6)
    # Detour puts each new link before the older ones; first come those within a tile, by edges.
    rank = np.concatenate([inner[:, 2], -1 - np.arange(len(outer), dtype=np.int32)])
    links = np.concatenate([inner, outer])
    links = links[np.lexsort((rank, links[:, 0]))]
    counts = np.bincount(links[:, 0], minlength=sum(len(tile.polygons) for tile in tiles))
    start = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
    return start, *np.ascontiguousarray(links[:, 1:].T)


def _within(tile: NavmeshTile, first: int) -> np.ndarray:
    """Rows of polygon, neighbour, edge, side, low and high."""
    neighbours = tile.polygons["neighbours"].astype(np.int32)
    used = np.arange(VERTICES_PER_POLYGON) < tile.polygons["vertex_count"][:, None]
    polygon, edge = np.nonzero(used & (neighbours != 0) & (neighbours & EXTERNAL == 0))
    nothing = np.zeros_like(polygon)
    return np.column_stack(
        [
            first + polygon,
            first + neighbours[polygon, edge] - 1,
            edge,
            nothing + WITHIN,
            nothing,
            nothing,
        ]
    )


class _Border(NamedTuple):
    """Edges of a tile that lead to other tiles.

    Attributes:
        polygon: Polygon of every edge, numbered within the tile.
        edge: Number of the edge in its polygon.
        side: Its direction.
        ends: Both ends, metres.
    """

    polygon: np.ndarray
    edge: np.ndarray
    side: np.ndarray
    ends: Float32[np.ndarray, "n 2 3"]

    @staticmethod
    def of(tile: NavmeshTile) -> "_Border":
        polygons = tile.polygons
        counts = polygons["vertex_count"].astype(np.int64)
        used = np.arange(VERTICES_PER_POLYGON) < counts[:, None]
        polygon, edge = np.nonzero(used & (polygons["neighbours"] & EXTERNAL != 0))
        after = (edge + 1) % counts[polygon]
        vertices = polygons["vertices"]
        ends = np.stack([vertices[polygon, edge], vertices[polygon, after]], axis=1)
        side = polygons["neighbours"][polygon, edge] & 0xFF
        return _Border(polygon, edge, side, tile.vertices[ends])


def _across(tiles: Sequence[NavmeshTile], first: Sequence[int]) -> Iterator[tuple[int, ...]]:
    """Rows as from `_within` for links between tiles, in the order in which Detour makes them."""
    borders = [_Border.of(tile) for tile in tiles]
    edges = sum(len(border.edge) for border in borders)
    expect(
        edges <= _MOST_BORDER_EDGES,
        f"expected at most {_MOST_BORDER_EDGES:,} edges between tiles, found {edges:,}",
    )
    if edges == 0:
        return
    room = [int(t.header["most_links"]) - len(_within(t, 0)) for t in tiles]
    for here, there, side in _meetings(tiles):
        border, target = borders[here], borders[there]
        for k in range(len(border.edge)):
            direction = int(border.side[k])
            if side not in (None, direction):
                continue
            for polygon, low, high in _connections(
                border.ends[k], direction, target, tiles[there].header["walkable_climb"]
            ):
                if room[here] == 0:
                    break
                room[here] -= 1
                yield (
                    first[here] + int(border.polygon[k]),
                    first[there] + polygon,
                    int(border.edge[k]),
                    direction,
                    low,
                    high,
                )


def _meetings(tiles: Sequence[NavmeshTile]) -> Iterator[tuple[int, int, int | None]]:
    """Pairs of tiles that may touch and the direction from the first; None for layers."""
    at: dict[tuple[int, int], list[int]] = {}
    for new, tile in enumerate(tiles):
        x, y = int(tile.header["x"]), int(tile.header["y"])
        for other in at.get((x, y), []):
            yield new, other, None
            yield other, new, None
        for side, (dx, dy) in _TOWARDS.items():
            for other in at.get((x + dx, y + dy), []):
                yield new, other, side
                yield other, new, (side + 4) % 8
        at.setdefault((x, y), []).insert(0, new)


def _connections(
    ends: Float32[np.ndarray, "2 3"], direction: int, target: _Border, climb: np.float32
) -> Iterator[tuple[int, int, int]]:
    """Polygons of a border that an edge touches, and the part of the edge, of 255."""
    across, along = (0, 2) if direction in (0, 4) else (2, 0)
    facing = target.side == (direction + 4) % 8
    close = np.abs(ends[0, across] - target.ends[:, 0, across]) <= _APART_M
    own = _slab(ends[None], along)[0]
    slabs = _slab(target.ends, along)
    touching = np.flatnonzero(facing & close & _overlap(own, slabs, climb))
    # One connection for every polygon.
    _, unique = np.unique(target.polygon[touching], return_index=True)
    length = ends[1, along] - ends[0, along]
    for k in touching[np.sort(unique)][:_MOST_CONNECTIONS]:
        span = np.array([max(own[0, 0], slabs[k, 0, 0]), min(own[1, 0], slabs[k, 1, 0])])
        parts = np.sort((span - ends[0, along]) / length)
        low, high = (np.clip(parts, 0.0, 1.0) * np.float32(255.0)).astype(np.uint8).tolist()
        yield int(target.polygon[k]), low, high


def _slab(ends: Float32[np.ndarray, "n 2 3"], along: int) -> Float32[np.ndarray, "n 2 2"]:
    """Edges as lower and upper end, each with its position along the border and its height."""
    flipped = ends[:, 0, along] >= ends[:, 1, along]
    ordered = np.where(flipped[:, None, None], ends[:, ::-1], ends)
    return ordered[:, :, [along, 1]]


def _overlap(
    a: Float32[np.ndarray, "2 2"], b: Float32[np.ndarray, "n 2 2"], climb: np.float32
) -> Bool[np.ndarray, " n"]:
    """Which edges an edge overlaps along the border, at a height that can be climbed."""
    low = np.maximum(a[0, 0] + _APART_M, b[:, 0, 0] + _APART_M)
    high = np.minimum(a[1, 0] - _APART_M, b[:, 1, 0] - _APART_M)
    with np.errstate(divide="ignore", invalid="ignore"):
        rise_a = (a[1, 1] - a[0, 1]) / (a[1, 0] - a[0, 0])
        rise_b = (b[:, 1, 1] - b[:, 0, 1]) / (b[:, 1, 0] - b[:, 0, 0])
        at_a = a[0, 1] - rise_a * a[0, 0]
        at_b = b[:, 0, 1] - rise_b * b[:, 0, 0]
        at_low = (rise_b * low + at_b) - (rise_a * low + at_a)
        at_high = (rise_b * high + at_b) - (rise_a * high + at_a)
        reach = np.square(climb * np.float32(2.0))
        meets = (at_low * at_high < 0.0) | (at_low**2 <= reach) | (at_high**2 <= reach)
    return (low <= high) & meets


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
        link_side: Direction of the tile that it leads to, `WITHIN` in the same tile.
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
    starts = [first_of[tile.index] for tile in file.tiles]
    link_start, link_polygon, link_edge, link_side, link_low, link_high = links_between(
        file.tiles, starts
    )
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
        link_start=link_start,
        link_polygon=link_polygon,
        link_edge=link_edge,
        link_side=link_side,
        link_low=link_low,
        link_high=link_high,
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


def find_islands(mesh: Mesh) -> tuple[Int32[np.ndarray, " p"], Float64[np.ndarray, " i"], Mesh]:
    """Count the islands, and close polygons that are too small to walk on.

    Returns:
        Island of every polygon, in the order of their first polygons; area of every island that can
        be walked on, square metres; and the mesh without those polygons. Islands are counted first,
        as in habitat-sim, so removing a polygon may leave an island in two parts.
    """
    of_polygon = label_islands(mesh)
    count = int(of_polygon.max()) + 1
    areas = polygon_areas(mesh)
    walkable = mesh.walkable & (areas >= _LEAST_AREA_M2)
    areas_m2 = np.bincount(of_polygon, np.where(walkable, areas, 0.0), minlength=count)
    return of_polygon, areas_m2, mesh._replace(walkable=walkable)
