"""Checks of a navigation mesh before it is used, because a file may hold anything."""

import numpy as np

from hypernav.core.errors import NavmeshError
from hypernav.worlds.navmesh.files.file_format import (
    EXTERNAL,
    SIDES,
    VERTICES_PER_POLYGON,
    NavmeshTile,
)

_FARTHEST_M = 1e5
_REFERENCE_BITS = 22
"""Bits of a polygon's reference that Detour uses for the numbers of tiles and polygons."""


def expect(holds: bool | np.bool_, message: str) -> None:
    """Refuse a file.

    Raises:
        NavmeshError: The condition does not hold.
    """
    if not holds:
        raise NavmeshError(message)


def check_set(header: np.void) -> tuple[int, int]:
    """Check the header of a file.

    Returns:
        Bits of a reference that number the tiles, and those that number the polygons of a tile.

    Raises:
        NavmeshError: No file has such a header.
    """
    tile_bits, polygon_bits = (_bits(int(header[k])) for k in ("most_tiles", "most_polygons"))
    expect(
        tile_bits + polygon_bits <= _REFERENCE_BITS,
        f"room for {header['most_tiles']} tiles of {header['most_polygons']} polygons each is more "
        "than Detour's references can number",
    )
    sides = np.array([header["tile_width"], header["tile_height"]])
    _check_positions(header["origin"], "the origin")
    expect(
        (np.isfinite(sides) & (sides > 0.0)).all(),
        f"expected tiles with sides of more than 0 m, found {sides.tolist()}",
    )
    expect(header["tiles"] >= 1, f"expected at least one tile, found {header['tiles']}")
    return tile_bits, polygon_bits


def check_tile(tile: NavmeshTile, name: str) -> None:
    """Check that everything in a tile lies in bounds, and that searches in it end.

    Raises:
        NavmeshError: Something is out of bounds; the message names the tile.
    """
    _check_header(tile.header, name)
    _check_positions(tile.vertices, f"{name}: a vertex")
    _check_positions(tile.detail_vertices, f"{name}: a detail vertex")
    _check_polygons(tile, name)
    _check_details(tile, name)
    _check_tree(tile, name)


def _bits(most: int) -> int:
    """Number of bits needed to number a count of things."""
    return max(most - 1, 0).bit_length()


def _check_positions(positions: np.ndarray, what: str) -> None:
    # The comparison is False for NaN.
    near = np.abs(positions) <= _FARTHEST_M
    expect(near.all(), f"{what} lies more than {_FARTHEST_M:g} m away or is not a number")


def _check_header(header: np.void, name: str) -> None:
    low, high = header["lowest"], header["highest"]
    _check_positions(low, f"{name}: its lowest corner")
    _check_positions(high, f"{name}: its highest corner")
    expect((low <= high).all(), f"{name}: its lowest corner lies above its highest")
    climb, quantisation = float(header["walkable_climb"]), float(header["quantisation"])
    expect(0.0 <= climb <= _FARTHEST_M, f"{name}: expected a climb of 0 m or more, found {climb}")
    expect(
        0.0 < quantisation <= _FARTHEST_M,
        f"{name}: expected a quantisation of more than 0 per metre, found {quantisation}",
    )
    expect(header["polygons"] >= 1, f"{name}: it has no polygons")
    expect(header["tree_nodes"] >= 1, f"{name}: it has no tree to search in")
    expect(
        header["detail_meshes"] == header["polygons"],
        f"{name}: {header['polygons']} polygons with {header['detail_meshes']} detail meshes",
    )


def _check_polygons(tile: NavmeshTile, name: str) -> None:
    polygons = tile.polygons
    counts = polygons["vertex_count"]
    expect(
        ((counts >= 3) & (counts <= VERTICES_PER_POLYGON)).all(),
        f"{name}: a polygon has less than 3 or more than {VERTICES_PER_POLYGON} vertices",
    )
    expect(
        (polygons["area_and_type"] >> 6 == 0).all(), f"{name}: a polygon is no ground to walk on"
    )
    used = np.arange(VERTICES_PER_POLYGON) < counts[:, None]
    expect(
        (polygons["vertices"] < len(tile.vertices))[used].all(),
        f"{name}: a polygon has a vertex of a number beyond {len(tile.vertices)}",
    )
    neighbours = polygons["neighbours"][used]
    outwards = (neighbours & EXTERNAL) != 0
    expect(
        np.isin(neighbours[outwards] & 0xFF, SIDES).all(),
        f"{name}: an edge leads to another tile in an unknown direction",
    )
    inwards = neighbours[~outwards]
    expect(
        (inwards <= len(polygons)).all(),
        f"{name}: an edge leads to a polygon of a number beyond {len(polygons)}",
    )
    links = np.count_nonzero(inwards)
    expect(
        links <= tile.header["most_links"],
        f"{name}: expected at most {tile.header['most_links']} links, its edges need {links}",
    )


def _check_details(tile: NavmeshTile, name: str) -> None:
    details, triangles = tile.details, tile.detail_triangles
    first = details["triangle_base"].astype(np.int64)
    counts = details["triangle_count"].astype(np.int64)
    expect(
        (first + counts <= len(triangles)).all(),
        f"{name}: a detail mesh has triangles of numbers beyond {len(triangles)}",
    )
    owner = np.repeat(np.arange(len(details)), counts)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    corners = triangles[first[owner] + number].astype(np.int64)
    own = tile.polygons["vertex_count"][owner][:, None]
    beyond = details["vertex_base"][owner][:, None] + corners[:, :3] - own
    expect(
        ((corners[:, :3] < own) | (beyond < len(tile.detail_vertices))).all(),
        f"{name}: a detail triangle has a vertex of a number beyond {len(tile.detail_vertices)}",
    )


def _check_tree(tile: NavmeshTile, name: str) -> None:
    expect(
        (tile.tree["index"] < len(tile.polygons)).all(),
        f"{name}: a leaf of the tree holds a polygon of a number beyond {len(tile.polygons)}",
    )
