"""Navigation mesh files are read as they are, or refused with one error that says why."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from hostile.damage import bounded
from hypernav.core.errors import NavmeshError
from hypernav.simulator.worlds.navmesh.file_format import EXTERNAL
from hypernav.simulator.worlds.navmesh.navmesh import GoalPaths, Navmesh
from hypernav.simulator.worlds.navmesh.navmesh_reader import navmesh_of, read_navmesh
from hypernav.simulator.worlds.navmesh.navmesh_writer import PolygonMesh
from navmesh_files import FileParts, TileParts, content_of, squares, two_floors


@pytest.mark.parametrize("version", [1, 2])
def test_a_file_is_read_as_it_was_written(version: int, tmp_path: Path) -> None:
    path = tmp_path / "floors.navmesh"
    path.write_bytes(content_of(two_floors(), version))
    file = read_navmesh(path)
    assert file.version == version
    assert (file.settings is not None) == (version == 2)
    (tile,) = file.tiles
    assert [len(tile.polygons), len(tile.vertices)] == [5, 16]
    assert tile.vertices[3].tolist() == [4.0, 0.0, -2.0]
    assert tile.polygons["neighbours"][1].tolist() == [1, 0, 3, 0, 0, 0]
    assert tile.header["walkable_radius"] == pytest.approx(0.18)


@pytest.mark.parametrize("version", [1, 2])
def test_the_byte_order_is_the_files_own(version: int) -> None:
    little = content_of(two_floors(), version)
    big = FileParts.of(little).content(">")
    assert big[:4] == b"MSET"
    assert little[:4] == b"TESM"
    ours, theirs = navmesh_of(little), navmesh_of(big)
    assert ours.header == theirs.header
    for name in ("vertices", "polygons", "details", "detail_triangles", "tree"):
        assert (getattr(ours.tiles[0], name) == getattr(theirs.tiles[0], name)).all()


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(NavmeshError, match=r"nothing\.navmesh: No such file"):
        read_navmesh(tmp_path / "nothing.navmesh")


def test_a_broken_file_is_named(tmp_path: Path) -> None:
    path = tmp_path / "text.navmesh"
    path.write_text("a text")
    with pytest.raises(NavmeshError, match=r"text\.navmesh: .* that begins with 'TESM'"):
        read_navmesh(path)


@pytest.mark.parametrize("version", [1, 2])
def test_a_file_that_is_cut_off_anywhere_is_refused(version: int) -> None:
    content = content_of(two_floors(), version)
    for size in range(len(content)):
        with pytest.raises(NavmeshError):
            navmesh_of(content[:size])


def _of_header(**values: object) -> Callable[[FileParts], None]:
    def change(parts: FileParts) -> None:
        for key, value in values.items():
            parts.header[key] = value

    return change


def _of_tile(**values: object) -> Callable[[FileParts], None]:
    def change(parts: FileParts) -> None:
        for key, value in values.items():
            parts.tiles[0].header[key] = value

    return change


def _of_array(name: str, key: str | None, value: object) -> Callable[[FileParts], None]:
    def change(parts: FileParts) -> None:
        array = parts.tiles[0].arrays[name]
        (array if key is None else array[key])[0] = value

    return change


def _repeated_tile(parts: FileParts) -> None:
    tile = parts.tiles[0]
    parts.tiles.append(TileParts(tile.reference, tile.header, tile.arrays))
    parts.header["tiles"] = 2


def _stacked_tile(parts: FileParts) -> None:
    parts.header["most_tiles"] = 2
    _repeated_tile(parts)
    parts.tiles[0].reference = parts.tiles[0].reference.copy()
    parts.tiles[0].reference["reference"] = 0b10000


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (_of_header(version=3), "expected version 1 or 2 of the format, found 3"),
        (_of_header(tiles=0), "at least one tile, found 0"),
        (_of_header(tiles=2**31 - 1), "reference of tile 1, but 0 are left"),
        (_of_header(most_tiles=2**31 - 1), "more than Detour's references can number"),
        (_of_header(most_polygons=2), "at most 2 polygons, found 5"),
        (_of_header(tile_width=0.0), "sides of more than 0 m"),
        (_of_header(origin=np.nan), "the origin lies more than"),
        (_repeated_tile, "expected a number of its own below 1, found 0"),
        (_stacked_tile, "two tiles lie at the same location"),
        (_of_tile(magic=7), "expected a Detour tile 'DNAV' of version 7"),
        (_of_tile(version=6), "of version 6"),
        (_of_tile(polygons=2**31 - 1), "is the file cut off"),
        (_of_tile(vertices=-1), "is the file cut off"),
        (_of_tile(off_mesh_connections=1), "no off-mesh connections"),
        (_of_tile(lowest=1e30), "its lowest corner lies more than"),
        (_of_tile(highest=-90.0), "its lowest corner lies above its highest"),
        (_of_tile(walkable_climb=-1.0), "a climb of 0 m or more"),
        (_of_tile(quantisation=0.0), "a quantisation of more than 0"),
        (_of_array("vertices", None, np.inf), "a vertex lies more than"),
        (_of_array("polygons", "vertex_count", 2), "less than 3 or more than 6 vertices"),
        (_of_array("polygons", "area_and_type", 0x40), "no ground to walk on"),
        (_of_array("polygons", "vertices", 16), "a vertex of a number beyond 16"),
        (_of_array("polygons", "neighbours", 6), "a polygon of a number beyond 5"),
        (_of_array("polygons", "neighbours", EXTERNAL | 3), "in an unknown direction"),
        (_of_array("details", "triangle_base", 2**32 - 1), "triangles of numbers beyond"),
        (_of_array("details", "triangle_count", 200), "triangles of numbers beyond"),
        (_of_array("detail_triangles", None, 250), "a vertex of a number beyond 0"),
        (_of_array("tree", "index", 5), "a polygon of a number beyond 5"),
    ],
)
def test_what_no_navigation_mesh_holds_is_refused(
    change: Callable[[FileParts], None], message: str
) -> None:
    parts = FileParts.of(content_of(two_floors()))
    change(parts)
    with pytest.raises(NavmeshError, match=message):
        navmesh_of(parts.content())


def test_a_wrong_size_of_a_tile_is_refused() -> None:
    content = bytearray(content_of(two_floors()))
    content[100] ^= 1
    with pytest.raises(NavmeshError, match="its arrays take"):
        navmesh_of(bytes(content))


def test_more_links_than_announced_are_refused() -> None:
    parts = FileParts.of(content_of(two_floors()))
    (tile,) = parts.tiles
    tile.header["most_links"] = 2
    tile.arrays["links"] = tile.arrays["links"][:2]
    with pytest.raises(NavmeshError, match="at most 2 links, its edges need 6"):
        navmesh_of(parts.content())


def _ask(content: bytes) -> None:
    """Read a file and ask it everything; what it answers doesn't matter."""
    navmesh = Navmesh(navmesh_of(content))
    points = [(0.5, 0.0, -0.5), (3.5, 3.0, -7.5), (8.5, 0.1, -0.2)]
    for start in points:
        GoalPaths(navmesh, np.array(points)).nearest(start)
        for end in points:
            navmesh.shortest_path(start, end)
            for sliding in (False, True):
                navmesh.try_step(start, end, sliding=sliding)


