"""Published benchmarks: what they prescribe, and where their files are found."""

import shutil
from functools import partial

import pytest

from hypernav.core.errors import ConfigError, EpisodeError
from hypernav.lab.datasets.benchmark_files import found_splits, scene_below, scene_in, split_of
from hypernav.lab.datasets.benchmarks import BENCHMARKS, STOREYS, benchmark_of, robot_in
from scan_writers.episodes import HASH, SCENE


@pytest.fixture(scope="module")
def data(benchmark_data, tmp_path_factory):
    return shutil.copytree(benchmark_data, tmp_path_factory.mktemp("own") / "data")


@pytest.mark.parametrize(
    ("name", "camera", "body", "forward_m", "success_m"),
    [
        ("hm3d", (640, 480, 79.0, 0.88), (0.18, 1.0), 0.25, 0.1),
        ("hypernav-paper-hm3d", (640, 480, 79.0, 0.88), (0.18, 1.0), 0.5, 0.1),
        ("hypernav-paper-ovon", (360, 640, 42.0, 1.31), (0.17, 1.41), 0.5, 0.25),
        ("mp3d", (640, 480, 79.0, 0.88), (0.18, 1.0), 0.25, 0.1),
        ("ovon", (360, 640, 42.0, 1.31), (0.17, 1.41), 0.25, 0.25),
    ],
)
def test_the_published_robots_and_limits(name, camera, body, forward_m, success_m):
    benchmark = BENCHMARKS[name]
    robot = benchmark.embodiment
    seen = robot.camera
    assert (seen.width, seen.height, seen.hfov_deg, seen.height_m) == camera
    assert (robot.body.radius_m, robot.body.height_m) == body
    assert (robot.motion.forward_m, robot.motion.turn_angle_deg) == (forward_m, 30.0)
    assert (benchmark.max_steps, benchmark.success_distance_m) == (500, success_m)


def test_goat_bench_has_ovons_robot_and_one_limit_for_all_goals_of_a_life():
    goat = BENCHMARKS["goat"]
    assert goat.embodiment == BENCHMARKS["ovon"].embodiment
    assert (goat.max_steps, goat.max_life_steps, goat.success_distance_m) == (5000, 5000, 0.25)


def test_a_data_set_follows_its_own_benchmark_unless_another_is_named():
    assert benchmark_of("ovon:data#val_unseen") is BENCHMARKS["ovon"]
    paper = BENCHMARKS["hypernav-paper-hm3d"]
    assert benchmark_of("hm3d:data", "hypernav-paper-hm3d") is paper
    assert benchmark_of("hypernav-paper-hm3d:data") is paper
    assert benchmark_of("storeys-train#3000:3004") is STOREYS
    assert benchmark_of("scene:storeys:3#2") is STOREYS
    assert benchmark_of("houses-val") is None
    with pytest.raises(ConfigError, match="use hm3d, mp3d, ovon, goat, hypernav-paper-hm3d, "):
        benchmark_of("houses-val", "hm4d")


def test_only_in_buildings_with_stairs_a_robot_climbs_unless_told():
    assert robot_in("storeys:3") == STOREYS.embodiment
    assert STOREYS.embodiment.body.max_step_m == BENCHMARKS["hm3d"].embodiment.body.max_step_m
    assert robot_in("houses:3") is None
    assert benchmark_of("offices-train") is None


def test_every_split_that_is_there_is_found(data):
    def names(benchmark):
        return [f"{s.version}/{s.name}" for s in found_splits(BENCHMARKS[benchmark], data)]

    assert names("hm3d") == ["v1/val", "v2/val"]
    assert names("mp3d") == ["v1/val"]
    assert names("ovon") == ["hm3d/val_seen", "hm3d/val_seen_synonyms", "hm3d/val_unseen"]


def test_a_split_of_several_versions_needs_its_version(data):
    assert split_of(BENCHMARKS["hm3d"], data, "v1/val").version == "v1"
    assert split_of(BENCHMARKS["ovon"], data).name == "val_seen"
    with pytest.raises(EpisodeError, match="write one of #v1/val, #v2/val"):
        split_of(BENCHMARKS["hm3d"], data, "val")
    with pytest.raises(EpisodeError, match=r"'train'; there are #v1/val.*doctor --data"):
        split_of(BENCHMARKS["hm3d"], data, "train")
    with pytest.raises(EpisodeError, match=r"expected .*doctor"):
        split_of(BENCHMARKS["hm3d"], data / "nowhere", "val")


def test_a_scene_is_found_in_any_release_and_with_either_kind_of_textures(data):
    hm3d = BENCHMARKS["hm3d"]
    expected = data / "scene_datasets" / "hm3d" / "val" / SCENE / f"{HASH}.glb"
    for release in ("hm3d", "hm3d_v0.2"):
        assert scene_below(hm3d, data, f"{release}/val/{SCENE}/{HASH}.basis.glb") == expected
    assert scene_below(hm3d, data / "scene_datasets", f"hm3d/val/{SCENE}/{HASH}.glb") == expected
    assert scene_below(hm3d, data, "hm3d/val/00803-x/x.basis.glb") is None


@pytest.mark.parametrize(
    "scene_id",
    ["{outside}", "/{outside}", "hm3d/../../outside.glb", "../outside.glb", "a/../../outside.glb"],
)
def test_a_scene_id_that_leaves_the_folder_is_refused(data, scene_id):
    outside = data.with_name("outside.glb")
    outside.touch()
    for find in (partial(scene_below, BENCHMARKS["hm3d"], data), partial(scene_in, [data])):
        with pytest.raises(EpisodeError, match=r"leads out of the folders.*--scenes-dir"):
            find(scene_id.format(outside=outside))
    assert scene_in([data], f"data/scene_datasets/{outside}") is None


@pytest.mark.parametrize("scene_id", ["", "x", "data/scene_datasets/"])
def test_a_scene_id_that_names_nothing_is_found_nowhere(data, scene_id):
    assert scene_below(BENCHMARKS["hm3d"], data, scene_id) is None


@pytest.mark.parametrize("name", [f"{HASH}.glb", f"{HASH}.basis.glb"])
def test_habitats_own_prefix_of_scene_ids_is_taken_away(data, name):
    expected = data / "scene_datasets" / "hm3d" / "val" / SCENE / f"{HASH}.glb"
    scene_id = f"data/scene_datasets/hm3d_v0.2/val/{SCENE}/{name}"
    assert scene_below(BENCHMARKS["hm3d"], data, scene_id) == expected
    folders = [data / "nowhere", data / "scene_datasets"]
    assert scene_in(folders, scene_id, BENCHMARKS["hm3d"].scenes) == expected
    assert scene_in(folders, scene_id) is None


def test_the_very_file_of_a_scene_comes_first(tmp_path):
    for name in ("x.glb", "x.basis.glb", "x.ply"):
        (tmp_path / name).touch()
        assert scene_in([tmp_path], name) == tmp_path / name
    assert scene_in([tmp_path], "y" * 300) is None
