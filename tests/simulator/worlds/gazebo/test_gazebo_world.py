from pathlib import Path

import numpy as np
import pytest

from dae_writer import SHOWN, dae, write_dae
from hypernav.core.errors import SceneError
from hypernav.simulator.worlds.scenes.loading import read_scene
from hypernav.simulator.worlds.scenes.scene import Scene

WALLS = "".join(
    f"""<model name="wall_{k}"><static>1</static><pose>{x} {y} 1 0 0 {yaw}</pose><link name="link">
    <visual name="visual"><geometry><box><size>8 0.1 2</size></box></geometry></visual></link>
    </model>"""
    for k, (x, y, yaw) in enumerate([(0, 4, 0), (0, -4, 0), (4, 0, 1.5707963), (-4, 0, 1.5707963)])
)
GROUND = "<include><uri>model://ground_plane</uri></include>"


@pytest.fixture(autouse=True)
def nothing_of_this_machine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.delenv("GAZEBO_MODEL_PATH", raising=False)


def loaded(folder: Path, *content: str) -> Scene:
    path = folder / "ws" / "worlds" / "test.world"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f'<sdf version="1.6"><world name="w">{"".join(content)}</world></sdf>')
    return read_scene(path)


def model(folder: Path, name: str, *, pose: str = "", mesh: str = "", uri: str = "") -> None:
    """A model of one mesh in a folder of its own."""
    uri = uri or f"model://{name}/meshes/it.dae"
    write_dae(folder / name / "meshes" / "it.dae", mesh or None)
    (folder / name / "model.config").write_text(
        '<model><sdf version="1.4">old.sdf</sdf><sdf version="1.6">model.sdf</sdf></model>'
    )
    (folder / name / "model.sdf").write_text(
        f"""<sdf version="1.6"><model name="{name}">{pose}<link name="link"><visual name="visual">
        <geometry><mesh><uri>{uri}</uri></mesh></geometry></visual></link></model></sdf>"""
    )


def boxes(scene: Scene) -> dict[str, tuple[tuple[float, ...], tuple[float, ...]]]:
    return {
        item.name: (
            tuple(np.round(item.box_min, 3).tolist()),
            tuple(np.round(item.box_max, 3).tolist()),
        )
        for item in scene.instances
    }


def categories(scene: Scene) -> dict[str, str | None]:
    return {item.name: item.label.category if item.label else None for item in scene.instances}


def test_a_world_is_a_building_of_models_named_as_it_names_them(tmp_path: Path) -> None:
    model(tmp_path / "ws" / "models", "sofa")
    include = """<include><uri>model://sofa</uri><name>Sofa_01</name><pose>1 2 0 0 0 0</pose>
    </include>"""
    scene = loaded(tmp_path, GROUND, WALLS, include)
    assert categories(scene) == {
        "ground_plane": None,
        **{f"wall_{k}": None for k in range(4)},
        "Sofa_01": "sofa",
    }
    assert boxes(scene)["Sofa_01"] == ((1.0, 2.0, 0.0), (2.0, 3.0, 0.0))
    assert boxes(scene)["wall_2"] == ((3.95, -4.0, 0.0), (4.05, 4.0, 2.0))
    assert boxes(scene)["ground_plane"] == ((-4.05, -4.05, 0.0), (4.05, 4.05, 0.0))


@pytest.mark.parametrize("place", ["beside", "variable", "home", "file"])
def test_models_are_found_where_gazebo_looks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, place: str
) -> None:
    folders = {
        "beside": tmp_path / "ws" / "models",
        "file": tmp_path / "ws" / "models",
        "variable": tmp_path / "elsewhere",
        "home": tmp_path / "home" / ".gazebo" / "models",
    }
    monkeypatch.setenv("GAZEBO_MODEL_PATH", str(tmp_path / "elsewhere"))
    uri = "file://models/sofa/meshes/it.dae" if place == "file" else ""
    model(folders[place], "sofa", uri=uri)
    scene = loaded(tmp_path, WALLS, "<include><uri>model://sofa</uri></include>")
    assert categories(scene)["sofa"] == "sofa"


