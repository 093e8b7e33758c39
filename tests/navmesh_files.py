"""Small navigation meshes, and the parts of their files."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from hypernav.core.embodiment import BodyConfig
from hypernav.simulator.worlds.navmesh.file_format import (
    SET_HEADER,
    SETTINGS,
    TILE_ARRAYS,
    TILE_HEADER,
    TILE_REFERENCE,
)
from hypernav.simulator.worlds.navmesh.navmesh import Navmesh
from hypernav.simulator.worlds.navmesh.navmesh_reader import navmesh_of
from hypernav.simulator.worlds.navmesh.navmesh_writer import PolygonMesh, navmesh_bytes


def squares(columns: int, rows: int, holes: tuple[tuple[int, int], ...] = ()) -> PolygonMesh:
    """Squares of 1 m side by side from the origin on, scene frame, on flat ground."""
    width = columns + 1
    vertices = [(x, y, 0.0) for y in range(rows + 1) for x in range(width)]
    polygons = [
        (width * y + x, width * y + x + 1, width * y + x + width + 1, width * y + x + width)
        for y in range(rows)
        for x in range(columns)
        if (x, y) not in holes
    ]
    return PolygonMesh.of(np.array(vertices, dtype=np.float64), polygons)


def two_floors() -> PolygonMesh:
    """A floor, a ramp up beside it, a floor 3 m higher that leads back over it, and an island."""
    vertices = [
        (0, 0, 0), (2, 0, 0), (4, 0, 0), (4, 2, 0), (2, 2, 0), (0, 2, 0),
        (2, 6, 3), (0, 6, 3), (4, 6, 3), (4, 8, 3), (0, 8, 3), (2, 0, 3), (4, 0, 3),
        (8, 0, 0), (9, 0, 0), (9, 1, 0),
    ]  # fmt: skip
    polygons = [
        (0, 1, 2, 3, 4, 5),
        (5, 4, 6, 7),
        (7, 6, 8, 9, 10),
        (11, 12, 8, 6),
        (13, 14, 15),
    ]
    return PolygonMesh.of(np.array(vertices, dtype=np.float64), polygons)


def content_of(mesh: PolygonMesh, version: int = 2) -> bytes:
    """The file of a mesh."""
    return navmesh_bytes(mesh, BodyConfig(), version=version)


def navmesh_from(mesh: PolygonMesh) -> Navmesh:
    """A mesh, written and read."""
    return Navmesh(navmesh_of(content_of(mesh)))


@dataclass
class TileParts:
    """The parts of a tile, to be changed before they are put together again."""

    reference: np.ndarray
    header: np.ndarray
    arrays: dict[str, np.ndarray]


@dataclass
class FileParts:
    """The parts of a file, to be changed before they are put together again."""

    header: np.ndarray
    settings: np.ndarray | None
    tiles: list[TileParts]

    @staticmethod
    def of(content: bytes) -> "FileParts":
        """The parts of a file that this package wrote."""
        rest = memoryview(content)

        def take(item: np.dtype, count: int = 1) -> np.ndarray:
            nonlocal rest
            size = item.itemsize * count
            values = np.frombuffer(rest[:size], item).copy()
            rest = rest[size:]
            return values

        header = take(SET_HEADER)
        settings = take(SETTINGS) if header["version"] > 1 else None
        tiles = []
        for _ in range(int(header["tiles"][0])):
            reference, tile = take(TILE_REFERENCE), take(TILE_HEADER)
            arrays = {a.name: take(a.item, int(tile[a.length][0])) for a in TILE_ARRAYS}
            tiles.append(TileParts(reference, tile, arrays))
        return FileParts(header, settings, tiles)

    def content(self, order: Literal["<", ">"] = "<") -> bytes:
        """The file, in a byte order."""
        parts = [self.header, *([] if self.settings is None else [self.settings])]
        for tile in self.tiles:
            size = TILE_HEADER.itemsize + sum(a.nbytes for a in tile.arrays.values())
            tile.reference["size"] = size
            parts += [tile.reference, tile.header, *tile.arrays.values()]
        return b"".join(part.astype(part.dtype.newbyteorder(order)).tobytes() for part in parts)
