"""Navigation mesh files of habitat-sim, read and checked.

The whole content of a file is checked here, so the result of `read_navmesh` needs no further
checks. The memory that it takes is proportional to the length of the file.
"""

from pathlib import Path
from typing import Any, Literal

import numpy as np

from hypernav.core.errors import NavmeshError
from hypernav.io.reading import read_file
from hypernav.worlds.navmesh.files.checks import check_set, check_tile, expect
from hypernav.worlds.navmesh.files.file_format import (
    SET_HEADER,
    SET_MAGIC,
    SETTINGS,
    TILE_ARRAYS,
    TILE_HEADER,
    TILE_MAGIC,
    TILE_REFERENCE,
    TILE_VERSION,
    VERSIONS,
    NavmeshFile,
    NavmeshTile,
)

_MOST_BYTES = 256_000_000
"""The navigation meshes of HM3D's largest buildings have less than 1 MB."""


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
