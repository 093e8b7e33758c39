from pathlib import Path

import numpy as np
import pytest

from hypernav.core.errors import SceneError
from hypernav.simulator.worlds.scenes.loading import read_scene
from hypernav.simulator.worlds.scenes.scene import Scene

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"


def boxes(scene: Scene) -> dict[str, list[float]]:
    return {item.name: [*item.box_min, *item.box_max] for item in scene.instances}


def kinds(scene: Scene) -> dict[str, str | None]:
    return {item.name: item.label and item.label.category for item in scene.instances}


@pytest.mark.parametrize("described", [False, True])
def test_objects_of_an_obj_file_are_objects(
    test_data: Path, tmp_path: Path, described: bool
) -> None:
    folder = test_data / "field" / "10-obj-object-names"
    path = tmp_path / "room.obj"
    path.write_bytes((folder / "room.obj").read_bytes())
    if described:
        example = folder / "objects.json.example"
        (tmp_path / "objects.json").write_bytes(example.read_bytes())
    scene = read_scene(path)
    assert {name: kind for name, kind in kinds(scene).items() if kind} == {
        "bed_01": "bed",
        "chair_01": "chair",
    }
    assert len(scene.instances) == 7
    assert len(scene.vertices) == 7 * 8  # no object holds the vertices of the others


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        ("g bed_01\nf 1 2 3\ng chair\nf 1 3 4\n", {"bed_01": "bed", "chair": "chair"}),
        ("o model\ng bed\nf 1 2 3\ng chair\nf 1 3 4\n", {"bed": "bed", "chair": "chair"}),
        ("o bed\nf 1 2 3\no chair\ng part\nf 1 3 4\n", {"bed": "bed", "chair": "chair"}),
        ("\to  bed one \r\nf 1 2 3\no chair\nf 1 3 4\n", {"bed one": "bed one", "chair": "chair"}),
        ("g bed\nf 1 2 3\ng\nf 1 3 4\ng bed\nf 1 2 4\n", {"bed": "bed", "object 1": None}),
        (
            "mtllib a.mtl\no bed\nusemtl red\nf 1 2 3\nusemtl blue\nf 1 3 4\no 床\nf 1 2 4\n",
            {"bed": "bed", "床": "床"},
        ),
    ],
)
def test_groups_name_objects_where_an_obj_file_has_no_others(
    tmp_path: Path, lines: str, expected: dict[str, str | None]
) -> None:
    (tmp_path / "a.mtl").write_text("newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n")
    (tmp_path / "a.obj").write_text(SQUARE + lines, encoding="utf-8")
    assert kinds(read_scene(tmp_path / "a.obj")) == expected


def test_indices_that_count_back_are_those_of_their_own_line(tmp_path: Path) -> None:
    second = "v 5 0 0\nv 6 0 0\nv 6 1 0\n"
    text = f"{SQUARE}o bed\nf -4 -3 -2\nf -4 -2 -1\n{second}o chair\nf -3 -2 -1\n"
    (tmp_path / "a.obj").write_text(text)
    found = boxes(read_scene(tmp_path / "a.obj"))
    np.testing.assert_allclose(found["bed"], [0, 0, 0, 1, 0, 1])
    np.testing.assert_allclose(found["chair"], [5, 0, 0, 6, 0, 1])


@pytest.mark.parametrize("corners", [3, 4])
def test_faces_with_numbers_of_objects_are_objects(tmp_path: Path, corners: int) -> None:
    """As in Replica's ``mesh_semantic.ply``, whose faces are quads."""
    path = tmp_path / "a.ply"
    path.write_bytes(numbered_ply([7, 11], corners))
    found = boxes(read_scene(path))
    np.testing.assert_allclose(found["object 7"], [0, 0, 0, 1, 1, 0])
    np.testing.assert_allclose(found["object 11"], [5, 0, 0, 6, 1, 0])


def numbered_ply(numbers: list[int], corners: int = 3) -> bytes:
    """Faces with numbers of objects, by turns near the origin and 5 m beside it."""
    x, y = [0, 1, 1, 0, 5, 6, 6, 5], [0, 0, 1, 1, 0, 0, 1, 1]
    vertices = np.zeros(8, dtype=[("x", "<f4"), ("y", "<f4"), ("z", "<f4")])
    vertices["x"], vertices["y"] = x, y
    face = [("n", "u1"), ("vertices", "<i4", (corners,)), ("object_id", "<i4")]
    near = [(corners, k % 2 * 4 + np.arange(corners), n) for k, n in enumerate(numbers)]
    faces = np.array(near, dtype=face)
    header = (
        "ply\nformat binary_little_endian 1.0\nelement vertex 8\n"
        "property float x\nproperty float y\nproperty float z\n"
        f"element face {len(numbers)}\n"
        "property list uchar int vertex_indices\nproperty int object_id\nend_header\n"
    )
    return header.encode() + vertices.tobytes() + faces.tobytes()


@pytest.mark.parametrize("name", ["a.obj", "b.obj", "c.ply"])
def test_too_many_objects_or_materials_are_refused(tmp_path: Path, name: str) -> None:
    word = {"a.obj": "o", "b.obj": "usemtl"}.get(name, "")
    lines = "".join(f"{word} n{k}\nf 1 2 3\n" for k in range(20_001))
    content = (SQUARE + lines).encode() if word else numbered_ply(list(range(20_001)))
    (tmp_path / name).write_bytes(content)
    with pytest.raises(SceneError, match="more than 20,000 objects or materials"):
        read_scene(tmp_path / name)


def test_the_memory_of_polygons_is_counted(tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    path.write_text(SQUARE + "f" + " 1" * 5_100_000 + "\n")
    with pytest.raises(SceneError, match="its polygons would take"):
        read_scene(path)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_names_may_be_in_any_encoding_of_windows(tmp_path: Path, encoding: str) -> None:
    text = SQUARE + "o Küche_01\nf 1 2 3\no Bett\nf 1 3 4\n"
    (tmp_path / "a.obj").write_bytes(text.encode(encoding))
    assert set(kinds(read_scene(tmp_path / "a.obj")).values()) == {"küche", "bett"}
