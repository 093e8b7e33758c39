import json
import unicodedata
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from trimesh.visual import ColorVisuals

from gltf_writer import GltfWriter
from hypernav.core.errors import SceneError
from hypernav.simulator.worlds.scenes.loading import read_scene
from hypernav.simulator.worlds.scenes.scene import Scene


def write_squares(path: Path, *names: str) -> Path:
    writer = GltfWriter()
    mesh = writer.mesh(writer.square())
    for place, name in enumerate(names):
        writer.node(name=name, mesh=mesh, translation=[2.0 * place, 0.0, 0.0])
    return writer.write(path)


def labels_of(scene: Scene) -> dict[str, str | None]:
    return {
        instance.name: instance.label.category if instance.label else None
        for instance in scene.instances
    }


def test_every_node_is_an_instance_labelled_by_its_name(tmp_path: Path) -> None:
    path = write_squares(
        tmp_path / "home.glb", "Bed_01", "RoomWall_02", "Object_3", "arm-chair.001"
    )
    scene = read_scene(path)
    assert scene.name == "home"
    assert labels_of(scene) == {
        "Bed_01": "bed",
        "RoomWall_02": None,
        "Object_3": None,
        "arm-chair.001": "arm chair",
    }
    assert [instance.id for instance in scene.instances] == [0, 1, 2, 3]
    assert scene.face_instance.tolist() == [0, 0, 1, 1, 2, 2, 3, 3]


def test_nodes_of_the_same_name_stay_apart(tmp_path: Path) -> None:
    scene = read_scene(write_squares(tmp_path / "home.glb", "Bed", "Bed", "Bed"))
    assert [instance.name for instance in scene.instances] == ["Bed", "Bed#2", "Bed#3"]


def test_a_scene_file_of_a_general_name_goes_by_its_folder(tmp_path: Path) -> None:
    folder = tmp_path / "my_flat"
    folder.mkdir()
    assert read_scene(write_squares(folder / "scene.glb", "Bed")).name == "my_flat"


def write_objects(folder: Path, *objects: dict[str, Any]) -> None:
    (folder / "objects.json").write_text(json.dumps({"objects": list(objects)}))


def test_objects_json_says_what_the_nodes_are(tmp_path: Path) -> None:
    path = write_squares(tmp_path / "a.glb", "n1", "n2", "n3", "Lamp_7")
    write_objects(
        tmp_path,
        {
            "name": "couch",
            "category": "sofa",
            "nodes": ["n1", "n2"],
            "synonyms": ["couch"],
            "attributes": ["red"],
            "room": "living room",
            "beside": ["lamp"],
            "triangles": 4,
        },
        {"name": "shell", "category": "wall", "structural": True, "nodes": ["n3"]},
    )
    scene = read_scene(path)
    assert labels_of(scene) == {"couch": "sofa", "shell": None, "Lamp_7": "lamp"}
    couch = scene.instances[0]
    assert couch.label is not None
    assert couch.label.synonyms == ("couch",)
    assert couch.label.attributes == ("red",)
    assert couch.label.room == "living room"
    assert couch.label.beside == ("lamp",)
    assert couch.box_min == (0.0, 0.0, 0.0)
    assert couch.box_max == (3.0, 0.0, 1.0)


def assert_scene_error(path: Path, *words: str) -> None:
    with pytest.raises(SceneError) as caught:
        read_scene(path)
    message = str(caught.value)
    assert "\n" not in message
    for word in words:
        assert word in message


def test_missing_file(tmp_path: Path) -> None:
    assert_scene_error(tmp_path / "none.glb", "none.glb", "no such scene file")


def test_folder_instead_of_a_file(tmp_path: Path) -> None:
    write_squares(tmp_path / "house.glb", "Bed")
    assert_scene_error(tmp_path, "is a folder", "house.glb")


def test_empty_file(tmp_path: Path) -> None:
    (tmp_path / "a.glb").touch()
    assert_scene_error(tmp_path / "a.glb", "empty")


def test_text_file_with_the_wrong_name(tmp_path: Path) -> None:
    (tmp_path / "a.glb").write_text("hello, I am not a mesh")
    assert_scene_error(tmp_path / "a.glb", "not a GLB file")


