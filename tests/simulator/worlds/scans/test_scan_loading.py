"""Scans are read as Habitat reads them: z up, unlit, with the instances of their annotation."""

import numpy as np
import pytest

from hypernav.core.errors import SceneError
from hypernav.core.goal import Goal
from hypernav.simulator.worlds.scans.scan_annotations import read_annotations
from hypernav.simulator.worlds.scans.scan_loading import ScanFiles, open_scene
from scan_writers.buildings import two_storeys
from scan_writers.scans import (
    color_of,
    write_scan,
    write_semantic_colors,
    write_semantic_texture,
    write_visual,
)

HOUSE = two_storeys()
FOLDER = "00802-wcojb4TFT35"
STEM = "wcojb4TFT35"


@pytest.fixture(scope="module")
def scan(tmp_path_factory):
    return write_scan(HOUSE, tmp_path_factory.mktemp("val") / FOLDER)


def boxes(scene):
    return {i.name: (i.box_min, i.box_max) for i in scene.instances[1:]}


def assert_annotated(scene):
    """Every thing is an instance with its box, and every triangle belongs to its thing."""
    found = boxes(scene)
    for number, thing in enumerate(HOUSE.things, start=1):
        low, high = found[f"{thing.category}_{number}"]
        assert np.allclose(low, thing.low, atol=1e-5)
        assert np.allclose(high, thing.high, atol=1e-5)
    assert len(found) == len(HOUSE.things)
    assert np.bincount(scene.face_instance, minlength=len(found) + 1).tolist() == [
        0,
        *[12] * len(found),
    ]


def test_a_scan_stands_upright_and_has_its_light_in_its_textures(scan):
    scene = open_scene(scan)
    assert np.allclose(scene.vertices.min(axis=0), (-0.1, -0.1, -0.1))
    assert np.allclose(scene.vertices.max(axis=0), (9.1, 6.1, 5.5))
    assert scene.unlit
    assert scene.name == STEM


def test_vertex_colours_name_the_instances(scan):
    assert_annotated(open_scene(scan))


def test_colours_of_a_texture_name_the_instances(scan, tmp_path):
    mesh = write_scan(HOUSE, tmp_path / FOLDER)
    write_semantic_texture(HOUSE, mesh.with_name(f"{STEM}.semantic.glb"))
    assert_annotated(open_scene(mesh))


def test_linear_vertex_colours_are_recognised(tmp_path, monkeypatch):
    def linear(number):
        codes = np.array(color_of(number)) / 255.0
        light = np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)
        return tuple(light.astype(np.float32))

    mesh = write_scan(HOUSE, tmp_path / FOLDER)
    write_semantic_colors(HOUSE, mesh.with_name(f"{STEM}.semantic.glb"), light_of=linear)
    assert_annotated(open_scene(mesh))


def test_objects_are_found_by_the_annotators_words(scan):
    scene = open_scene(scan)

    def names(goal):
        return [i.name for i in scene.instances if i.label and i.label.satisfies(Goal(goal))]

    assert len(names("tv")) == 2
    assert len(names("couch")) == len(names("sofa")) == 1
    assert len(names("potted plant")) == len(names("plant")) == 1
    assert names("wall") == []


def test_what_nobody_annotated_is_the_building(tmp_path):
    mesh = write_scan(HOUSE, tmp_path / FOLDER)
    text = mesh.with_name(f"{STEM}.semantic.txt")
    lines = text.read_text().splitlines()
    text.write_text("\n".join([lines[0], *lines[-2:]]))
    scene = open_scene(mesh)
    assert [i.label and i.label.category for i in scene.instances] == [None, "tv", "television"]
    assert (scene.face_instance == 0).sum() == 12 * (len(HOUSE.things) - 2)


def test_a_scan_without_annotations_is_drawn_all_the_same(tmp_path):
    mesh = write_visual(HOUSE, tmp_path / FOLDER / f"{STEM}.glb")
    assert [i.label for i in open_scene(mesh).instances] == [None]


@pytest.mark.parametrize(
    ("path", "is_scan"),
    [
        (f"{FOLDER}/{STEM}.glb", True),
        (f"elsewhere/{STEM}.basis.glb", True),
        (f"elsewhere/{STEM}.glb", False),
        (f"{FOLDER}/other.glb", False),
        (f"{FOLDER}/{STEM}.obj", False),
    ],
)
def test_scans_are_known_by_the_names_of_their_files(tmp_path, path, is_scan):
    assert (ScanFiles.of(tmp_path / path) is not None) is is_scan


def test_a_building_that_we_exported_is_no_scan(tmp_path):
    for name in ("objects.json", "house_7.semantic.txt", "house_7.semantic.glb", "house_7.navmesh"):
        (tmp_path / name).write_bytes(b"")
    assert ScanFiles.of(tmp_path / "house_7.glb") is None


def test_a_matterport_scan_is_known_by_its_house_file(tmp_path):
    (tmp_path / "17DRP5sb8fy.house").write_text("ASCII 1.1\n")
    (tmp_path / "17DRP5sb8fy.navmesh").write_bytes(b"")
    files = ScanFiles.of(tmp_path / "17DRP5sb8fy.glb")
    assert files is not None
    assert files.navmesh == tmp_path / "17DRP5sb8fy.navmesh"


@pytest.mark.parametrize(
    ("line", "category"),
    [
        ('3,0A0B0C,"chair",2', "chair"),
        ('3,0A0B0C,"vase, "old", blue",2', 'vase, "old", blue'),
        ('3,0A0B0C,"a ""good"" one",2', 'a "good" one'),
        ("3,0A0B0C,chair,2", "chair"),
        ('3,0A0B0C,"",2', "unknown"),
        ('3,0A0B0C,"Stühle",-1', "Stühle"),
    ],
)
def test_awkward_categories(tmp_path, line, category):
    path = tmp_path / "x.semantic.txt"
    path.write_text(f"HM3D Semantic Annotations\n{line}\n\n", encoding="utf-8")
    (found,) = read_annotations(path)
    assert (found.id, found.mark, found.category) == (3, 0x0A0B0C, category)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "expected the first line"),
        ("something else\n1,000000,a,1", "expected the first line"),
        ("HM3D Semantic Annotations\n1,000000", "line 2 is no annotation"),
        ('HM3D Semantic Annotations\n\nx,000000,"a",1', "line 3 is no annotation"),
        ('HM3D Semantic Annotations\n1,00000G,"a",1', "line 2"),
        ('HM3D Semantic Annotations\n1,0,"a",1', "line 2"),
        ('HM3D Semantic Annotations\n1,000000,"a",b', "line 2"),
        ("HM3D Semantic Annotations\n" + "\n" * 70_000, "at most 65,535"),
    ],
)
def test_a_text_that_is_no_annotation_is_one_error(tmp_path, text, words):
    path = tmp_path / "x.semantic.txt"
    path.write_text(text)
    with pytest.raises(SceneError, match=words):
        read_annotations(path)
