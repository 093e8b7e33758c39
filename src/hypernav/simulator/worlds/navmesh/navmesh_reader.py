"""Navigation mesh files of habitat-sim, read and checked.

The whole content of a file, which may hold anything, is checked here, so the result of
`read_navmesh` needs no further checks. The memory that it takes is proportional to the length of
the file.
"""

from pathlib import Path
from typing import Any, Literal

import numpy as np

from hypernav.core.errors import NavmeshError
from hypernav.io.reading import read_file
from hypernav.simulator.worlds.navmesh.file_format import (
    EXTERNAL,
    SET_HEADER,
    SET_MAGIC,
    SETTINGS,
    SIDES,
    TILE_ARRAYS,
    TILE_HEADER,
    TILE_MAGIC,
    TILE_REFERENCE,
    TILE_VERSION,
    VERSIONS,
    VERTICES_PER_POLYGON,
    NavmeshFile,
    NavmeshTile,
)

_FARTHEST_M = 1e5
_REFERENCE_BITS = 22
"""Bits of a polygon's reference that Detour uses for the numbers of tiles and polygons."""
_MOST_BYTES = 256_000_000
"""The navigation meshes of HM3D's largest buildings have less than 1 MB."""


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


def read_navmesh(path: Path) -> NavmeshFile:
    """Read a file.

    Raises:
        NavmeshError: It is missing, no navigation mesh, of an unknown version, truncated, or has
            impossible content.
    """
    try:
        content = read_file(path, most=_MOST_BYTES)
    except OSError as error:
        raise NavmeshError(f"navmesh {path}: {error.strerror or error}") from error
    try:
        return navmesh_of(content)
    except NavmeshError as error:
        raise NavmeshError(f"navmesh {path}: {error}") from error


def navmesh_of(content: bytes) -> NavmeshFile:
    """The navigation mesh that a file's bytes hold.

    Raises:
        NavmeshError: As `read_navmesh`.
    """
    source = _Source(content)
    header = source.record(SET_HEADER, "its header")
    version = int(header["version"])
    expect(version in VERSIONS, f"expected version 1 or 2 of the format, found {version}")
    settings = source.record(SETTINGS, "its settings") if version > 1 else None
    tile_bits, polygon_bits = check_set(header)
    tiles: dict[int, NavmeshTile] = {}
    for number in range(int(header["tiles"])):
        reference = source.record(TILE_REFERENCE, f"the reference of tile {number}")
        index = int(reference["reference"]) >> polygon_bits & (1 << tile_bits) - 1
        expect(
            index < header["most_tiles"] and index not in tiles,
            f"tile {number}: expected a number of its own below {header['most_tiles']}, found "
            f"{index}",
        )
        tiles[index] = _read_tile(source, index, int(reference["size"]))
        expect(
            len(tiles[index].polygons) <= header["most_polygons"],
            f"tile {number}: expected at most {header['most_polygons']} polygons, found "
            f"{len(tiles[index].polygons)}",
        )
    locations = {tuple(int(t.header[key]) for key in ("x", "y", "layer")) for t in tiles.values()}
    expect(len(locations) == len(tiles), "two tiles lie at the same location")
    return NavmeshFile(version, header, settings, tuple(tiles.values()))


class _Source:
    """The bytes of a file, read from the beginning to the end in the file's own byte order."""

    def __init__(self, content: bytes) -> None:
        orders: dict[bytes, Literal["<", ">"]] = {
            SET_MAGIC.to_bytes(4, "little"): "<",
            SET_MAGIC.to_bytes(4, "big"): ">",
        }
        expect(
            content[:4] in orders,
            f"expected a file that begins with 'TESM', found {content[:4]!r}; it is no navigation "
            "mesh of habitat-sim",
        )
        self._order: Literal["<", ">"] = orders[content[:4]]
        self._content = content
        self._next = 0

    @property
    def position(self) -> int:
        """Number of bytes read so far."""
        return self._next

    def record(self, item: np.dtype, what: str) -> np.void:
        """The next record, in this machine's byte order."""
        return self.array(item, 1, what)[0]

    def array(self, item: np.dtype, count: int, what: str) -> np.ndarray:
        """A copy of the next items, in this machine's byte order; padded to four bytes."""
        left = len(self._content) - self._next
        expect(
            0 <= count * item.itemsize <= left,
            f"expected {count} × {item.itemsize} bytes of {what}, but {left} are left; is the file "
            "cut off?",
        )
        base, shape = item.subdtype or (item, ())
        values = np.frombuffer(
            self._content,
            base.newbyteorder(self._order),
            count * int(np.prod(shape, dtype=np.int64)),
            self._next,
        )
        size = count * item.itemsize
        self._next += min(size + -size % 4, left)
        return values.reshape(count, *shape).astype(base.newbyteorder("="))


def _read_tile(source: _Source, index: int, size: int) -> NavmeshTile:
    name = f"tile {index}"
    first = source.position
    header = source.record(TILE_HEADER, f"the header of {name}")
    expect(
        header["magic"] == TILE_MAGIC and header["version"] == TILE_VERSION,
        f"{name}: expected a Detour tile 'DNAV' of version {TILE_VERSION}, found "
        f"{int(header['magic']).to_bytes(4, 'big')!r} of version {header['version']}",
    )
    expect(
        header["off_mesh_connections"] == 0,
        f"{name}: expected no off-mesh connections, which habitat-sim never writes, found "
        f"{header['off_mesh_connections']}",
    )
    arrays: dict[str, Any] = {
        array.name: source.array(array.item, int(header[array.length]), f"{array.name} of {name}")
        for array in TILE_ARRAYS
    }
    taken = source.position - first
    expect(taken == size, f"{name}: expected {size} bytes, its arrays take {taken}")
    arrays.pop("links")
    tile = NavmeshTile(index, header, **arrays)
    check_tile(tile, name)
    return tile
