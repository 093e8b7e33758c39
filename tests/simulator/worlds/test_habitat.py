"""Agents on habitat-sim's observations, by a faithful stand-in for the few calls that are used."""

import ctypes
import json
import math
import runpy
import shutil
from ctypes.util import find_library
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.table import Table

import fake_habitat
from hypernav.app.build.data.datasets import load_episodes
from hypernav.app.build.worlds import open_world
from hypernav.app.cli.main import main
from hypernav.core.errors import MissingExtraError, SceneError
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.world import Simulator
from hypernav.lab.evaluation.workers.job import Job
from hypernav.lab.evaluation.workers.worker import EpisodeWorker
from hypernav.lab.evaluation.world_comparison import compare_worlds
from hypernav.simulator.worlds.habitat import (
    HabitatRenderer,
    HabitatSurface,
    egl_devices,
    graphics_device,
    quaternion_of,
    require_habitat,
    scene_dataset,
)
from hypernav.simulator.worlds.navmesh.navmesh_surface import NavmeshSurface
from hypernav.simulator.worlds.scans.scan_loading import open_scene
from hypernav.simulator.worlds.surface.walkable import WalkableGrid
from hypernav.simulator.worlds.surface.walkable_surface import WalkableSurface
from scan_writers.episodes import HASH, SCENE
from small_worlds import small_config

BENCHMARK = Path(__file__).parents[3] / "benchmarks" / "render.py"
CONFIG = small_config(embodiment={"motion": {"forward_m": 0.25, "turn_angle_deg": 30.0}})


@pytest.fixture
def _habitat(monkeypatch):
    fake_habitat.install(monkeypatch)


@pytest.fixture
def mesh(benchmark_data):
    return benchmark_data / "scene_datasets" / "hm3d" / "val" / SCENE / f"{HASH}.glb"


def opened(mesh, name, config=CONFIG):
    return open_world(str(mesh), config, name)


def compared(habitat, native, poses, config=CONFIG):
    rng = np.random.default_rng(0)
    return list(compare_worlds(habitat, native, config.embodiment, poses, rng))


def test_without_habitat_sim_the_error_says_how_to_get_it(mesh):
    with pytest.raises(MissingExtraError, match=r"conda install habitat-sim .*NumPy 2"):
        opened(mesh, "habitat")


def test_the_command_says_so_before_anything_is_loaded(capsys):
    with pytest.raises(SystemExit) as stop:
        main(["eval", "hm3d:nowhere", "--world", "habitat"])
    assert stop.value.code == 2
    assert "leave out --world habitat" in capsys.readouterr().err


@given(st.floats(-math.pi, math.pi), st.floats(-1.5, 1.5), st.floats(-math.pi, math.pi))
def test_a_quaternion_turns_as_its_matrix(yaw, pitch, roll):
    def about(axis, angle):
        cross = np.cross(np.eye(3), axis)
        return np.eye(3) - math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross

    matrix = about((0, 0, 1), yaw) @ about((0, 1, 0), pitch) @ about((1, 0, 0), roll)
    x, y, z, w = quaternion_of(matrix)
    assert x * x + y * y + z * z + w * w == pytest.approx(1.0)
    for axis in np.eye(3):
        turned = fake_habitat._turned((x, y, z, w), tuple(axis))
        assert np.allclose(turned, matrix @ axis, atol=1e-9)


@pytest.mark.usefixtures("_habitat")
def test_both_worlds_compute_a_mesh_for_a_robot_that_the_file_was_not_made_for(mesh):
    body = CONFIG.embodiment.body.model_copy(update={"radius_m": 0.17, "height_m": 1.41})
    tall = CONFIG.model_copy(
        update={"embodiment": CONFIG.embodiment.model_copy(update={"body": body})}
    )
    habitat, native = opened(mesh, "habitat", tall), opened(mesh, "native", tall)
    (comparison,) = compared(habitat, native, 1, tall)
    assert comparison.step_m == pytest.approx(0.0, abs=1e-6)
    assert comparison.own_path_m == pytest.approx(comparison.path_m)


