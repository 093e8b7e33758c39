import numpy as np
import pytest

from hypernav.app.cli.main import main
from hypernav.simulator.worlds.navmesh.navmesh_reader import read_navmesh
from scan_writers.buildings import two_storeys
from scan_writers.scans import write_scan


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("HYPERNAV_CACHE", str(tmp_path / "cache"))


@pytest.fixture
def scan(tmp_path):
    return write_scan(two_storeys(), tmp_path / "val" / "00802-wcojb4TFT35")


def hypernav(*arguments):
    """Run the command; returns its exit status."""
    with pytest.raises(SystemExit) as stop:
        main([str(argument) for argument in arguments])
    return stop.value.code


@pytest.mark.slow
def test_a_mesh_is_written_for_the_robot_that_is_asked_for(scan, tmp_path, capsys):
    out = tmp_path / "new" / "scan.navmesh"
    robot = ("--radius", 0.17, "--height", 1.41)
    assert hypernav("scene", "mesh", scan, "--out", out, *robot) == 0
    settings = read_navmesh(out).settings
    assert settings is not None
    assert np.isclose([settings["agent_radius"], settings["agent_height"]], [0.17, 1.41]).all()
    assert "for a robot of radius 0.17 m and height 1.41 m" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--height", "0"), "--height 0.0: height of the robot, metres; expected 0.2 to 10.0"),
        (("--radius", "5"), "is there a floor that the robot fits on"),
    ],
)
def test_a_robot_that_fits_nowhere_is_refused_in_one_line(scan, tmp_path, capsys, options, words):
    out = tmp_path / "scan.navmesh"
    assert hypernav("scene", "mesh", scan, "--out", out, *options) == 2
    said = capsys.readouterr().err
    assert words in said
    assert said.count("\n") == 1
    assert not out.exists()