def test_a_model_that_was_downloaded_from_fuel_is_found(tmp_path: Path) -> None:
    kept = tmp_path / "home" / ".gz" / "fuel" / "fuel.example.org" / "me" / "models" / "sofa"
    for version in (2, 10):
        model(kept, str(version), uri="meshes/it.dae")
    uri = "https://fuel.example.org/1.0/Me/models/Sofa"
    scene = loaded(tmp_path, WALLS, f"<include><uri>{uri}</uri></include>")
    assert categories(scene)["Sofa"] == "sofa"


def test_what_is_missing_or_broken_is_named_and_costs_nothing_else(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    models = tmp_path / "ws" / "models"
    model(models, "torn", mesh="<COLLADA>")
    model(models, "odd", uri="model://odd/meshes/it.blend")
    (models / "odd" / "meshes" / "it.blend").write_text("?")
    (models / "unsaid").mkdir()
    (models / "unsaid" / "model.sdf").write_text("<sdf>")
    names = ("torn", "odd", "unsaid", "absent")
    includes = "".join(f"<include><uri>model://{name}</uri></include>" for name in names)
    bad = '<model name="crooked"><pose>1 2 x</pose></model><actor name="walker"/>'
    scene = loaded(tmp_path, WALLS, includes, bad, "<include><uri>model://sun</uri></include>")
    assert set(categories(scene)) == {f"wall_{k}" for k in range(4)}
    for name in ("torn (", "odd (", "unsaid (", "absent (", "crooked ("):
        assert name in caplog.text
    assert "sun" not in caplog.text


def test_a_world_of_which_nothing_is_left_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"absent.*GAZEBO_MODEL_PATH"):
        loaded(tmp_path, "<include><uri>model://absent</uri></include>")


@pytest.mark.parametrize("text", ["<sdf>", "<robot/>", '<!DOCTYPE a [<!ENTITY b "c">]><sdf/>'])
def test_what_is_no_world_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "x.world"
    path.write_text(text)
    with pytest.raises(SceneError, match="Gazebo world"):
        read_scene(path)


def test_a_model_that_includes_itself_twice_ends(tmp_path: Path) -> None:
    folder = tmp_path / "ws" / "models" / "loop"
    folder.mkdir(parents=True)
    twice = "<include><uri>model://loop</uri></include>" * 2
    (folder / "model.sdf").write_text(f'<sdf><model name="loop">{twice}</model></sdf>')
    with pytest.raises(SceneError, match="models"):
        loaded(tmp_path, WALLS, "<include><uri>model://loop</uri></include>")


def test_things_stand_where_they_stood_when_the_world_was_saved(tmp_path: Path) -> None:
    state = (
        """<state world_name="w"><model name="wall_0"><pose>0 9 1 0 0 0</pose></model></state>"""
    )
    assert boxes(loaded(tmp_path, WALLS, state))["wall_0"][0] == (-4.0, 8.95, 0.0)


def test_an_included_thing_without_a_pose_stands_where_it_stood_then_too(tmp_path: Path) -> None:
    model(tmp_path / "ws" / "models", "sofa")
    state = """<state world_name="w"><model name="sofa"><pose>3 1 0 0 0 0</pose></model></state>"""
    include = "<include><uri>model://sofa</uri></include>"
    assert boxes(loaded(tmp_path, WALLS, include, state))["sofa"][0] == (3.0, 1.0, 0.0)


def test_a_broken_pose_of_a_saved_state_costs_nothing_else(tmp_path: Path) -> None:
    state = """<state world_name="w"><model name="wall_0"><pose>1 2</pose></model></state>"""
    assert boxes(loaded(tmp_path, WALLS, state))["wall_0"][0] == (-4.0, 3.95, 0.0)


def test_a_pose_may_name_an_include_by_its_element(tmp_path: Path) -> None:
    model(tmp_path / "ws" / "models", "sofa")
    includes = """<include><uri>model://sofa</uri><name>first</name><pose>1 0 0 0 0 0</pose>
    </include><include><uri>model://sofa</uri><name>second</name>
    <pose relative_to="first">1 0 0 0 0 0</pose></include>"""
    assert boxes(loaded(tmp_path, WALLS, includes))["second"][0] == (2.0, 0.0, 0.0)


