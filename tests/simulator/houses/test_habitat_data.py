"""A split written as Habitat's data: read here as habitat-lab and habitat-sim do."""

import gzip
import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial import KDTree

import fake_habitat
from hypernav.app.build.data.datasets import load_episodes
from hypernav.app.cli.main import main
from hypernav.core.errors import EpisodeError
from hypernav.core.geometry.transforms import Pose2
from hypernav.lab.datasets.habitat_format import positions_from_habitat
from hypernav.lab.evaluation.workers.job import Job
from hypernav.lab.evaluation.workers.worker import EpisodeWorker
from hypernav.simulator.houses.building import house
from hypernav.simulator.houses.episodes import splits
from hypernav.simulator.houses.episodes.building_truth import HouseGroundTruth
from hypernav.simulator.houses.episodes.splits import load_split
from hypernav.simulator.houses.export.habitat_data import HabitatData, export_split
from hypernav.simulator.houses.house_cache import cached_building
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer
from hypernav.simulator.worlds.habitat import HabitatRenderer
from hypernav.simulator.worlds.navmesh.navmesh_reader import read_navmesh
from hypernav.simulator.worlds.navmesh.navmesh_surface import NavmeshSurface
from hypernav.simulator.worlds.scans.scan_loading import open_scene
from small_worlds import small_config

pytestmark = pytest.mark.slow

SPLIT, NUMBER = "houses-train", 0
EPISODE = {  # fields of habitat-lab's Episode, NavigationEpisode and ObjectGoalNavEpisode
    *("episode_id", "scene_id", "scene_dataset_config", "additional_obj_config_paths"),
    *("start_position", "start_rotation", "info", "goals", "start_room", "shortest_paths"),
    "object_category",
}
GOAL = {  # those of its ObjectGoal
    *("position", "radius", "object_id", "object_name", "object_name_id", "object_category"),
    *("room_id", "room_name", "view_points"),
}


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("cache")


@pytest.fixture(scope="module")
def data(cache, tmp_path_factory) -> HabitatData:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(splits, "cache_folder", lambda: cache)
        dataset = load_split(SPLIT, numbers=range(NUMBER, NUMBER + 1), cache=cache)
    return export_split(dataset, SPLIT, tmp_path_factory.mktemp("habitat") / "data", cache=cache)


@pytest.fixture(scope="module")
def episodes(data) -> list[dict[str, Any]]:
    return read_as_habitat_lab(data.episodes, data.scenes)


@pytest.fixture(scope="module")
def surface(episodes) -> NavmeshSurface:
    return NavmeshSurface.load(Path(episodes[0]["scene_id"]).with_suffix(".navmesh"))


def read_as_habitat_lab(file: Path, scenes_dir: Path) -> list[dict[str, Any]]:
    """The episodes of ``ObjectNavDatasetV1``, with their goals (habitat-lab 0.2 and 0.3)."""
    content = file.parent / "content"
    files = sorted(content.glob("*.json.gz")) if content.is_dir() else [file]
    found = []
    for part in files:
        loaded = json.loads(gzip.decompress(part.read_bytes()))
        numbers = loaded["category_to_task_category_id"]
        assert numbers.keys() == loaded["category_to_scene_annotation_category_id"].keys()
        for number, episode in enumerate(loaded["episodes"]):
            assert episode.keys() <= EPISODE
            key = f"{Path(episode['scene_id']).name}_{episode['object_category']}"
            goals = loaded["goals_by_category"][key]
            assert all(goal.keys() <= GOAL for goal in goals)
            scene_id = episode["scene_id"].removeprefix("data/scene_datasets/")
            scene = {"scene_id": str(scenes_dir / scene_id), "goals": goals}
            found.append(episode | scene | {"episode_id": str(number)})
            assert episode["object_category"] in numbers
    return found


