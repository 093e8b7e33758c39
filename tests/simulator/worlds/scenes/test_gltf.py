import base64
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gltf_writer import SQUARE, SQUARE_UV, GltfWriter
from hypernav.core.errors import SceneError
from hypernav.simulator.worlds.scenes.loading import read_scene
from hypernav.simulator.worlds.scenes.scene import Scene, Wrap

RED_GREEN = np.array([[[255, 0, 0], [0, 255, 0]]], np.uint8)


def face_normals(scene: Scene) -> np.ndarray:
    a, b, c = (scene.vertices[scene.faces[:, corner]] for corner in range(3))
    normals = np.cross(b - a, c - a)
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def test_y_up_becomes_z_up(tmp_path: Path) -> None:
    writer = GltfWriter()
    writer.node(name="a", mesh=writer.mesh(writer.square()), translation=[10.0, 20.0, 30.0])
    scene = read_scene(writer.write(tmp_path / "a.glb"))
    expected = np.array([[10, -30, 20], [11, -30, 20], [11, -30, 21], [10, -30, 21]])
    np.testing.assert_allclose(scene.vertices, expected)
    # The square faced +z of glTF, towards the viewer: that is -y of the scene frame.
    np.testing.assert_allclose(face_normals(scene), [[0, -1, 0], [0, -1, 0]], atol=1e-6)


def test_transforms_chain_from_parent_to_child(tmp_path: Path) -> None:
    writer = GltfWriter()
    half = np.sqrt(0.5)
    child = writer.node(
        root=False, name="child", mesh=writer.mesh(writer.square()), scale=[2.0, 1.0, 1.0]
    )
    # A quarter turn about glTF's y axis takes x to -z.
    writer.node(
        name="parent", children=[child], rotation=[0.0, half, 0.0, half], translation=[5, 0, 0]
    )
    scene = read_scene(writer.write(tmp_path / "a.glb"))
    assert [instance.name for instance in scene.instances] == ["child"]
    np.testing.assert_allclose(scene.vertices[1], [5.0, 2.0, 0.0], atol=1e-6)


def test_matrix_is_read_column_by_column(tmp_path: Path) -> None:
    writer = GltfWriter()
    matrix = np.eye(4)
    matrix[:3, 3] = [1.0, 2.0, 3.0]
    mesh = writer.mesh(writer.square())
    writer.node(name="a", mesh=mesh, matrix=matrix.T.ravel().tolist())
    scene = read_scene(writer.write(tmp_path / "a.glb"))
    np.testing.assert_allclose(scene.vertices[0], [1.0, -3.0, 2.0])


def test_mirrored_nodes_keep_their_outside(tmp_path: Path) -> None:
    writer = GltfWriter()
    normals = writer.array(np.tile(np.array([[0, 0, 1]], np.float32), (4, 1)))
    mesh = writer.mesh(writer.square(NORMAL=normals))
    writer.node(name="a", mesh=mesh, scale=[-1.0, 1.0, 1.0])
    scene = read_scene(writer.write(tmp_path / "a.glb"))
    assert scene.vertices[:, 0].min() == -1.0
    np.testing.assert_allclose(face_normals(scene), [[0, -1, 0], [0, -1, 0]], atol=1e-6)
    assert scene.normals is not None
    np.testing.assert_allclose(scene.normals[0, 0], [0, -1, 0], atol=1e-6)


def test_normals_of_a_stretched_node_stay_at_right_angles(tmp_path: Path) -> None:
    writer = GltfWriter()
    slope = SQUARE.copy()
    slope[:, 2] = -slope[:, 0]  # the plane x + z = 0
    normal = np.tile(np.array([[1, 0, 1]], np.float32) / np.sqrt(2), (4, 1)).astype(np.float32)
    primitive = {
        "attributes": {"POSITION": writer.array(slope), "NORMAL": writer.array(normal)},
        "indices": writer.square()["indices"],
    }
    writer.node(name="a", mesh=writer.mesh(primitive), scale=[3.0, 1.0, 1.0])
    scene = read_scene(writer.write(tmp_path / "a.glb"))
    assert scene.normals is not None
    for corner in range(3):
        np.testing.assert_allclose(scene.normals[:, corner], face_normals(scene), atol=1e-5)