@pytest.mark.usefixtures("_habitat")
def test_both_worlds_show_and_walk_the_same(mesh):
    habitat, native = opened(mesh, "habitat"), opened(mesh, "native")
    assert isinstance(habitat, Simulator)
    assert isinstance(habitat.truth.walkable, WalkableSurface)
    for comparison in compared(habitat, native, 6):
        assert comparison.is_same
        assert comparison.color_difference == 0.0
        assert comparison.depth_share == comparison.label_share == 1.0
        assert comparison.step_m == pytest.approx(0.0, abs=1e-6)


@pytest.mark.usefixtures("_habitat")
def test_habitat_draws_no_colours_where_none_are_asked_for(mesh, monkeypatch):
    robot = CONFIG.embodiment
    renderer = HabitatRenderer(open_scene(mesh), mesh, robot)
    pose = Pose2(0.0, 0.0, 0.0).to_transform(1.0) @ robot.camera.camera_to_base
    coloured = renderer.render(robot.camera.intrinsics, pose)
    drawn = []
    observe = fake_habitat.Simulator.get_sensor_observations

    def watched(*args):
        drawn.append(observe(*args))
        return drawn[-1]

    monkeypatch.setattr(fake_habitat.Simulator, "get_sensor_observations", watched)
    renderer.colours = False
    black = renderer.render(robot.camera.intrinsics, pose)
    assert set(drawn[0]) == {"depth", "semantic"}
    assert coloured.rgb.any()
    assert not black.rgb.any()
    assert black.rgb.shape == coloured.rgb.shape
    assert np.array_equal(black.depth, coloured.depth)
    assert np.array_equal(black.instance_ids, coloured.instance_ids)


@pytest.mark.slow
@pytest.mark.usefixtures("_habitat")
def test_episodes_run_on_habitats_observations(benchmark_data, tmp_path):
    chair, _, television, _ = load_episodes(f"hm3d:{benchmark_data}#v1/val")
    found = []
    for world in ("habitat", "native"):
        worker = EpisodeWorker(Job(tmp_path, CONFIG, world=world))
        found.append([worker.run(e).model_dump(exclude={"seconds"}) for e in (chair, television)])
        worker.close()
    assert found[0] == found[1]
    assert all(record["success"] for record in found[0])


@pytest.mark.usefixtures("_habitat")
def test_a_difference_is_seen(mesh, monkeypatch):
    habitat, native = opened(mesh, "habitat"), opened(mesh, "native")
    surface = habitat.truth.walkable
    assert isinstance(surface, HabitatSurface)
    original = surface.move

    def shorter(position, dx, dy, *, sliding=False):
        return original(position, 0.9 * dx, 0.9 * dy, sliding=sliding)

    monkeypatch.setattr(surface, "move", shorter)
    found = compared(habitat, native, 3)
    assert not all(comparison.is_same for comparison in found)


@pytest.mark.usefixtures("_habitat")
def test_the_command_compares_pose_by_pose(mesh, capsys):
    with pytest.raises(SystemExit) as stop:
        main(["compare", str(mesh), "--poses", "2"])
    assert stop.value.code == 0
    said, *lines = capsys.readouterr().out.splitlines()
    assert said == f"both walk on {HASH}.basis.navmesh"
    assert [line[:4] for line in lines] == ["ok  ", "ok  ", "2 of"]


@pytest.mark.usefixtures("_habitat")
def test_the_command_says_where_each_computes_a_mesh(mesh, benchmark_data, capsys):
    bare = benchmark_data / "scene_datasets" / "mp3d" / HASH / f"{HASH}.glb"
    for scan, benchmark, said in (
        (mesh, "ovon", f"{HASH}.basis.navmesh was made for another robot"),
        (bare, "hm3d", "there is no navigation mesh beside the scene"),
    ):
        with pytest.raises(SystemExit) as stop:
            main(["compare", str(scan), "--benchmark", benchmark, "--poses", "1"])
        assert stop.value.code == 0
        assert capsys.readouterr().out.startswith(said)


def test_the_mesh_beside_any_scene_is_walked_on_where_it_is_asked_for(mesh, tmp_path):
    scene_id = str(shutil.copy(mesh, tmp_path / "flat.glb"))
    shutil.copy(mesh.with_suffix(".basis.navmesh"), tmp_path / "flat.navmesh")
    for choice, surface in (("auto", WalkableGrid), ("file", NavmeshSurface)):
        config = CONFIG.model_copy(
            update={"world": CONFIG.world.model_copy(update={"navmesh": choice})}
        )
        assert isinstance(open_world(scene_id, config).truth.walkable, surface)


