"""Which mesh a robot walks on in a scan, and that a computed one is kept."""

from dataclasses import replace
from pathlib import Path

import pytest

from hypernav.core.embodiment import BodyConfig
from hypernav.core.errors import NavmeshError
from hypernav.simulator.worlds.config import NavmeshChoice
from hypernav.simulator.worlds.navmesh.navmesh import Navmesh
from hypernav.simulator.worlds.navmesh.robot_navmesh import computed_for, is_computed, robot_navmesh
from hypernav.simulator.worlds.scans.scan_loading import open_scene
from hypernav.simulator.worlds.scenes.scene import Scene
from scan_writers.buildings import two_storeys
from scan_writers.scans import write_scan

SMALL = BodyConfig()
TALL = BodyConfig(radius_m=0.17, height_m=1.41)


@pytest.fixture(scope="module")
def scan(tmp_path_factory: pytest.TempPathFactory) -> Scene:
    """A scan whose file was made for the small robot."""
    folder = tmp_path_factory.mktemp("val")
    scene = open_scene(write_scan(two_storeys(), folder / "00802-wcojb4TFT35"))
    return replace(scene, cache=folder / "cache")


def mesh_of(scan: Scene, body: BodyConfig, choice: NavmeshChoice) -> Navmesh:
    navmesh = robot_navmesh(scan, body, choice)
    assert navmesh is not None
    return navmesh


def area(navmesh: Navmesh) -> float:
    return navmesh.area_m2


def test_the_file_serves_the_robot_that_it_was_made_for(scan: Scene) -> None:
    assert scan.navmesh is not None
    file = Navmesh.load(scan.navmesh)
    assert not is_computed(scan.navmesh, SMALL, "auto")
    assert area(mesh_of(scan, SMALL, "auto")) == area(file)
    assert area(mesh_of(scan, TALL, "file")) == area(file)


def test_another_robot_walks_on_a_mesh_of_its_own(scan: Scene) -> None:
    assert scan.navmesh is not None
    assert is_computed(scan.navmesh, TALL, "auto")
    tall, small = mesh_of(scan, TALL, "auto"), mesh_of(scan, SMALL, "robot")
    assert len({area(tall), area(small), area(Navmesh.load(scan.navmesh))}) == 3


def test_a_computed_mesh_is_kept_by_robot(scan: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    kept = {body.radius_m: computed_for(scan, body) for body in (SMALL, TALL)}
    assert len(set(kept.values())) == 2
    monkeypatch.setattr("hypernav.simulator.worlds.navmesh.robot_navmesh.compute_navmesh", None)
    assert {body.radius_m: computed_for(scan, body) for body in (SMALL, TALL)} == kept


def test_a_scene_without_a_file_has_a_mesh_only_if_it_is_asked_for(scan: Scene) -> None:
    bare = replace(scan, navmesh=None)
    assert robot_navmesh(bare, SMALL, "auto") is None
    assert robot_navmesh(bare, SMALL, "file") is None
    assert area(mesh_of(bare, SMALL, "robot")) == area(mesh_of(scan, SMALL, "robot"))


def test_a_broken_file_is_refused(scan: Scene, tmp_path: Path) -> None:
    broken = tmp_path / "broken.navmesh"
    broken.write_bytes(b"no mesh")
    with pytest.raises(NavmeshError, match="expected a file that begins with"):
        robot_navmesh(replace(scan, navmesh=broken), SMALL, "auto")