def test_one_mesh_under_several_nodes(tmp_path: Path) -> None:
    writer = GltfWriter()
    mesh = writer.mesh(writer.square(), writer.square())
    writer.node(name="Chair_1", mesh=mesh)
    writer.node(name="Chair_2", mesh=mesh, translation=[3.0, 0.0, 0.0])
    scene = read_scene(writer.write(tmp_path / "a.glb"))
    assert len(scene.faces) == 8
    assert scene.face_instance.tolist() == [0, 0, 0, 0, 1, 1, 1, 1]
    assert scene.instances[1].box_min == (3.0, 0.0, 0.0)


def test_label_comes_from_the_next_name_above_that_says_something(tmp_path: Path) -> None:
    writer = GltfWriter()
    mesh = writer.mesh(writer.square())
    leaf = writer.node(root=False, name="Object_4", mesh=mesh)
    sofa = writer.node(root=False, name="Sofa.003", children=[leaf])
    writer.node(name="RootNode", children=[sofa])
    writer.node(mesh=writer.mesh(writer.square(), name="Lamp"))
    scene = read_scene(writer.write(tmp_path / "a.glb"))
    names = {i.name: i.label.category if i.label else None for i in scene.instances}
    assert names == {"Object_4": "sofa", "Lamp": "lamp"}


@pytest.mark.parametrize("mode", [5, 6])
def test_strips_and_fans_are_unrolled_with_one_outside(tmp_path: Path, mode: int) -> None:
    writer = GltfWriter()
    order = [0, 1, 3, 2] if mode == 5 else [0, 1, 2, 3]
    primitive = {"attributes": {"POSITION": writer.array(SQUARE[order])}, "mode": mode}
    writer.node(name="a", mesh=writer.mesh(primitive))
    scene = read_scene(writer.write(tmp_path / "a.glb"))
    np.testing.assert_allclose(face_normals(scene), [[0, -1, 0], [0, -1, 0]], atol=1e-6)


def test_textures_bring_colour_wrap_and_upward_v(tmp_path: Path) -> None:
    writer = GltfWriter()
    material = writer.textured(RED_GREEN, wrapS=33071, wrapT=33648)
    uv = writer.array(SQUARE_UV)
    writer.node(name="a", mesh=writer.mesh(writer.square(material=material, TEXCOORD_0=uv)))
    scene = read_scene(writer.write(tmp_path / "a.glb"))
    used = scene.materials[scene.face_material[0]]
    assert used.texture is not None
    np.testing.assert_array_equal(used.texture, RED_GREEN)
    assert used.wrap == (Wrap.CLAMP, Wrap.MIRROR)
    assert used.opaque is None
    # The lower left corner of the square is v = 1 in glTF and v = 0 here.
    np.testing.assert_allclose(scene.uv[0], [[0, 0], [1, 0], [1, 1]])


def test_equal_images_are_kept_once(tmp_path: Path) -> None:
    writer = GltfWriter()
    uv = writer.array(SQUARE_UV)
    for name in ("a", "b"):
        primitive = writer.square(material=writer.textured(RED_GREEN), TEXCOORD_0=uv)
        writer.node(name=name, mesh=writer.mesh(primitive))
    scene = read_scene(writer.write(tmp_path / "a.glb"))
    assert scene.materials[0].texture is scene.materials[1].texture


@pytest.mark.parametrize(
    ("mode", "holes"), [("OPAQUE", None), ("MASK", [[True, False]]), ("BLEND", [[True, False]])]
)
def test_holes_of_a_texture(tmp_path: Path, mode: str, holes: list[list[bool]] | None) -> None:
    writer = GltfWriter()
    image = np.array([[[255, 0, 0, 255], [0, 255, 0, 20]]], np.uint8)
    material = writer.textured(image)
    writer.document["materials"][material]["alphaMode"] = mode
    primitive = writer.square(material=material, TEXCOORD_0=writer.array(SQUARE_UV))
    writer.node(name="a", mesh=writer.mesh(primitive))
    opaque = read_scene(writer.write(tmp_path / "a.glb")).materials[0].opaque
    assert (opaque is None) if holes is None else np.array_equal(np.asarray(opaque), holes)