def view_points(episode: dict[str, Any]) -> np.ndarray:
    """The view points of an episode's goals, scene frame."""
    states = [v["agent_state"] for goal in episode["goals"] for v in goal["view_points"]]
    return positions_from_habitat(np.array([state["position"] for state in states]))


def start(episode: dict[str, Any]) -> np.ndarray:
    return positions_from_habitat(np.array([episode["start_position"]]))[0]


def test_every_scene_and_what_belongs_to_it_is_where_habitat_looks(data, episodes):
    assert len(episodes) == 28
    for episode in episodes:
        scene, config = Path(episode["scene_id"]), Path(episode["scene_dataset_config"])
        assert config == data.dataset_config
        stages = json.loads(config.read_text())["stages"]
        assert config.parent / stages["paths"][".glb"][0] == scene
        assert scene.is_file()
        attributes = stages["default_attributes"]
        # habitat-sim takes a GLB for one that is z up unless it is told.
        assert (attributes["up"], attributes["front"]) == ([0, 1, 0], [0, 0, -1])
        for key in ("semantic_asset", "semantic_descriptor_filename", "nav_asset"):
            name = attributes[key].replace("%%CONFIG_NAME_AS_ASSET_FILENAME%%", scene.stem)
            assert scene.with_name(name).is_file()


def test_habitat_keeps_the_mesh_because_it_would_compute_one_with_these_settings(episodes):
    """``Simulator._config_pathfinder`` compares with its defaults and the robot of habitat-lab."""
    file = read_navmesh(Path(episodes[0]["scene_id"]).with_suffix(".navmesh"))
    assert file.version == 2
    assert file.settings is not None
    expected = {
        "cell_size": 0.05,
        "cell_height": 0.2,
        "agent_height": 0.88,
        "agent_radius": 0.18,
        "agent_max_climb": 0.2,
        "agent_max_slope": 45.0,
        "region_min_size": 20.0,
        "region_merge_size": 20.0,
        "edge_max_len": 12.0,
        "edge_max_error": 1.3,
        "verts_per_poly": 6.0,
        "detail_sample_dist": 6.0,
        "detail_sample_max_error": 1.0,
        "filter_low_hanging_obstacles": 1,
        "filter_ledge_spans": 1,
        "filter_walkable_low_height_spans": 1,
        "include_static_objects": 0,
    }
    assert set(file.settings.dtype.names or ()) == set(expected)
    for name, value in expected.items():
        assert abs(float(file.settings[name]) - value) < 1e-5


def test_start_distances_are_those_of_the_files_view_points_on_the_mesh_beside_it(
    episodes, surface
):
    for episode in episodes:
        points = view_points(episode)
        x, y, z = start(episode).tolist()
        length = surface.goal_field(points).distance(x, y, z)
        assert episode["info"]["geodesic_distance"] == pytest.approx(length, abs=1e-3)
        assert surface.is_standable(x, y, z)
        straight = float(np.linalg.norm(points[:, :2] - (x, y), axis=1).min())
        assert straight <= length + 1e-3


def test_every_view_point_can_be_stood_on(episodes, surface):
    for episode in episodes:
        for x, y, z in view_points(episode).tolist():
            assert math.dist((x, y), surface.nearest_standable(x, y, z)[:2]) < 0.01


def test_whoever_stands_where_the_goal_counts_as_reached_has_a_view_point_within_a_decimetre(
    episodes, cache
):
    truth = HouseGroundTruth.of(cached_building(house(NUMBER), cache))
    names = {instance.name: instance for instance in truth.scene.instances}
    corners = np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]]) * truth.walkable.cell_m / 2
    for goal in {g["object_name"]: g for episode in episodes for g in episode["goals"]}.values():
        cells = truth.regions.view_points(names[goal["object_name"]])
        anywhere = (cells[:, None, :2] + corners[None]).reshape(-1, 2)
        gaps, _ = KDTree(view_points({"goals": [goal]})[:, :2]).query(anywhere)
        assert gaps.max() < 0.1