def test_unknown_kind_of_file(tmp_path: Path) -> None:
    (tmp_path / "a.docx").write_text("x")
    assert_scene_error(tmp_path / "a.docx", ".docx", ".glb")


@pytest.mark.parametrize("keep", [13, 30, 400, -10])
def test_file_that_is_cut_off(tmp_path: Path, keep: int) -> None:
    path = write_squares(tmp_path / "a.glb", "Bed")
    path.write_bytes(path.read_bytes()[:keep])
    assert_scene_error(path, "cut off")


def test_file_without_triangles(tmp_path: Path) -> None:
    writer = GltfWriter()
    writer.node(name="empty")
    assert_scene_error(writer.write(tmp_path / "a.glb"), "no triangles")


def test_point_cloud(tmp_path: Path) -> None:
    writer = GltfWriter()
    points = {"attributes": {"POSITION": writer.array(np.zeros((4, 3), np.float32))}, "mode": 0}
    writer.node(name="cloud", mesh=writer.mesh(points))
    assert_scene_error(writer.write(tmp_path / "a.glb"), "no triangles")


def test_corners_that_are_no_numbers(tmp_path: Path) -> None:
    writer = GltfWriter()
    positions = np.full((3, 3), np.nan, np.float32)
    mesh = writer.mesh({"attributes": {"POSITION": writer.array(positions)}})
    writer.node(name="nowhere", mesh=mesh)
    assert_scene_error(writer.write(tmp_path / "a.glb"), "no triangles")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{", "not valid JSON"),
        ("[]", "objects.json"),
        ('{"objects": [{"name": "a"}]}', "category"),
        ('{"objects": [{"name": "a", "category": "b", "nodes": []}]}', "nodes"),
        ('{"objects": [{"name": "a", "category": "b", "nodes": ["Sofa"]}]}', "'Sofa'"),
        (
            '{"objects": [{"name": "a", "category": "b", "nodes": ["Bed"]},'
            ' {"name": "a", "category": "b", "nodes": ["Lamp"]}]}',
            "named 'a'",
        ),
        (
            '{"objects": [{"name": "a", "category": "b", "nodes": ["Bed"]},'
            ' {"name": "c", "category": "b", "nodes": ["Bed"]}]}',
            "belongs to both 'a' and 'c'",
        ),
    ],
)
def test_broken_objects_json(tmp_path: Path, text: str, words: str) -> None:
    path = write_squares(tmp_path / "a.glb", "Bed", "Lamp")
    (tmp_path / "objects.json").write_text(text)
    assert_scene_error(path, "objects.json", words)


def test_ply_with_colours_is_a_scan(tmp_path: Path) -> None:
    box = trimesh.creation.box()
    colours = np.tile(np.array([[200, 100, 50, 255]], np.uint8), (8, 1))
    box.visual = ColorVisuals(box, vertex_colors=colours)
    box.export(tmp_path / "scan.ply")
    scene = read_scene(tmp_path / "scan.ply")
    assert scene.unlit
    assert len(scene.faces) == 12
    np.testing.assert_array_equal(scene.colors[0, 0], [200, 100, 50])


