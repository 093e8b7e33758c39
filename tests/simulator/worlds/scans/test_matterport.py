"""Matterport3D's annotation gives the instances that habitat-sim gives."""

import numpy as np
import pytest

from hypernav.core.errors import SceneError
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel
from hypernav.simulator.worlds.scans.matterport import read_house
from hypernav.simulator.worlds.scans.scan_loading import (
    ScanFiles,
    cached_scan,
    load_scan,
    open_scene,
)
from scan_writers.buildings import two_storeys
from scan_writers.matterport import house_lines, name_of, semantic_ply, write_annotation
from scan_writers.scans import write_visual

HOUSE = two_storeys()
STEM = "17DRP5sb8fy"


@pytest.fixture
def scan(tmp_path):
    path = write_visual(HOUSE, tmp_path / STEM / f"{STEM}.glb")
    write_annotation(HOUSE, path.parent)
    return path


def beside(scan, ending):
    return scan.with_name(f"{STEM}{ending}")


def test_every_object_is_an_instance_with_its_box_under_the_episodes_name(scan):
    scene = open_scene(scan)
    found = {i.name: (i.box_min, i.box_max) for i in scene.instances[1:]}
    assert set(found) == {name_of(HOUSE, thing) for thing in HOUSE.things}
    for thing in HOUSE.things:
        low, high = found[name_of(HOUSE, thing)]
        assert np.allclose(low, thing.low, atol=1e-5)
        assert np.allclose(high, thing.high, atol=1e-5)


def test_categories_are_those_of_the_task_and_the_annotators_words_fit_too(scan):
    labels = [i.label for i in open_scene(scan).instances if i.label is not None]
    tv = next(label for label in labels if "television" in label.synonyms)
    assert tv == ObjectLabel("tv monitor", ("television",))
    for text in ("tv monitor", "television"):
        assert tv.satisfies(Goal(text))
    assert all(label.category not in ("wall", "floor", "ceiling") for label in labels)


def test_the_cache_keeps_the_names(scan, tmp_path):
    files = ScanFiles.of(scan)
    assert files is not None
    for _ in range(2):
        found = cached_scan(files, load_scan, folder=tmp_path / "cache", least_bytes=0)
        assert found.instances == load_scan(files).instances


def test_objects_of_no_region_or_category_are_kept(tmp_path):
    path = tmp_path / "x.house"
    path.write_text("ASCII 1.1\nO 4 -1 -1 0 0 0 1 0 0 0 1 0 1 1 1 0\n\n")
    (found,) = read_house(path)
    assert (found.id, found.mark, found.name, found.category) == (4, 4, "_4", "unknown")


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        (["HM3D Semantic Annotations"], "expected the first line 'ASCII 1.1'"),
        (["ASCII 1.1", "O 1 2"], "line 2 is no record"),
        (["ASCII 1.1", "O -1 0 0 0"], "line 2 is no record"),
        (["ASCII 1.1", "R x 0 0"], "line 2 is no record"),
        (["ASCII 1.1", "C 0 0 chair"], "line 2 is no record"),
        ([], "expected the first line"),
    ],
)
def test_what_is_no_house_is_one_error(scan, lines, words):
    beside(scan, ".house").write_text("\n".join(lines))
    with pytest.raises(SceneError, match=words):
        open_scene(scan)


PLY = semantic_ply(HOUSE)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (b"ply", b"obj", "expected a PLY file"),
        (b"end_header", b"end_of_hea", "expected a PLY file"),
        (b"binary_little_endian", b"ascii", "binary_little_endian, got ascii"),
        (b"property int object_id", b"property int material", "object_id"),
        (b"vertex_indices", b"vertex_numbers", "vertex_ind"),
        (b"property float x", b"property real x", "real"),
        (b"element face ", b"element face 9", "bytes of 'face', got fewer"),
        (b"element face ", b"element face -", "counts from 0 on"),
        (PLY[-4 - 13 : -4], b"\x04" + PLY[-4 - 12 : -4], "expected triangles"),
        (PLY[-8:-4], b"\xff\xff\xff\x7f", "vertex numbers that are there"),
    ],
)
def test_what_is_no_semantic_mesh_is_one_error(scan, old, new, words):
    assert old in PLY
    head, found, tail = PLY.rpartition(old) if old in PLY[-20:] else PLY.partition(old)
    assert found
    beside(scan, "_semantic.ply").write_bytes(head + new + tail)
    with pytest.raises(SceneError, match=words):
        open_scene(scan)


def test_without_its_mesh_the_scene_has_no_labels(scan):
    beside(scan, "_semantic.ply").unlink()
    assert {instance.label for instance in open_scene(scan).instances} == {None}


def test_records_that_nobody_needs_are_passed_over(scan):
    lines = [*house_lines(HOUSE), "P 0 1 2", "I", "?", ""]
    beside(scan, ".house").write_text("\n".join(lines))
    assert len(open_scene(scan).instances) == len(HOUSE.things) + 1