def test_texture_transform(tmp_path: Path) -> None:
    writer = GltfWriter()
    material = writer.textured(RED_GREEN)
    info = writer.document["materials"][material]["pbrMetallicRoughness"]["baseColorTexture"]
    transform = {"offset": [0.5, 0.0], "scale": [2.0, 1.0], "rotation": np.pi / 2, "texCoord": 1}
    info["extensions"] = {"KHR_texture_transform": transform}
    uv = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32)
    other = writer.array(np.zeros((4, 2), np.float32))
    primitive = writer.square(material=material, TEXCOORD_0=other, TEXCOORD_1=writer.array(uv))
    writer.node(name="a", mesh=writer.mesh(primitive))
    scene = read_scene(writer.write(tmp_path / "a.glb"))
    # Scaled to (2, 0), turned counter-clockwise in the image to (0, -2), moved to (0.5, -2).
    np.testing.assert_allclose(scene.uv[0, 1], [0.5, 1.0 - -2.0], atol=1e-6)


def test_colours_are_stored_as_srgb(tmp_path: Path) -> None:
    writer = GltfWriter()
    factor = {"baseColorFactor": [0.2158605, 0.0, 1.0, 1.0]}
    material = writer.add("materials", {"pbrMetallicRoughness": factor})
    colors = np.tile(np.array([[0, 128, 255, 255]], np.uint8), (4, 1))
    color = writer.array(colors, normalized=True)
    writer.node(name="a", mesh=writer.mesh(writer.square(material=material, COLOR_0=color)))
    scene = read_scene(writer.write(tmp_path / "a.glb"))
    np.testing.assert_allclose(scene.materials[0].color, [0.5019, 0.0, 1.0], atol=1e-3)
    np.testing.assert_array_equal(scene.colors[0, 0], [0, 188, 255])


def test_unlit_materials_make_an_unlit_scene(tmp_path: Path) -> None:
    writer = GltfWriter()
    scan = writer.add("materials", {"extensions": {"KHR_materials_unlit": {}}})
    writer.document["extensionsRequired"] = ["KHR_materials_unlit"]
    writer.node(name="a", mesh=writer.mesh(writer.square(material=scan)))
    assert read_scene(writer.write(tmp_path / "a.glb")).unlit
    plain = writer.add("materials", {})
    writer.node(name="b", mesh=writer.mesh(writer.square(material=plain)))
    assert not read_scene(writer.write(tmp_path / "b.glb")).unlit


def test_quantised_and_sparse_positions(tmp_path: Path) -> None:
    writer = GltfWriter()
    square = (SQUARE * 127).astype(np.int8)
    positions = writer.array(np.pad(square, ((0, 0), (0, 1))), normalized=True)
    accessor = writer.document["accessors"][positions]
    writer.document["bufferViews"][accessor["bufferView"]]["byteStride"] = 4
    accessor["type"] = "VEC3"
    accessor["sparse"] = {
        "count": 1,
        "indices": {"bufferView": writer.view(bytes([2])), "componentType": 5121},
        "values": {"bufferView": writer.view(np.array([127, 127, 127], np.int8).tobytes())},
    }
    primitive = {"attributes": {"POSITION": positions}, "indices": writer.square()["indices"]}
    writer.node(name="a", mesh=writer.mesh(primitive))
    scene = read_scene(writer.write(tmp_path / "a.glb"))
    np.testing.assert_allclose(scene.vertices, [[0, 0, 0], [1, 0, 0], [1, -1, 1], [0, 0, 1]])