def test_the_first_cuda_device_draws_else_the_default(mesh, monkeypatch):
    for devices, chosen in (((None,), -1), ((None, 1, 0), 0), ((2, None), 2)):
        fake_habitat.install(monkeypatch, devices)
        assert graphics_device() == chosen
        opened(mesh, "habitat").close()


def test_where_nothing_can_draw_the_error_says_what_to_install(mesh, monkeypatch):
    fake_habitat.install(monkeypatch, ())
    with pytest.raises(MissingExtraError, match=r"libegl1 .*Mesa"):
        opened(mesh, "habitat")


def test_an_egl_that_is_missing_is_said_with_its_package(monkeypatch):
    def absent(name):
        raise OSError(f"{name}: cannot open shared object file")

    monkeypatch.setattr(ctypes, "CDLL", absent)
    with pytest.raises(MissingExtraError, match=r"libEGL\.so\.1: cannot open.*install libegl1"):
        egl_devices()


@pytest.mark.skipif(find_library("EGL") is None, reason="libEGL is not installed")
def test_the_real_egl_names_its_devices():
    assert all(number is None or number >= 0 for number in egl_devices())


def test_a_library_that_habitat_sim_misses_is_named(tmp_path, monkeypatch):
    (tmp_path / "habitat_sim").mkdir()
    (tmp_path / "habitat_sim" / "__init__.py").write_text(
        "raise ImportError('libEGL.so.1: cannot open shared object file', name='habitat_sim._ext')"
    )
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(MissingExtraError, match=r"can't be loaded .*apt-get install libegl1"):
        require_habitat()


@pytest.mark.usefixtures("_habitat")
def test_what_habitat_cannot_open_is_one_error(mesh, monkeypatch):
    with pytest.raises(SceneError, match="opens files only"):
        open_world("builtin", CONFIG, "habitat")
    drawn = HabitatRenderer(open_scene(mesh), mesh, CONFIG.embodiment)
    other = CONFIG.embodiment.camera.model_copy(update={"width": 80}).intrinsics
    with pytest.raises(SceneError, match="camera is set"):
        drawn.render(other, Pose2(0.0, 0.0, 0.0).to_transform())

    def refuse(configuration):
        raise RuntimeError("no such stage")

    monkeypatch.setattr(fake_habitat, "Simulator", refuse)
    with pytest.raises(SceneError, match=r"can't open it \(no such stage\)"):
        opened(mesh, "habitat")


@pytest.mark.usefixtures("_habitat")
def test_a_scene_without_a_mesh_is_refused(benchmark_data):
    scan = benchmark_data / "scene_datasets" / "mp3d" / HASH / f"{HASH}.glb"
    with pytest.raises(SceneError, match="no navigation mesh beside it"):
        opened(scan, "habitat")


def test_a_scene_that_is_missing_is_said_before_habitat_is_asked_for(tmp_path, capsys):
    with pytest.raises(SystemExit) as stop:
        main(["compare", str(tmp_path / "nope.glb")])
    assert stop.value.code == 2
    assert "nope.glb: no such scene file" in capsys.readouterr().err


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


@pytest.mark.slow
def test_habitat_draws_the_views_of_the_benchmark_beside_ours(
    benchmark_data: Path, monkeypatch: pytest.MonkeyPatch
):
    fake_habitat.install(monkeypatch)
    file = benchmark_data / "scene_datasets" / "hm3d" / "val" / SCENE / f"{HASH}.glb"
    benchmark = runpy.run_path(str(BENCHMARK))
    scene, table = open_scene(file), Table("scene", "what", "median", "p95", "CPU")
    said = benchmark["measure_peer"](table, scene, file, benchmark["standing_views"](scene, 2))
    assert list(table.columns[1].cells) == [
        f"{who}: {what}"
        for what in ("render", "depth and instances")
        for who in ("habitat-sim", "beside it")
    ]
    assert "1 mm on 100.0000%" in said
    assert "instances equal on 100.0000%" in said
    assert "colours 0.00 of 255" in said
