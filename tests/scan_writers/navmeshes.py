"""Navigation meshes of the houses that are written here: squares on floors, a ramp over stairs."""

from pathlib import Path

import numpy as np

from hypernav.core.embodiment import BodyConfig
from hypernav.worlds.navmesh.files.polygon_mesh import PolygonMesh
from hypernav.worlds.navmesh.files.writer import navmesh_bytes
from scan_writers.buildings import DEPTH_M, STAIRS_X, STOREY_M, WIDTH_M, House

CELL_M = 0.2
_COLUMNS, _ROWS = round(WIDTH_M / CELL_M), round(DEPTH_M / CELL_M)
_FOOT, _HEAD = round((STAIRS_X - 0.1) / CELL_M), 40
"""Columns at which the ramp begins and ends."""
_RAMP_ROWS = range(1, 4)

Node = tuple[int, int, int]
"""Column, row and storey of a corner; storey 2 is the ramp's."""


def mesh_of(house: House) -> PolygonMesh:
    """Squares of 0.2 m wherever a robot fits, on both storeys and on the stairs between them."""
    nodes: dict[Node, int] = {}
    polygons = []

    def corner(column: int, row: int, storey: int) -> int:
        if storey == 2 and column in (_FOOT, _HEAD):
            storey = 0 if column == _FOOT else 1
        return nodes.setdefault((column, row, storey), len(nodes))

    for column, row, storey in _cells(house):
        around = ((0, 0), (1, 0), (1, 1), (0, 1))
        polygons.append([corner(column + right, row + up, storey) for right, up in around])
    return PolygonMesh.of(np.array([_position(node) for node in nodes]), polygons)


def write_navmesh(house: House, path: Path, *, version: int = 2) -> Path:
    """The file of the mesh."""
    path.write_bytes(navmesh_bytes(mesh_of(house), BodyConfig(), version=version))
    return path


def _cells(house: House) -> list[Node]:
    floors = [
        (column, row, storey)
        for storey, z in ((0, 0.0), (1, STOREY_M))
        for column in range(_COLUMNS)
        for row in range(_ROWS)
        if all(
            house.is_free((column + right) * CELL_M, (row + up) * CELL_M, z)
            for right in (0, 1)
            for up in (0, 1)
        )
    ]
    ramp = [(column, row, 2) for column in range(_FOOT, _HEAD) for row in _RAMP_ROWS]
    landing = [(column, row, 1) for column in range(_HEAD, 43) for row in range(1, 8)]
    below = [(column, row, 0) for column in range(_FOOT - 3, _FOOT) for row in _RAMP_ROWS]
    return sorted({*floors, *ramp, *landing, *below})


def _position(node: Node) -> tuple[float, float, float]:
    column, row, storey = node
    rise = (column - _FOOT) / (_HEAD - _FOOT)
    return column * CELL_M, row * CELL_M, STOREY_M * (0.0, 1.0, rise)[storey]
