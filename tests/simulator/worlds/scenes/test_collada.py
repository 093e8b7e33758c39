from pathlib import Path

import cv2
import numpy as np
import pytest

from dae_writer import INPUTS, POLYLIST, SHOWN, dae, write_dae
from hypernav.core.errors import SceneError
from hypernav.simulator.worlds.scenes.loading import read_scene
from hypernav.simulator.worlds.scenes.scene import Scene


def loaded(folder: Path, text: str | None = None) -> Scene:
    return read_scene(write_dae(folder / "room.dae", text))


def corners(scene: Scene) -> set[tuple[float, ...]]:
    return {tuple(row) for row in np.round(scene.vertices.astype(float), 4).tolist()}


SQUARE = {(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.0)}


def test_a_node_is_an_instance_with_the_paint_of_its_mesh(tmp_path: Path) -> None:
    scene = loaded(tmp_path)
    assert [(item.name, item.label and item.label.category) for item in scene.instances] == [
        ("Bed_01", "bed")
    ]
    assert corners(scene) == SQUARE
    assert scene.materials[scene.face_material[0]].color == (1.0, 0.0, 0.0)
    np.testing.assert_array_equal(scene.uv, scene.vertices[scene.faces][:, :, :2])


@pytest.mark.parametrize(
    "primitive",
    [
        f"<triangles>{INPUTS}<p>0 0 1 1 2 2 0 0 2 2 3 3</p></triangles>",
        f"<polygons>{INPUTS}<p>0 0 1 1 2 2 3 3</p></polygons>",
        f"<tristrips>{INPUTS}<p>0 0 1 1 3 3 2 2</p></tristrips>",
        f"<trifans>{INPUTS}<p>0 0 1 1 2 2 3 3</p></trifans>",
    ],
)
def test_every_kind_of_polygon_gives_the_same_surface(tmp_path: Path, primitive: str) -> None:
    scene = loaded(tmp_path, dae(primitive=primitive))
    sides = scene.vertices[scene.faces]
    areas = np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0])
    np.testing.assert_allclose(areas, [[0.0, 0.0, 1.0]] * 2)


@pytest.mark.parametrize(
    ("asset", "far"),
    [
        ('<unit meter="0.01"/><up_axis>Z_UP</up_axis>', (0.01, 0.01, 0.0)),
        ("<up_axis>Y_UP</up_axis>", (1.0, 0.0, 1.0)),
        ("", (1.0, 0.0, 1.0)),
    ],
)
def test_units_and_the_upward_axis_are_those_of_the_file(
    tmp_path: Path, asset: str, far: tuple[float, ...]
) -> None:
    assert far in corners(loaded(tmp_path, dae(asset=asset)))


def test_the_first_step_of_a_node_is_applied_last_and_parents_move_children(
    tmp_path: Path,
) -> None:
    steps = "<translate>5 0 0</translate><rotate>0 0 1 90</rotate><scale>2 1 1</scale>"
    child = f'<node name="Bed">{steps}{SHOWN}</node>'
    scene = loaded(tmp_path, dae(f"<node><translate>0 0 3</translate>{child}</node>"))
    assert corners(scene) == {(5, 0, 3), (5, 2, 3), (4, 2, 3), (4, 0, 3)}


def test_nodes_of_a_library_and_skins_are_shown(tmp_path: Path) -> None:
    more = f"""<library_nodes><node id="kept"><node name="Lamp">{SHOWN}</node></node>
    </library_nodes>
    <library_controllers><controller id="skinned"><skin source="#square"><bind_shape_matrix>
    1 0 0 0 0 1 0 0 0 0 1 7 0 0 0 1</bind_shape_matrix></skin></controller></library_controllers>"""
    nodes = """<node name="a"><instance_node url="#kept"/></node>
    <node name="Robot"><instance_controller url="#skinned"/></node>"""
    scene = loaded(tmp_path, dae(nodes, more=more))
    assert {item.name for item in scene.instances} == {"Lamp", "Robot"}
    assert (0.0, 0.0, 7.0) in corners(scene)


def test_a_texture_lies_beside_the_file_and_a_missing_one_is_named(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    text = dae(diffuse='<texture texture="sampler" texcoord="UV"/>')
    assert all(material.texture is None for material in loaded(tmp_path, text).materials)
    assert "paint.png" in caplog.text
    cv2.imwrite(str(tmp_path / "paint.png"), np.full((2, 2, 3), (0, 0, 255), np.uint8))
    scene = loaded(tmp_path, text)
    texture = scene.materials[scene.face_material[0]].texture
    assert texture is not None
    np.testing.assert_array_equal(texture[0, 0], [255, 0, 0])


@pytest.mark.parametrize(
    "text",
    [
        "<COLLADA>",
        "<svg/>",
        dae(primitive=f"<triangles>{INPUTS}<p>0 0 1 1 9 9</p></triangles>"),
        dae(primitive=f"<triangles>{INPUTS}<p>0 0 1 1 x 9</p></triangles>"),
        dae(primitive=POLYLIST.replace('offset="1"', 'offset="-5"')),
        dae("<node><matrix>1 2 3</matrix></node>"),
        '<!DOCTYPE a [<!ENTITY b "c">]><COLLADA/>',
        dae('<node id="n"><instance_node url="#n"/></node>'),
    ],
)
def test_a_broken_file_is_refused(tmp_path: Path, text: str) -> None:
    with pytest.raises(SceneError, match="export"):
        loaded(tmp_path, text)


def test_a_geometry_names_what_its_node_does_not(tmp_path: Path) -> None:
    text = dae(f'<node name="node_3">{SHOWN}</node><node name="Bed_01">{SHOWN}</node>')
    scene = loaded(tmp_path, text.replace('name="square"', 'name="Stühle_02"'))
    kinds = {item.name: item.label and item.label.category for item in scene.instances}
    assert kinds == {"node_3": "stühle", "Bed_01": "bed"}
