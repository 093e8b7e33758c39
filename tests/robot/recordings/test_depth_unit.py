"""Depth in another unit than the format's is read when it is said, and doubted when it isn't."""

import numpy as np
import pytest
from PIL import Image

from frame_writers import write_matched_frames, write_tum
from hypernav.app.cli.main import main
from hypernav.robot.recordings.opening import open_recording


@pytest.fixture
def in_millimetres(tmp_path):
    """A recording in TUM's layout, with depth in millimetres."""
    write_tum(tmp_path)
    for path in tmp_path.glob("*.depth.png"):
        depth = np.rint(np.asarray(Image.open(path)) / 5.0).astype(np.uint16)
        Image.fromarray(depth).save(path)
    return tmp_path


def notes(folder, per_metre=None) -> str:
    return " ".join(open_recording(folder, depth_per_metre=per_metre).notes)


def test_the_unit_that_is_said_holds(in_millimetres, tmp_path_factory):
    (right := tmp_path_factory.mktemp("right"))
    write_tum(right)
    told = open_recording(right).frames[0].depth()
    seen = open_recording(in_millimetres, depth_per_metre=1000.0).frames[0].depth()
    assert np.abs(told - seen).max() < 0.002


def test_a_unit_that_contradicts_the_poses_is_doubted(in_millimetres):
    assert "agree with --depth-per-metre 1000" in notes(in_millimetres)
    assert notes(in_millimetres, 1000.0) == ""


def test_the_field_s_recording_is_doubted_and_its_twin_is_not(test_data):
    field = test_data / "field" / "13-tum-depth-in-mm"
    assert "--depth-per-metre 1000" in notes(field / "tum")
    assert notes(field / "tum", 1000.0) == notes(field / "right") == ""


def test_poses_in_millimetres_are_named(tmp_path):
    write_matched_frames(tmp_path)
    for path in tmp_path.glob("*.pose.txt"):
        pose = np.loadtxt(path)
        pose[:3, 3] *= 1000.0
        np.savetxt(path, pose)
    assert "or the poses are in millimetres" in notes(tmp_path)


TO_OPENGL = np.diag([1.0, -1.0, -1.0, 1.0])


@pytest.mark.parametrize(
    "misread", [lambda pose: pose @ TO_OPENGL, np.linalg.inv], ids=["OpenGL", "world to camera"]
)
def test_poses_of_another_convention_contradict_the_depth(misread, tmp_path):
    write_matched_frames(tmp_path)
    for path in tmp_path.glob("*.pose.txt"):
        np.savetxt(path, misread(np.loadtxt(path)))
    assert "contradict each other by" in notes(tmp_path)


@pytest.mark.parametrize("per_metre", [200.0, 5000.0])
def test_a_real_camera_is_doubted_in_wrong_units_only(per_metre, test_data):
    lounge = test_data / "rgbd" / "lounge"
    assert notes(lounge) == ""
    assert "agree with --depth-per-metre 1000" in notes(lounge, per_metre)


@pytest.mark.parametrize(
    ("per_metre", "said"), [(8000.0, "nearer than 0.38 m"), (150.0, "farther than 20 m")]
)
def test_a_camera_that_stands_still_is_doubted_by_what_is_near(per_metre, said, tmp_path):
    write_matched_frames(tmp_path)
    pose = (tmp_path / "frame-000000.pose.txt").read_text()
    for path in tmp_path.glob("*.depth.png"):
        Image.fromarray(np.full((120, 160), 3000, dtype=np.uint16)).save(path)
    for path in tmp_path.glob("*.pose.txt"):
        path.write_text(pose)
    assert said in notes(tmp_path, per_metre)
    assert "--depth-per-metre 1000 would make it 3 m" in notes(tmp_path, per_metre)
    assert notes(tmp_path) == ""


def test_the_command_says_the_doubt_and_takes_the_unit(in_millimetres, tmp_path_factory, capsys):
    out = tmp_path_factory.mktemp("out")
    for options in ([], ["--depth-per-metre", "1000"]):
        with pytest.raises(SystemExit) as left:
            main(["robot", "replay", str(in_millimetres), "--out", str(out), *options])
        assert left.value.code == 0
        assert ("--depth-per-metre 1000" in capsys.readouterr().err) == (options == [])


@pytest.mark.parametrize("value", ["0", "nan", "-5"])
def test_a_unit_that_cannot_be_is_a_mistake(value, in_millimetres, capsys):
    with pytest.raises(SystemExit) as left:
        main(["robot", "replay", str(in_millimetres), "--depth-per-metre", value])
    assert left.value.code == 2
    assert "--depth-per-metre" in capsys.readouterr().err
