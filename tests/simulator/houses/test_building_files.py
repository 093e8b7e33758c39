import json
from pathlib import Path

import numpy as np
import pytest
import trimesh

from hypernav.core.errors import SceneError
from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel
from hypernav.lab.datasets.building_splits import SPLITS
from hypernav.simulator.houses.building import BUILTIN_HOUSE, house
from hypernav.simulator.houses.export.building_files import (
    ExportedBuilding,
    describe,
    export_building,
    write_dataset_config,
)
from hypernav.simulator.houses.export.building_page import building_page
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer
from hypernav.simulator.worlds.navmesh.navmesh_surface import NavmeshSurface
from hypernav.simulator.worlds.scenes.loading import read_scene
from hypernav.simulator.worlds.scenes.scene import Scene
from hypernav.simulator.worlds.surface.walkable import WalkableGrid

NUMBER = BUILTIN_HOUSE


@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> ExportedBuilding:
    return export_building(house(NUMBER), tmp_path_factory.mktemp("house") / "new")


@pytest.fixture(scope="module")
def loaded(exported: ExportedBuilding) -> Scene:
    return read_scene(exported.glb)


def distinct(faces: np.ndarray) -> int:
    """Number of triangles, a front and its back counted once."""
    return len(np.unique(np.sort(faces, axis=1), axis=0))


def test_all_instances_come_back_with_their_labels(builtin_scene: Scene, loaded: Scene):
    by_name = {i.name: i for i in loaded.instances}
    assert set(by_name) == {i.name for i in builtin_scene.instances}
    for instance in builtin_scene.instances:
        other = by_name[instance.name]
        assert other.label == instance.label
        assert np.allclose(other.box_min, instance.box_min, atol=1e-4)
        assert np.allclose(other.box_max, instance.box_max, atol=1e-4)
    assert distinct(loaded.faces) == distinct(builtin_scene.faces)