def test_missing_normals_are_smooth_over_flat_edges_only(tmp_path: Path) -> None:
    writer = GltfWriter()
    # Two squares that meet at a flat edge, and a third at a right angle to them.
    positions = np.array(
        [
            [0, 0, 0],
            [1, 0, 0],
            [1, 1, 0],
            [0, 1, 0],
            [2, 0, 0.3],
            [2, 1, 0.3],
            [0, 0, 1],
            [0, 1, 1],
        ],
        np.float32,
    )
    faces = np.array([0, 1, 2, 0, 2, 3, 1, 4, 5, 1, 5, 2, 0, 3, 7, 0, 7, 6], np.uint16)
    primitive = {
        "attributes": {"POSITION": writer.array(positions)},
        "indices": writer.array(faces),
    }
    writer.node(name="a", mesh=writer.mesh(primitive))
    scene = read_scene(writer.write(tmp_path / "a.glb"))
    assert scene.normals is not None
    flat = face_normals(scene)
    np.testing.assert_allclose(np.linalg.norm(scene.normals, axis=2), 1.0, atol=1e-5)
    at_flat_edge = scene.normals[0, 1]
    assert flat[0] @ at_flat_edge < 0.999
    np.testing.assert_allclose(at_flat_edge, scene.normals[2, 0], atol=1e-6)
    np.testing.assert_allclose(scene.normals[4], np.tile(flat[4], (3, 1)), atol=1e-6)


def test_gltf_with_files_beside_it_and_embedded_data(tmp_path: Path) -> None:
    writer = GltfWriter()
    uv = writer.array(SQUARE_UV)
    primitive = writer.square(material=writer.textured(RED_GREEN), TEXCOORD_0=uv)
    writer.node(name="a", mesh=writer.mesh(primitive))
    whole = read_scene(writer.write(tmp_path / "a.glb"))
    for uri in (
        "my%20data.bin",
        "data:application/octet-stream;base64," + base64.b64encode(writer.binary).decode(),
    ):
        writer.document["buffers"] = [{"byteLength": len(writer.binary), "uri": uri}]
        (tmp_path / "my data.bin").write_bytes(writer.binary)
        (tmp_path / "a.gltf").write_text(json.dumps(writer.document))
        scene = read_scene(tmp_path / "a.gltf")
        np.testing.assert_array_equal(scene.vertices, whole.vertices)
        np.testing.assert_array_equal(scene.uv, whole.uv)
    (tmp_path / "my data.bin").unlink()
    writer.document["buffers"][0]["uri"] = "my%20data.bin"
    (tmp_path / "a.gltf").write_text(json.dumps(writer.document))
    with pytest.raises(SceneError, match=r"my data\.bin"):
        read_scene(tmp_path / "a.gltf")


def invalid(path: list[Any], value: Any) -> GltfWriter:
    """A small textured scene with one value of its document replaced."""
    writer = GltfWriter()
    uv = writer.array(SQUARE_UV)
    primitive = writer.square(material=writer.textured(RED_GREEN, wrapS=10497), TEXCOORD_0=uv)
    writer.node(name="a", mesh=writer.mesh(primitive))
    place: Any = writer.document
    for step in path[:-1]:
        place = place[step]
    place[path[-1]] = value
    return writer


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        (["asset"], {"version": "1.0"}, "glTF 1.0"),
        (["asset"], {}, "asset.version"),
        (["scene"], 3, "scene 3"),
        (["scenes", 0, "nodes"], [7], "node 7"),
        (["nodes", 0, "mesh"], 7, "mesh 7"),
        (["nodes", 0, "matrix"], [1.0], "nodes.0.matrix"),
        (["meshes", 0, "primitives", 0, "material"], 9, "material 9"),
        (["meshes", 0, "primitives", 0, "indices"], 99, "accessor 99"),
        (["meshes", 0, "primitives", 0, "attributes", "POSITION"], 0, "POSITION has 2 numbers"),
        (["accessors", 1, "count"], 9, "reaches beyond"),
        (["accessors", 1, "count"], 2, "uses vertex 3"),
        (["accessors", 0, "count"], 2, "TEXCOORD_0 has 2 entries"),
        (["accessors", 1, "componentType"], 4242, "componentType"),
        (["bufferViews", 0, "byteLength"], 10**9, "cut off"),
        (["bufferViews", 0, "buffer"], 3, "buffer 3"),
        (["textures", 0, "source"], 5, "image 5"),
        (["textures", 0, "sampler"], 5, "sampler 5"),
        (["textures"], [{"extensions": {"MSFT_texture_dds": {"source": 0}}}], "MSFT_texture_dds"),
        (["extensionsRequired"], ["KHR_draco_mesh_compression"], "KHR_draco_mesh_compression"),
    ],
)
def test_broken_documents(tmp_path: Path, path: list[Any], value: Any, words: str) -> None:
    file = invalid(path, value).write(tmp_path / "a.glb")
    with pytest.raises(SceneError) as caught:
        read_scene(file)
    message = str(caught.value)
    assert words in message
    assert "a.glb" in message
    assert "\n" not in message