def test_a_pose_may_name_a_sibling_and_an_include_replaces_the_models_own(tmp_path: Path) -> None:
    model(tmp_path / "ws" / "models", "sofa", pose="<pose>7 7 7 0 0 0</pose>")
    includes = """<include><uri>model://sofa</uri><name>kept</name></include>
    <include><uri>model://sofa</uri><name>moved</name><pose relative_to="wall_0">1 0 0 0 0 0</pose>
    </include>"""
    found = boxes(loaded(tmp_path, WALLS, includes))
    assert found["kept"][0] == (7.0, 7.0, 7.0)
    assert found["moved"][0] == (1.0, 4.0, 1.0)


def test_a_model_as_large_as_a_room_holds_things_of_its_own(tmp_path: Path) -> None:
    nodes = f"""<node name="Walls"><scale>20 20 1</scale>{SHOWN}</node>
    <node name="Desk_3">{SHOWN}</node><node name="mesh12">{SHOWN}</node>"""
    model(tmp_path / "ws" / "models", "office", mesh=dae(nodes))
    scene = loaded(tmp_path, "<include><uri>model://office</uri></include>")
    assert sorted(map(str, categories(scene).values())) == ["None", "desk", "square"]


@pytest.mark.parametrize(
    ("shape", "size"),
    [
        ("<box><size>1 2 3</size></box>", (1.0, 2.0, 3.0)),
        ("<cylinder><radius>0.5</radius><length>2</length></cylinder>", (1.0, 1.0, 2.0)),
        ("<sphere><radius>0.5</radius></sphere>", (1.0, 1.0, 1.0)),
        ("<capsule><radius>0.5</radius><length>2</length></capsule>", (1.0, 1.0, 3.0)),
        ("<cone><radius>0.5</radius><length>2</length></cone>", (1.0, 1.0, 2.0)),
        ("<ellipsoid><radii>0.5 1 1</radii></ellipsoid>", (1.0, 2.0, 2.0)),
        ("<plane><size>2 3</size></plane>", (2.0, 3.0, 0.0)),
        ("<plane><size>2 3</size><normal>1 0 0</normal></plane>", (0.0, 3.0, 2.0)),
    ],
)
def test_shapes_have_their_sizes_around_their_middle(
    tmp_path: Path, shape: str, size: tuple[float, ...]
) -> None:
    text = f"""<model name="thing"><pose>1 1 1 0 0 0</pose><link name="l"><visual name="v">
    <geometry>{shape}</geometry><material><script><name>Gazebo/Red</name></script></material>
    </visual></link></model>"""
    scene = loaded(tmp_path, WALLS, text)
    low, high = (np.array(corner) for corner in boxes(scene)["thing"])
    np.testing.assert_allclose((low + high) / 2.0, [1.0, 1.0, 1.0], atol=0.02)
    np.testing.assert_allclose(high - low, size, atol=0.05)
    faces = scene.face_instance == next(i.id for i in scene.instances if i.name == "thing")
    material = scene.materials[int(scene.face_material[faces][0])]
    assert material.color == (1.0, 0.0, 0.0)
    sides = scene.vertices[scene.faces[faces]].astype(float)
    outward = np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0])
    if min(size) > 0.0:
        assert (np.sum(outward * (sides.mean(axis=1) - 1.0), axis=1) > 0.0).all()


def test_a_script_gives_colour_and_texture_and_transparent_things_are_not_there(
    tmp_path: Path,
) -> None:
    scripts = tmp_path / "ws" / "models" / "paint" / "scripts"
    scripts.mkdir(parents=True)
    (scripts / "p.material").write_text(
        "material Mine\n{ technique { pass {\n diffuse 0 0 1 1\n}}}"
    )
    visual = """<visual name="v">{}<geometry><box><size>1 1 1</size></box></geometry><material>
    <script><uri>model://paint/scripts</uri><name>Mine</name></script></material></visual>"""
    link = f'<link name="l">{visual.format("")}</link>'
    hidden = f'<link name="l">{visual.format("<transparency>1</transparency>")}</link>'
    scene = loaded(
        tmp_path, f'<model name="seen">{link}</model><model name="ghost">{hidden}</model>'
    )
    assert set(categories(scene)) == {"seen"}
    assert scene.materials[int(scene.face_material[0])].color == (0.0, 0.0, 1.0)