def test_objects_have_the_numbers_of_the_semantics(episodes):
    text = Path(episodes[0]["scene_id"]).with_suffix(".semantic.txt").read_text()
    categories = {int(line.split(",")[0]): line.split('"')[1] for line in text.splitlines()[1:]}
    for episode in episodes:
        for goal in episode["goals"]:
            assert categories[goal["object_id"]] == goal["object_category"]
        ids = {goal["object_id"] for goal in episode["goals"]}
        assert episode["info"]["closest_goal_object_id"] in ids
        assert ids.isdisjoint(episode["info"]["near_miss_object_ids"])


def test_our_own_evaluation_of_the_files_is_that_of_the_houses(data, cache, tmp_path, monkeypatch):
    monkeypatch.setattr(splits, "cache_folder", lambda: cache)
    read = load_episodes(f"habitat:{data.episodes}")
    own = load_episodes(f"{SPLIT}#{NUMBER}")
    assert [(e.goal, e.start, e.start_z) for e in read] == [
        (e.goal, e.start, e.start_z) for e in own
    ]
    worker = EpisodeWorker(Job(tmp_path, small_config()))
    for one, other in zip(read[:2], own[:2], strict=True):
        records = [
            worker.run(replace(episode, max_steps=20)).model_dump(
                mode="json", exclude={"seconds", "scene_id"}
            )
            for episode in (one, other)
        ]
        assert records[0] == records[1]


def test_in_habitat_the_files_measure_what_they_say(data, tmp_path, monkeypatch):
    """habitat-sim's stand-in draws and numbers the instances as the files say."""
    fake_habitat.install(monkeypatch)
    said = json.loads(gzip.decompress(next(data.episodes.parent.rglob("house_*")).read_bytes()))
    worker = EpisodeWorker(Job(tmp_path, small_config(), world="habitat"))
    for episode, entry in zip(
        load_episodes(f"habitat:{data.episodes}")[:2], said["episodes"], strict=False
    ):
        record = worker.run(replace(episode, max_steps=10))
        assert record.shortest_path_m == pytest.approx(entry["info"]["geodesic_distance"], abs=1e-3)
    worker.close()


def test_habitats_instances_are_ours(episodes, monkeypatch):
    fake_habitat.install(monkeypatch)
    path = Path(episodes[0]["scene_id"])
    scene, robot = open_scene(path), small_config().embodiment
    habitat = HabitatRenderer(scene, path, robot)
    x, y, z = start(episodes[0]).tolist()
    pose = Pose2(x, y, 0.3).to_transform(z)
    camera_to_scene = pose @ robot.camera.camera_to_base
    theirs = habitat.render(robot.camera.intrinsics, camera_to_scene)
    ours = CpuRenderer(scene).render(robot.camera.intrinsics, camera_to_scene)
    assert len(np.unique(ours.instance_ids)) > 5
    assert np.array_equal(theirs.instance_ids, ours.instance_ids)
    habitat.close()


def test_an_export_is_compared_on_its_own_mesh(data, monkeypatch, capsys):
    fake_habitat.install(monkeypatch)
    scene = next(data.scenes.rglob(f"house_{NUMBER}.glb"))
    with pytest.raises(SystemExit) as stop:
        main(["compare", str(scene), "--poses", "4"])
    assert capsys.readouterr().out.startswith(f"both walk on house_{NUMBER}.navmesh")
    assert stop.value.code == 0


def test_a_folder_that_cannot_be_written_is_an_error(data, cache, tmp_path, monkeypatch):
    monkeypatch.setattr(splits, "cache_folder", lambda: cache)
    dataset = load_split(SPLIT, numbers=range(NUMBER, NUMBER + 1), cache=cache)
    (tmp_path / "datasets").write_text("in the way")
    with pytest.raises(EpisodeError, match="cannot be written"):
        export_split(dataset, SPLIT, tmp_path, cache=cache)