@pytest.mark.parametrize(
    ("image", "words"),
    [
        ({}, "neither bytes nor a file"),
        ({"bufferView": 0}, "cannot be decoded"),
        ({"uri": "data:image/png;base64,!!!"}, "cannot be decoded"),
        ({"uri": "textures/wood.png"}, "textures/wood.png"),
    ],
)
def test_a_texture_that_is_missing_or_broken_leaves_a_plain_colour(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, image: dict[str, Any], words: str
) -> None:
    writer = invalid(["images", 0], image)
    surface = writer.document["materials"][0]["pbrMetallicRoughness"]
    surface["baseColorFactor"] = [1.0, 0.0, 0.0, 1.0]
    scene = read_scene(writer.write(tmp_path / "a.glb"))
    used = scene.materials[scene.face_material[0]]
    assert used.texture is None
    assert used.color == pytest.approx((1.0, 0.0, 0.0))
    (message,) = caplog.messages
    assert words in message
    assert "plain colour" in message


def test_a_node_that_is_listed_twice_is_shown_once(tmp_path: Path) -> None:
    writer = GltfWriter()
    lamp = writer.node(name="Lamp", mesh=writer.mesh(writer.square()))
    writer.document["scenes"][0]["nodes"].append(lamp)
    writer.node(name="Room", children=[lamp])
    writer.document["nodes"][lamp]["children"] = [lamp]
    scene = read_scene(writer.write(tmp_path / "a.glb"))
    assert [instance.name for instance in scene.instances] == ["Lamp"]


def test_text_that_is_no_gltf(tmp_path: Path) -> None:
    (tmp_path / "a.gltf").write_text("hello")
    with pytest.raises(SceneError, match="JSON part cannot be read"):
        read_scene(tmp_path / "a.gltf")


def copies(attributes: dict[str, np.ndarray], **more: Any) -> GltfWriter:
    writer = GltfWriter()
    numbers = {
        name: writer.array(values, **({"normalized": True} if values.dtype != np.float32 else {}))
        for name, values in attributes.items()
    }
    extensions = {"EXT_mesh_gpu_instancing": {"attributes": numbers}}
    mesh = writer.mesh(writer.square())
    writer.node(name="Chair", mesh=mesh, translation=[0, 0, 5], extensions=extensions, **more)
    return writer


@pytest.mark.parametrize("kind", [np.float32, np.int8, np.int16])
def test_copies_of_a_mesh_are_objects_of_their_own(tmp_path: Path, kind: type) -> None:
    half = np.array([[0, 0, 0, 1], [0, np.sqrt(0.5), 0, np.sqrt(0.5)]])
    scaled = half if kind is np.float32 else np.rint(half * np.iinfo(kind).max)
    attributes = {
        "TRANSLATION": np.array([[0, 0, 0], [4, 0, 0]], np.float32),
        "ROTATION": scaled.astype(kind),
        "SCALE": np.array([[1, 1, 1], [2, 2, 2]], np.float32),
    }
    writer = copies(attributes)
    writer.document["extensionsRequired"] = ["EXT_mesh_gpu_instancing"]
    scene = read_scene(writer.write(tmp_path / "a.glb"))
    first, second = scene.instances
    assert (first.name, second.name) == ("Chair", "Chair#2")
    assert {i.label.category for i in scene.instances if i.label} == {"chair"}
    np.testing.assert_allclose(first.box_min, [0, -5, 0], atol=1e-5)
    # A quarter turn about glTF's y axis takes x to -z, which is y of the scene frame.
    np.testing.assert_allclose(second.box_min, [4, -5, 0], atol=0.02)
    np.testing.assert_allclose(second.box_max, [4, -3, 2], atol=0.02)


