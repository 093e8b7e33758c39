"""Links between the polygons of a navigation mesh, as Detour makes them when it loads tiles.

``dtNavMesh::connectIntLinks`` joins polygons within a tile, ``connectExtLinks`` those on both sides
of a border between tiles. habitat-sim itself writes one tile for a building.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float32, Int32

from hypernav.worlds.navmesh.files.checks import expect
from hypernav.worlds.navmesh.files.file_format import EXTERNAL, VERTICES_PER_POLYGON, NavmeshTile

WITHIN = 255
"""Side of a link within a tile."""
_TOWARDS = {0: (1, 0), 2: (0, 1), 4: (-1, 0), 6: (0, -1)}
_MOST_BORDER_EDGES = 20_000
"""Largest number of border edges; the time grows with its square. Buildings have some hundred."""
_MOST_CONNECTIONS = 4
_APART_M = np.float32(0.01)
"""Largest distance between borders of two tiles. Edges that only touch at an end are not joined."""


class Links(NamedTuple):
    """Steps from polygons to their neighbours, polygon by polygon, in the order of Detour's search.

    Attributes:
        start: First link of every polygon, and the number of links.
        polygon: Polygon that a link leads to.
        edge: Edge that it leads over.
        side: Direction of the tile that it leads to, `WITHIN` in the same tile.
        low: Where on the edge it begins, 0 to 255.
        high: Where on the edge it ends, 0 to 255.
    """

    start: Int32[np.ndarray, "starts"]
    polygon: Int32[np.ndarray, " l"]
    edge: Int32[np.ndarray, " l"]
    side: Int32[np.ndarray, " l"]
    low: Int32[np.ndarray, " l"]
    high: Int32[np.ndarray, " l"]


def links_between(tiles: Sequence[NavmeshTile], first: Sequence[int]) -> Links:
    """The links between all polygons.

    Args:
        tiles: Tiles in the order in which they are loaded.
        first: Number of every tile's first polygon, over all tiles.

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
    return Links(start, *np.ascontiguousarray(links[:, 1:].T))


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
