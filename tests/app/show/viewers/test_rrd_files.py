"""Searches as ``.rrd``, read back by rerun's own reader."""

import shutil
import subprocess
import sys
from contextlib import closing
from dataclasses import replace

import numpy as np
import pytest
from rerun.chunk import RrdReader

from full_disks import full_disk
from hypernav.app.show.video_frame import EpisodeInfo
from hypernav.app.show.viewers import rerun_view
from hypernav.app.show.viewers.rerun_view import RerunView, RrdView
from hypernav.core.errors import OutputError, ViewError

INFO = EpisodeInfo("bed", "hypernav", detector="ground truth", step_limit=100)


@pytest.fixture
def recorded(tmp_path, make_step, room, observation, sighting, result):
    path = tmp_path / "new" / "search.rrd"
    view = RrdView(path, INFO)
    for number in range(6):
        view.add(make_step(number, detections=[sighting], events=["a bump"]), room, observation)
    view.finish(result)
    view.close()
    return path


def rows_of(path, entity):
    """Rows of an entity, a dictionary of columns each, in the order of the steps."""
    rows = []
    for chunk in RrdReader(path).store().stream():
        if str(chunk.entity_path) == f"/{entity}":
            rows += chunk.to_record_batch().to_pylist()
    return sorted(rows, key=lambda row: row.get("step") or 0)


def values_of(row, component):
    """The values of the one column that ends so."""
    (column,) = (name for name in row if name.endswith(f":{component}"))
    return row[column]


def test_rerun_finds_no_fault_in_the_file(recorded):
    command = [sys.executable, "-m", "rerun_cli", "rrd", "verify", str(recorded)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert "without error" in done.stdout + done.stderr


@pytest.mark.parametrize(
    "entity",
    ["map/robot", "map/camera", "map/camera/image", "map/points", "map/cells", "map/path"],
)
def test_every_step_has_every_entity_on_one_timeline(recorded, entity):
    assert [row["step"] for row in rows_of(recorded, entity)] == list(range(6))


def test_the_points_lie_in_the_map(recorded, observation):
    points = np.array(values_of(rows_of(recorded, "map/points")[0], "positions"))
    in_camera = observation.camera_to_map.inverse().apply(points)
    np.testing.assert_allclose(in_camera[:, 2], 2.0, atol=1e-5)
    assert observation.camera.contains(observation.camera.project(in_camera)).all()


def test_on_another_floor_robot_and_map_lie_at_their_heights(
    tmp_path, make_step, room, observation
):
    path = tmp_path / "floors.rrd"
    with closing(RrdView(path, INFO)) as view:
        view.add(make_step(0), room, observation)
        view.add(make_step(1, mode="climb", z=1.5), room, observation)
        view.add(make_step(2, floor=2, z=3.0), room, observation)
    robots = [values_of(row, "translation")[0][2] for row in rows_of(path, "map/robot")]
    assert robots == [0.0, 1.5, 3.0]
    grids = [values_of(row, "translation")[0][2] for row in rows_of(path, "map/cells")]
    assert grids == [0.0, 0.0, 3.0]


def test_questions_events_and_the_result_are_texts(recorded):
    (first, second) = rows_of(recorded, "answer")
    assert (first["step"], second["step"]) == (2, 5)
    assert "2, because it looks like a kitchen" in values_of(first, "text")[0]
    said = [values_of(row, "text")[0] for row in rows_of(recorded, "log")]
    assert said[:2] == ["Looking around: going to block 2", "a bump"]
    assert said[-1] == "Found “bed”"


def test_blocks_disappear_when_the_robot_no_longer_explores(tmp_path, make_step):
    view = RrdView(tmp_path / "search.rrd", INFO)
    view.add(make_step(2), None, None)
    view.add(make_step(3, mode="approach"), None, None)
    view.close()
    asked, cleared = rows_of(tmp_path / "search.rrd", "map/blocks")
    assert values_of(asked, "labels") == ["1", "2"]
    assert values_of(cleared, "is_recursive") == [False]


def test_leaving_early_keeps_every_step(tmp_path, make_step, room, observation):
    view = RrdView(tmp_path / "left.rrd", INFO)
    for number in range(3):
        view.add(make_step(number), room, observation)
    view.close()
    assert len(rows_of(tmp_path / "left.rrd", "map/camera/image")) == 3


def test_a_full_disk_is_one_error_that_names_the_file(tmp_path, make_step, observation, capfd):
    rng = np.random.default_rng(0)

    def fill():
        with closing(RrdView(tmp_path / "full.rrd", INFO)) as view, full_disk():
            for number in range(50):
                rgb = rng.integers(0, 256, observation.rgb.shape, dtype=np.uint8)
                view.add(make_step(number), None, replace(observation, rgb=rgb))

    with pytest.raises(OutputError, match=r"full\.rrd cannot be written \(File too large"):
        fill()
    assert capfd.readouterr() == ("", "")


def test_a_viewer_that_does_not_start_says_what_to_do_instead(monkeypatch):
    monkeypatch.setattr(rerun_view, "_OPENING_S", 0.1)
    monkeypatch.setattr(rerun_view.sys, "executable", shutil.which("false"))
    with pytest.raises(ViewError, match=r"did not start.*--rrd FILE"):
        RerunView(INFO)


def test_ctrl_c_while_a_viewer_starts_leaves_none(monkeypatch, tmp_path):
    sleeper, started, popen = tmp_path / "viewer", [], subprocess.Popen
    sleeper.write_text("#!/bin/sh\nexec sleep 60\n")
    sleeper.chmod(0o755)

    def start(*arguments, **options):
        started.append(popen(*arguments, **options))
        return started[-1]

    def interrupted(port):
        raise KeyboardInterrupt

    monkeypatch.setattr(rerun_view.sys, "executable", str(sleeper))
    monkeypatch.setattr(rerun_view.subprocess, "Popen", start)
    monkeypatch.setattr(rerun_view, "_answers", interrupted)
    with pytest.raises(KeyboardInterrupt):
        RerunView(INFO)
    assert [viewer.poll() is None for viewer in started] == [False]