def _mutations(content: bytes, count: int) -> int:
    """Change bytes, 16-bit and 32-bit numbers of a file in turn; returns how many were refused."""
    rng = np.random.default_rng(0)
    refused = 0
    for number in range(count):
        damaged = bytearray(content)
        for _ in range(int(rng.integers(1, 4))):
            width = int(rng.choice([1, 2, 4]))
            place = int(rng.integers(0, len(content) // width)) * width
            extreme = rng.choice(
                [0, 1, 2 ** (8 * width - 1) - 1, 2 ** (8 * width - 1), 2 ** (8 * width) - 1]
            )
            value = int(extreme) if rng.random() < 0.5 else int(rng.integers(0, 2 ** (8 * width)))
            damaged[place : place + width] = value.to_bytes(width, "little")
        if number % 10 == 0:
            damaged = damaged[: int(rng.integers(0, len(content)))]
        try:
            with bounded():
                _ask(bytes(damaged))
        except NavmeshError:
            refused += 1
    return refused


@pytest.mark.parametrize("version", [1, 2])
def test_damaged_files_are_refused_or_read(version: int) -> None:
    content = content_of(two_floors(), version)
    _ask(content)  # compiles
    assert 0 < _mutations(content, 300) < 300


@pytest.mark.slow
@pytest.mark.parametrize("version", [1, 2])
def test_many_damaged_files_are_refused_or_read(version: int) -> None:
    content = content_of(squares(6, 5, holes=((2, 2), (3, 2))), version)
    _ask(content)
    assert 0 < _mutations(content, 4000) < 4000


def test_polygons_must_fit_together() -> None:
    vertices = squares(2, 1).vertices
    with pytest.raises(NavmeshError, match="3 to 6 corners"):
        PolygonMesh.of(vertices, [(0, 1)])
    with pytest.raises(NavmeshError, match="found none"):
        PolygonMesh.of(vertices, [])
    with pytest.raises(NavmeshError, match="the same side of an edge"):
        PolygonMesh.of(vertices, [(0, 1, 4), (0, 1, 4, 3)]).neighbours()
    with pytest.raises(NavmeshError, match="less than 32,768 polygons"):
        PolygonMesh.of(vertices, [(0, 1, 4)] * 40_000)