def test_copies_with_transforms_of_different_number_are_refused(tmp_path: Path) -> None:
    attributes = {
        "TRANSLATION": np.zeros((2, 3), np.float32),
        "SCALE": np.ones((3, 3), np.float32),
    }
    with pytest.raises(SceneError, match="different number"):
        read_scene(copies(attributes).write(tmp_path / "a.glb"))


@pytest.mark.parametrize("name", ["instanced.glb", "instanced_opt.glb"])
def test_a_public_file_shows_all_its_copies(test_data: Path, name: str) -> None:
    scene = read_scene(test_data / "field" / "12-instancing" / name)
    assert sum(i.label is not None and i.label.category == "chair" for i in scene.instances) == 4


@pytest.mark.parametrize(
    ("place", "name", "named"),
    [
        ("nodes", "EXT_of_the_future", True),
        ("primitives", "KHR_draco_mesh_compression", True),
        ("bufferViews", "EXT_meshopt_compression", True),
        ("document", "CESIUM_RTC", True),
        ("nodes", "KHR_lights_punctual", False),
        ("primitives", "KHR_materials_variants", False),
        ("materials", "ADOBE_of_the_future", False),
    ],
)
def test_an_unread_extension_is_named_where_it_may_change_surfaces(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, place: str, name: str, named: bool
) -> None:
    writer = GltfWriter()
    writer.add("materials", {})
    writer.node(name="Bed", mesh=writer.mesh(writer.square()))
    document = writer.document
    document["extensionsUsed"] = [name]
    items = {"primitives": document["meshes"][0]["primitives"], "document": [document]}
    (items.get(place) or document[place])[0]["extensions"] = {name: {}}
    assert len(read_scene(writer.write(tmp_path / "a.glb")).faces) == 2
    assert any(name in message for message in caplog.messages) == named


def test_a_buffer_without_its_fallback_is_named_by_its_extension(tmp_path: Path) -> None:
    writer = GltfWriter()
    writer.node(name="Bed", mesh=writer.mesh(writer.square()))
    writer.document["bufferViews"][0] |= {
        "buffer": 1,
        "extensions": {"EXT_meshopt_compression": {}},
    }
    path = writer.write(tmp_path / "a.glb")
    writer.document["buffers"].append({"byteLength": 48})
    text = json.dumps(writer.document | {"buffers": [{"byteLength": 9}, {"byteLength": 48}]})
    path = tmp_path / "a.gltf"
    path.write_text(text)
    with pytest.raises(SceneError, match="EXT_meshopt_compression"):
        read_scene(path)


def test_hidden_nodes_and_lower_levels_of_detail_are_not_shown(tmp_path: Path) -> None:
    writer = GltfWriter()
    mesh = writer.mesh(writer.square())
    low = writer.node(name="Bed_LOD1", mesh=mesh)
    writer.node(name="Bed", mesh=mesh, extensions={"MSFT_lod": {"ids": [low]}})
    hidden = {"KHR_node_visibility": {"visible": False}}
    inner = writer.node(root=False, name="Lamp", mesh=mesh)
    writer.node(name="Hidden", children=[inner], extensions=hidden)
    scene = read_scene(writer.write(tmp_path / "a.glb"))
    assert [instance.name for instance in scene.instances] == ["Bed"]


def test_a_skin_holds_its_mesh_where_it_was_bound(tmp_path: Path) -> None:
    writer = GltfWriter()
    joint = writer.node(name="Joint", translation=[0.0, 3.0, 0.0])
    bound = np.eye(4, dtype=np.float32)
    bound[:3, 3] = [0.0, -1.0, 0.0]
    inverse = writer.array(np.ascontiguousarray(bound.T).reshape(1, 16))
    skin = writer.add("skins", {"joints": [joint], "inverseBindMatrices": inverse})
    mesh = writer.mesh(writer.square())
    shown = writer.node(root=False, name="Curtain", mesh=mesh, skin=skin, translation=[0, 50, 0])
    writer.node(name="Armature", children=[shown], scale=[100.0, 100.0, 100.0])
    scene = read_scene(writer.write(tmp_path / "a.glb"))
    np.testing.assert_allclose(scene.instances[0].box_min, [0, 0, 2], atol=1e-6)
    np.testing.assert_allclose(scene.instances[0].box_max, [1, 0, 3], atol=1e-6)
