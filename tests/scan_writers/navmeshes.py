"""Navigation meshes of the houses that are written here: squares on floors, a ramp over stairs."""

from pathlib import Path

import numpy as np

from hypernav.core.embodiment import BodyConfig
from hypernav.simulator.worlds.navmesh.navmesh_writer import PolygonMesh, navmesh_bytes
from scan_writers.buildings import DEPTH_M, STOREY_M, WIDTH_M, Flight, House

CELL_M = 0.2
_COLUMNS, _ROWS = round(WIDTH_M / CELL_M), round(DEPTH_M / CELL_M)
Node = tuple[int, int, float]
"""Column, row and storey of a corner; half a storey more on the ramp up from it."""


def mesh_of(house: House) -> PolygonMesh:
    """Squares of 0.2 m wherever a robot fits, on all storeys and on the stairs between them."""
    nodes: dict[Node, int] = {}
    polygons = []

    def corner(column: int, row: int, storey: float) -> int:
        flight = _flight_of(house, storey)
        if flight is not None and column in _ends(flight):
            storey = flight.storey + _ends(flight).index(column)
        return nodes.setdefault((column, row, storey), len(nodes))

    for column, row, storey in _cells(house):
        around = ((0, 0), (1, 0), (1, 1), (0, 1))
        polygons.append([corner(column + right, row + up, storey) for right, up in around])
    return PolygonMesh.of(np.array([_position(house, node) for node in nodes]), polygons)


def write_navmesh(house: House, path: Path, *, version: int = 2) -> Path:
    """The file of the mesh."""
    path.write_bytes(navmesh_bytes(mesh_of(house), BodyConfig(), version=version))
    return path


def _cells(house: House) -> list[Node]:
    """The lower left corners of all squares."""
    cells: set[Node] = {
        (column, row, storey)
        for storey in range(len(house.flights) + 1)
        for column in range(_COLUMNS)
        for row in range(_ROWS)
        if all(
            house.is_free((column + right) * CELL_M, (row + up) * CELL_M, storey * STOREY_M)
            for right in (0, 1)
            for up in (0, 1)
        )
    }
    for flight in house.flights:
        foot, head = _ends(flight)
        rows = _rows(flight)
        # Beside the head one may go off the stairs, away from the wall.
        off = range(rows.start, 8) if rows.start < 8 else range(_ROWS - 8, rows.stop)
        ahead = range(3) if flight.along > 0 else range(-3, 0)
        cells |= {(k, row, flight.storey + 0.5) for k in _between(foot, head) for row in rows}
        cells |= {(head + k, row, flight.storey + 1) for k in ahead for row in off}
        cells |= {(foot - 1 - k, row, flight.storey) for k in ahead for row in rows}
    return sorted(cells)


def _flight_of(house: House, storey: float) -> Flight | None:
    """The flight whose ramp it is; None if it is a floor."""
    return None if storey == int(storey) else house.flights[int(storey)]


def _ends(flight: Flight) -> tuple[int, int]:
    """Columns at which the ramp begins and ends."""
    head_x = flight.x[1] if flight.along > 0 else flight.x[0]
    return round((flight.foot_x - 0.1 * flight.along) / CELL_M), round(head_x / CELL_M)


def _rows(flight: Flight) -> range:
    """Rows of the ramp, in the middle of the stairs."""
    first = round(sum(flight.y) / 2.0 / CELL_M - 1.5)
    return range(first, first + 3)


def _between(one: int, other: int) -> range:
    return range(min(one, other), max(one, other))


def _position(house: House, node: Node) -> tuple[float, float, float]:
    column, row, storey = node
    flight = _flight_of(house, storey)
    if flight is not None:
        foot, head = _ends(flight)
        storey = flight.storey + (column - foot) / (head - foot)
    return column * CELL_M, row * CELL_M, STOREY_M * storey
