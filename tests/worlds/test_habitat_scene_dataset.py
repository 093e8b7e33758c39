"""What habitat-sim is told of a scene before it opens it."""

import json
import shutil
from dataclasses import replace

import pytest

from hypernav.worlds.scans.scan_loading import open_scene
from scan_writers.episodes import HASH, SCENE


@pytest.fixture
def scan(benchmark_data, tmp_path):
    scenes = shutil.copytree(benchmark_data / "scene_datasets", tmp_path / "scene_datasets")
    return scenes / "hm3d" / "val" / SCENE / f"{HASH}.glb"


def test_a_scene_that_is_y_up_is_said_to_be_so_while_it_is_opened(scan):
    upright = replace(open_scene(scan), stored_z_up=False)
    with scene_dataset(upright, scan) as path:
        assert path is not None
        stages = json.loads(path.read_text())["stages"]
        assert stages["default_attributes"]["up"] == [0, 1, 0]
        assert stages["paths"][".glb"] == [str(scan.resolve())]
    assert not path.exists()


def test_a_scan_is_z_up_as_habitat_sim_assumes(scan):
    with scene_dataset(open_scene(scan), scan) as path:
        assert path is None


def test_the_configuration_of_a_data_set_above_a_scene_counts(scan):
    own = scan.parents[2] / "hm3d_basis.scene_dataset_config.json"
    own.write_text("{}")
    for stored_z_up in (False, True):
        scene = replace(open_scene(scan), stored_z_up=stored_z_up)
        with scene_dataset(scene, scan) as path:
            assert path == own.resolve()