@pytest.mark.parametrize("door", [export_building, building_page])
def test_a_building_of_a_frozen_split_that_is_drawn_differently_is_refused(
    door, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    name = next(name for name, split in SPLITS.items() if split.kind == "houses")
    other = {name: {str(NUMBER): {"geometry": "0" * 16}}}
    monkeypatch.setattr("hypernav.lab.datasets.shipped.shipped_buildings", lambda: other)
    with pytest.raises(SceneError, match="is drawn differently here"):
        door(house(NUMBER), tmp_path / "new")
    assert not (tmp_path / "new").exists()


def test_it_looks_the_same(builtin_scene: Scene, loaded: Scene):
    camera = PinholeCamera.from_hfov(160, 120, 79.0)
    bed = next(i for i in builtin_scene.instances if i.label and i.label.category == "bed")
    x, y = bed.box_max[0] + 0.4, (bed.box_min[1] + bed.box_max[1]) / 2
    pose = Pose2(x, y, np.pi).to_transform() @ optical_to_base(1.2, 10.0)
    one, two = (CpuRenderer(s).render(camera, pose).rgb for s in (builtin_scene, loaded))
    difference = np.abs(one.astype(int) - two.astype(int))
    assert (difference > 8).mean() < 0.01


def test_other_readers_open_the_file(exported: ExportedBuilding, builtin_scene: Scene):
    scene = trimesh.load(exported.glb)
    assert isinstance(scene, trimesh.Scene)
    assert len(scene.graph.nodes_geometry) >= len(builtin_scene.instances)
    low, high = scene.bounds
    # glTF is y up.
    assert high[1] == pytest.approx(builtin_scene.vertices[:, 2].max(), abs=1e-3)
    assert low[0] == pytest.approx(builtin_scene.vertices[:, 0].min(), abs=1e-3)


def test_objects_have_the_known_format(exported: ExportedBuilding, builtin_scene: Scene):
    objects = json.loads(exported.objects.read_text())["objects"]
    assert [o["id"] for o in objects] == list(range(len(builtin_scene.instances)))
    sofa = next(o for o in objects if o["category"] == "sofa")
    assert sofa["nodes"] == [sofa["name"]]
    assert not sofa["structural"]
    (x0, y0, z0), (x1, y1, z1) = sofa["aabb_zup"]
    assert sofa["aabb_gltf"] == [[x0, z0, -y1], [x1, z1, -y0]]
    assert sofa["room"] == "living room"
    assert "couch" in sofa["synonyms"]
    assert sofa["description"].endswith("in the living room")
    assert any(o["structural"] and o["category"] == "wall" for o in objects)


def test_a_description_is_true_of_its_object(builtin_scene: Scene):
    for label in [i.label for i in builtin_scene.instances if i.label is not None]:
        assert label.satisfies(Goal(describe(label))), describe(label)


def test_descriptions_read_well():
    beside = ("L-shaped sofa", "coffee table")
    label = ObjectLabel("sofa", ("L-shaped sofa",), ("teal", "L-shaped"), "living room", beside)
    assert describe(label) == "teal L-shaped sofa beside the coffee table in the living room"
    assert describe(ObjectLabel("sofa")) == "sofa"


def test_habitat_finds_its_semantics(exported: ExportedBuilding, builtin_scene: Scene):
    config = json.loads(write_dataset_config(exported.glb.parent).read_text())
    stage = config["stages"]["default_attributes"]
    assert config["stages"]["paths"][".glb"] == [exported.glb.name]
    for key, path in (
        ("semantic_asset", exported.semantic_glb),
        ("semantic_descriptor_filename", exported.semantic_txt),
        ("nav_asset", exported.navmesh),
    ):
        name = stage[key].replace("%%CONFIG_NAME_AS_ASSET_FILENAME%%", exported.glb.stem)
        assert name == path.name
    lines = exported.semantic_txt.read_text().splitlines()
    assert lines[0] == "HM3D Semantic Annotations"
    rows = [line.split(",") for line in lines[1:]]
    assert [int(r[0]) for r in rows] == list(range(1, len(builtin_scene.instances) + 1))
    assert len({r[1] for r in rows}) == len(rows)
    mesh = trimesh.load(exported.semantic_glb, force="mesh")
    assert isinstance(mesh, trimesh.Trimesh)
    assert distinct(mesh.faces) == distinct(builtin_scene.faces)


def test_a_folder_that_cannot_be_made_is_an_error(tmp_path: Path):
    blocked = tmp_path / "file"
    blocked.write_text("in the way")
    with pytest.raises(SceneError, match="cannot be written"):
        export_building(house(NUMBER), blocked / "house")


@pytest.mark.slow
def test_the_page_shows_all(tmp_path: Path):
    page = building_page(house(NUMBER), tmp_path / "pages")
    text = page.read_text()
    assert page.name == f"house_{NUMBER}.html"
    assert "<svg" in text
    png = "data:image/png;base64,"
    assert text.count(f'<img class="view" src="{png}') == 5  # one from above, four inside
    assert text.count(f'"image": "{png}') == 1  # the one floor in three dimensions
    assert "refrigerator" in text
    assert "http://www.w3.org/2000/svg" in text
    assert 'src="http' not in text


def test_paths_on_its_navigation_mesh_are_as_long_as_on_our_own_surface(
    builtin_scene: Scene, exported: ExportedBuilding
):
    surface, grid = NavmeshSurface.load(exported.navmesh), WalkableGrid.from_scene(builtin_scene)
    assert surface.navmesh.area_m2 == pytest.approx(grid.area_m2(), rel=0.005)
    rng = np.random.default_rng(0)
    ratios = []
    for _ in range(200):
        start, end = grid.random_point(rng), grid.random_point(rng)
        length = surface.distance((*start, grid.height_at(*start)), (*end, grid.height_at(*end)))
        if grid.distance(start, end) > 0.5:
            ratios.append(length / grid.distance(start, end))
    # Detour's search over the middles of sides doesn't always find the shortest corridor.
    assert np.quantile(np.abs(np.array(ratios) - 1.0), 0.95) < 0.02
    assert max(ratios) < 1.1
