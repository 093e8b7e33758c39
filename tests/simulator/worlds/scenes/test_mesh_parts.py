from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dae_writer import dae
from hypernav.simulator.worlds.scenes.loading import read_scene
from hypernav.simulator.worlds.scenes.mesh_parts import triangles_of_polygons

# A wall of 6 × 3 m with a doorway of 1 × 2 m, as one polygon.
WALL = [(0, 0), (2, 0), (2, 2), (3, 2), (3, 0), (6, 0), (6, 3), (0, 3)]


def area_of(points: np.ndarray, faces: np.ndarray) -> float:
    a, b, c = points[faces].transpose(1, 0, 2)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0)


def upright(outline: Sequence[tuple[float, float]]) -> np.ndarray:
    return np.array([(x, 0.0, z) for x, z in outline], dtype=np.float64)


@pytest.mark.parametrize("first", range(len(WALL)))
def test_a_doorway_stays_open_wherever_a_polygon_begins(first: int) -> None:
    points = upright(WALL[first:] + WALL[:first])
    for some in (points, points[::-1]):
        faces = triangles_of_polygons(np.array([len(some)]), some)
        assert len(faces) == len(WALL) - 2
        assert area_of(some, faces) == pytest.approx(16.0)


@given(st.lists(st.floats(0.3, 3.0), min_size=5, max_size=30))
def test_the_triangles_of_any_star_have_its_area(radii: list[float]) -> None:
    angles = np.linspace(0.0, 2.0 * np.pi, len(radii), endpoint=False)
    x, y = np.array(radii) * np.cos(angles), np.array(radii) * np.sin(angles)
    points = np.stack([x, y, 0.5 * x], axis=1)
    faces = triangles_of_polygons(np.array([len(radii)]), points)
    flat = abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2.0
    assert area_of(points, faces) == pytest.approx(flat * np.sqrt(1.25))


def test_convex_and_degenerate_polygons_are_fans() -> None:
    points = upright([(0, 0), (1, 0), (1, 1), (0, 1), (0, 0), (1, 0), (5, 5), (5, 6), (6, 6)])
    faces = triangles_of_polygons(np.array([4, 2, 3]), points)
    assert faces.tolist() == [[0, 1, 2], [0, 2, 3], [6, 7, 8]]
    assert len(triangles_of_polygons(np.array([], np.int64), np.zeros((0, 3)))) == 0


def test_a_wall_with_a_doorway_is_one_polygon_of_a_file(tmp_path: Path) -> None:
    lines = [f"v {x} {z} 0" for x, z in WALL] + ["vt 0 0", "o wall", "f 1 2 3"]
    lines += ["f " + " ".join(f"{k}/1" for k in range(1, 9))]
    (tmp_path / "a.obj").write_text("\n".join(lines))
    scene = read_scene(tmp_path / "a.obj")
    assert area_of(scene.vertices, scene.faces[:-6]) == pytest.approx(2.0)
    assert area_of(scene.vertices, scene.faces[-6:]) == pytest.approx(16.0)
    corners = " ".join(f"{x} {z} 0" for x, z in WALL)
    listed = " ".join(map(str, range(8)))
    polygon = f"""<polylist count="1"><input semantic="VERTEX" source="#corners" offset="0"/>
    <vcount>8</vcount><p>{listed}</p></polylist>"""
    text = dae(primitive=polygon).replace(' count="12">0 0 0 1 0 0 1 1 0 0 1 0', f">{corners}")
    (tmp_path / "a.dae").write_text(text)
    scene = read_scene(tmp_path / "a.dae")
    assert area_of(scene.vertices, scene.faces) == pytest.approx(16.0)