def test_obj_is_read_y_up(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 2 3\nf 1 3 4\n")
    scene = read_scene(tmp_path / "a.obj")
    np.testing.assert_allclose(scene.vertices.min(axis=0), [0.0, -3.0, 0.0])
    np.testing.assert_allclose(scene.vertices.max(axis=0), [1.0, 0.0, 2.0])
    assert not scene.unlit


@pytest.mark.parametrize("name", ["a.obj", "a.ply", "a.stl", "a.off"])
def test_text_instead_of_a_mesh(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text("hello, I am not a mesh")
    assert_scene_error(tmp_path / name, name)


def test_small_house_matches_its_description(small_house: Path) -> None:
    scene = read_scene(small_house)
    described = json.loads(small_house.with_name("objects.json").read_text())["objects"]
    assert scene.name == "small_house"
    assert len(scene.faces) == sum(item["triangles"] for item in described)
    assert not scene.unlit
    instances = {instance.name: instance for instance in scene.instances}
    assert len(instances) == len(described)
    for item in described:
        instance = instances[item["name"]]
        low, high = item["aabb_zup"]
        np.testing.assert_allclose(instance.box_min, low, atol=0.01)
        np.testing.assert_allclose(instance.box_max, high, atol=0.01)
        assert (instance.label is None) == item["structural"]
        if instance.label is not None:
            assert instance.label.category == item["category"]
        owned = scene.face_instance == instance.id
        assert int(owned.sum()) == item["triangles"]


MARK = b"\xef\xbb\xbf"


def test_a_byte_order_mark_in_objects_json_is_no_content(tmp_path: Path) -> None:
    path = write_squares(tmp_path / "a.glb", "n1")
    text = json.dumps({"objects": [{"name": "couch", "category": "sofa", "nodes": ["n1"]}]})
    (tmp_path / "objects.json").write_bytes(MARK + text.encode())
    assert labels_of(read_scene(path)) == {"couch": "sofa"}


def test_a_byte_order_mark_takes_no_corner_of_a_mesh(tmp_path: Path) -> None:
    text = b"v 0 0 0\r\nv 1 0 0\r\nv 1 0 1\r\nv 0 0 1\r\nf 1 2 3\r\nf 1 3 4\r\n"
    shapes = []
    for name, content in (("plain", text), ("marked", MARK + text)):
        (tmp_path / f"{name}.obj").write_bytes(content)
        shapes.append(read_scene(tmp_path / f"{name}.obj").vertices)
    assert np.array_equal(*shapes)


def test_names_are_unicode_in_nodes_and_their_description(tmp_path: Path, test_data: Path) -> None:
    path = test_data / "field" / "09-node-names-not-ascii" / "names.glb"
    kinds = {name: kind for name, kind in labels_of(read_scene(path)).items() if kind}
    assert kinds == {"床_01": "床", "Stuhl.001": "stuhl"}
    decomposed = unicodedata.normalize("NFD", "Küche")
    path = write_squares(tmp_path / "a.glb", decomposed)
    write_objects(tmp_path, {"name": "k", "category": "table", "nodes": ["Küche"]})
    assert labels_of(read_scene(path)) == {"k": "table"}
    path = write_squares(tmp_path / "a.glb", "Küche")
    write_objects(tmp_path, {"name": "k", "category": "table", "nodes": [decomposed]})
    assert labels_of(read_scene(path)) == {"k": "table"}


def test_the_name_of_a_mesh_counts_where_no_node_says_what_it_is(tmp_path: Path) -> None:
    writer = GltfWriter()
    for mesh in ("Bed_01", "Mesh_2"):
        writer.node(name="Object_4", mesh=writer.mesh(writer.square(), name=mesh))
    lamp = writer.node(root=False, name="Cube", mesh=writer.mesh(writer.square(), name="wood"))
    writer.node(name="Lamp", children=[lamp])
    kinds = labels_of(read_scene(writer.write(tmp_path / "a.glb")))
    assert kinds == {"Object_4": "bed", "Object_4#2": None, "Cube": "lamp"}


@pytest.mark.parametrize(("away", "refused"), [(4_865_499.0, True), (20_000.0, False)])
def test_a_building_at_the_coordinates_of_a_map_is_refused(
    tmp_path: Path, away: float, refused: bool
) -> None:
    lines = [f"v {away + x} {y} {z}" for x, y, z in ((0, 0, 0), (1, 0, 0), (0, 2, 3))]
    (tmp_path / "a.obj").write_text("\n".join([*lines, "f 1 2 3"]))
    if refused:
        assert_scene_error(tmp_path / "a.obj", "km from the origin")
    else:
        assert len(read_scene(tmp_path / "a.obj").faces) == 1


def test_materials_that_are_missing_are_named(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    text = "mtllib lost.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n"
    (tmp_path / "a.obj").write_text(text)
    assert len(read_scene(tmp_path / "a.obj").faces) == 1
    assert any("lost.mtl" in message for message in caplog.messages)
