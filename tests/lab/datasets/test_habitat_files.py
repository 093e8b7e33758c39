import copy
import errno
import gzip
import json
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from certainty import certain
from hypernav.core.errors import EpisodeError
from hypernav.core.geometry.transforms import Pose2
from hypernav.lab.datasets.habitat_files import (
    episode_files,
    episodes_of,
    read_episodes,
    read_split,
    write_episodes,
)
from hypernav.lab.datasets.habitat_format import (
    EpisodeDataset,
    pose_from_habitat,
    pose_to_habitat,
    positions_from_habitat,
    positions_to_habitat,
)

HERE = [1.0, 0.1, -2.0]
AHEAD = [0.0, 0.0, 0.0, 1.0]
CONTENT = {
    "goals_by_category": {
        "a.glb_bed": [
            {
                "position": [0.5, 0.3, 1],
                "object_id": 5,
                "object_category": "bed",
                "radius": None,
                "view_points": [{"agent_state": {"position": HERE, "rotation": AHEAD}, "iou": 0.2}],
            }
        ]
    },
    "episodes": [
        {
            "episode_id": "7",
            "scene_id": "mp3d/a/a.glb",
            "start_position": [0.0, 0.1, 0],
            "start_rotation": [0, 1, 0, 0.0],
            "info": {"geodesic_distance": 1.5},
            "goals": [],
            "start_room": None,
            "object_category": "bed",
        }
    ],
    "category_to_task_category_id": {"bed": 6},
}


def json_text(value) -> str:
    """Text that tells 1 from 1.0, whatever the order of keys."""
    return json.dumps(value, sort_keys=True)


def write_raw(path, content) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(gzip.compress(json.dumps(content).encode()))


def test_habitats_own_file_survives_reading_and_writing(test_data, tmp_path):
    source = test_data / "habitat" / "objectnav_mp3d_v1_sample.json.gz"
    dataset = read_episodes(source)
    assert len(dataset.episodes) == 48
    assert len(dataset.goals_by_category) == 16
    write_episodes(dataset, tmp_path / "copy.json.gz")
    before = json.loads(gzip.decompress(source.read_bytes()))
    after = json.loads(gzip.decompress((tmp_path / "copy.json.gz").read_bytes()))
    assert json_text(before) == json_text(after)


def test_habitats_view_points_lie_at_their_goals(test_data):
    dataset = read_episodes(test_data / "habitat" / "objectnav_mp3d_v1_sample.json.gz")
    for episode in dataset.episodes:
        points = dataset.view_points_of(episode)
        start, height = pose_from_habitat(episode.start_position, episode.start_rotation)
        info = certain(episode.info)
        best = positions_from_habitat(np.array([info["best_viewpoint_position"]]))[0]
        assert start.distance_to(best[0], best[1]) <= info["geodesic_distance"] + 0.01
        assert abs(points[:, 2] - height).min() < 1.0
    for goals in dataset.goals_by_category.values():
        for goal in goals:
            middle = positions_from_habitat(np.array([goal.position]))[0]
            best = goal.view_points[0].agent_state
            pose, _ = pose_from_habitat(best.position, best.rotation)
            assert abs(pose.bearing_to(middle[0], middle[1])) < math.radians(1.0)


def test_the_same_data_gives_the_same_bytes(tmp_path):
    dataset = EpisodeDataset.model_validate(CONTENT)
    for name in ("one.json.gz", "two.json.gz"):
        write_episodes(dataset, tmp_path / name)
    one, two = ((tmp_path / name).read_bytes() for name in ("one.json.gz", "two.json.gz"))
    assert one == two
    write_episodes(dataset, tmp_path / "deep" / "plain.json")
    assert read_episodes(tmp_path / "deep" / "plain.json") == dataset
    with pytest.raises(EpisodeError, match=r"ends in \.json\.gz"):
        write_episodes(dataset, tmp_path / "episodes.yaml")


def test_an_episode_keeps_its_category_and_the_files_numbers():
    content = copy.deepcopy(CONTENT)
    content["category_to_task_category_id"] = {"bed": 6, "sofa": 10}
    [episode] = episodes_of(EpisodeDataset.model_validate(content), words={"bed": "cot"})
    assert (episode.goal.text, episode.object_category) == ("cot", "bed")
    assert episode.category_ids == {"bed": 6, "sofa": 10}


def test_ovons_variations_are_understood(tmp_path):
    content = copy.deepcopy(CONTENT)
    content["episodes"][0]["object_category"] = "furniture"
    content["episodes"][0]["children_object_categories"] = ["bed", "couch"]
    bed = content["goals_by_category"]["a.glb_bed"][0]
    bed["object_id"] = "bed_5"
    del bed["view_points"][0]["iou"]
    wardrobe = {**copy.deepcopy(bed), "object_id": "wardrobe_1", "object_category": "wardrobe"}
    wardrobe["children_object_categories"] = ["bed"]
    content["goals_by_category"]["a.glb_furniture"] = [wardrobe]
    write_raw(tmp_path / "ovon.json.gz", content)
    dataset = read_episodes(tmp_path / "ovon.json.gz")
    goals = dataset.goals_of(dataset.episodes[0])
    assert [goal.object_id for goal in goals] == ["wardrobe_1", "bed_5"]
    assert dataset.view_points_of(dataset.episodes[0]).tolist() == [[1.0, 2.0, 0.1]] * 2
    write_episodes(dataset, tmp_path / "again.json")
    assert json_text(json.loads((tmp_path / "again.json").read_text())) == json_text(content)


def test_older_files_have_the_goals_in_the_episode(tmp_path):
    content = copy.deepcopy(CONTENT)
    content["episodes"][0]["goals"] = content.pop("goals_by_category")["a.glb_bed"]
    write_raw(tmp_path / "old.json.gz", content)
    dataset = read_episodes(tmp_path / "old.json.gz")
    assert dataset.goals_of(dataset.episodes[0])[0].object_id == 5


def test_a_goal_is_words():
    content = copy.deepcopy(CONTENT["episodes"][0])
    content["object_category"] = "chest_of_drawers"
    dataset = EpisodeDataset.model_validate({"episodes": [content]})
    assert dataset.episodes[0].goal.text == "chest of drawers"
    assert dataset.episodes[0].goals_key() == "a.glb_chest_of_drawers"


def broken(change) -> dict:
    content = copy.deepcopy(CONTENT)
    change(content)
    return content


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (broken(lambda c: c.pop("episodes")), "episodes: field required"),
        (broken(lambda c: c.update(episodes={})), "episodes: input should be a valid"),
        (
            broken(lambda c: c["episodes"][0].pop("start_position")),
            "episode 7, field 'start_position': field required",
        ),
        (
            broken(lambda c: c["episodes"][0].update(start_position=[1.0, 2.0])),
            r"episode 7, field 'start_position\[2\]'",
        ),
        (
            broken(lambda c: c["episodes"][0].update(start_rotation=[0, "north", 0, 1])),
            r"episode 7, field 'start_rotation\[1\]'",
        ),
        (
            broken(lambda c: c["episodes"][0].update(start_position=[0, math.nan, 0])),
            r"episode 7, field 'start_position\[1\]': expected a number within ±260,000, got nan",
        ),
        (
            broken(lambda c: c["episodes"][0].update(start_position=[0, 1e308, 0])),
            r"episode 7, field 'start_position\[1\]': expected a number within ±260,000, got",
        ),
        (
            broken(lambda c: c["episodes"][0].update(start_rotation=[0, 1e200, 0, 1])),
            r"episode 7, field 'start_rotation\[1\]': expected a number within ±260,000, got",
        ),
        (
            broken(lambda c: c["episodes"][0].pop("episode_id")),
            r"episode number 0 \(it has no episode_id\)",
        ),
        (broken(lambda c: c.update(episodes=[3])), "episode number 0"),
        (
            broken(lambda c: c["goals_by_category"]["a.glb_bed"][0].pop("position")),
            "goal 0 of 'a.glb_bed', field 'position'",
        ),
        (
            broken(lambda c: c["episodes"][0].update(object_category="sofa")),
            "episode 7: no goals for 'sofa', expected the key 'a.glb_sofa'",
        ),
        ([], "the file: input should be"),
    ],
)
def test_a_broken_file_names_the_episode_and_the_field(tmp_path, content, message):
    path = tmp_path / "broken.json.gz"
    write_raw(path, content)
    with pytest.raises(EpisodeError, match=message) as caught:
        read_episodes(path)
    assert str(path) in str(caught.value)


def test_a_file_that_is_no_episode_file_says_so(tmp_path):
    path = tmp_path / "x.json.gz"
    with pytest.raises(EpisodeError, match="no such episode file"):
        read_episodes(path)
    with pytest.raises(EpisodeError, match="cannot be read"):
        read_episodes(tmp_path)
    path.write_bytes(gzip.compress(json.dumps(CONTENT).encode())[:-20])
    with pytest.raises(EpisodeError, match="broken gzip"):
        read_episodes(path)
    path.write_text("{ not json")
    with pytest.raises(EpisodeError, match="not valid JSON"):
        read_episodes(path)


def test_a_split_is_its_content_files(tmp_path):
    split = tmp_path / "val"
    (split / "content").mkdir(parents=True)
    with pytest.raises(EpisodeError, match="no episode file"):
        episode_files(split)
    main = split / "val.json.gz"
    write_raw(main, {"episodes": []})
    assert episode_files(main) == episode_files(split) == (main,)
    scenes = [split / "content" / f"{name}.json.gz" for name in "ab"]
    for scene in reversed(scenes):
        write_raw(scene, CONTENT)
    (split / "content" / "._a.json.gz").write_bytes(b"what macOS keeps beside a file")
    assert episode_files(main) == episode_files(split) == tuple(scenes)
    assert episode_files(scenes[0]) == (scenes[0],)


finite = st.floats(-50.0, 50.0)
poses = st.builds(Pose2, finite, finite, st.floats(-math.pi, math.pi - 1e-9))


@given(poses, finite)
def test_a_pose_survives_the_way_to_habitat_and_back(pose, floor_z):
    again, height = pose_from_habitat(*pose_to_habitat(pose, floor_z))
    assert (again.x, again.y, height) == pytest.approx((pose.x, pose.y, floor_z))
    assert math.cos(again.yaw - pose.yaw) == pytest.approx(1.0)


@given(st.lists(st.tuples(finite, finite, finite), max_size=5))
def test_positions_survive_the_way_to_habitat_and_back(points):
    array = np.array(points, dtype=np.float64).reshape(-1, 3)
    assert np.array_equal(positions_from_habitat(positions_to_habitat(array)), array)


def test_habitats_identity_looks_along_minus_z():
    pose, height = pose_from_habitat([1.0, 0.5, 3.0], [0.0, 0.0, 0.0, 1.0])
    assert (pose.x, pose.y, pose.yaw) == pytest.approx((1.0, -3.0, math.pi / 2))
    assert height == 0.5
    quarter, _ = pose_from_habitat([0, 0, 0], [0.0, math.sqrt(0.5), 0.0, math.sqrt(0.5)])
    assert abs(quarter.yaw) == pytest.approx(math.pi)


def test_a_rotation_without_a_heading_is_refused():
    up = [math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)]
    for rotation in (up, [0, 0, 0, 0]):
        with pytest.raises(EpisodeError, match="straight up or down"):
            pose_from_habitat([0, 0, 0], rotation)


def test_millions_of_wrong_values_are_counted_not_listed(tmp_path):
    goals = {str(number): 1 for number in range(20_000)}
    path = tmp_path / "wrong.json"
    path.write_text(json.dumps({"episodes": [], "goals_by_category": goals}))
    with pytest.raises(EpisodeError, match=r"wrong.json: 20,000 values do not fit Habitat's"):
        read_episodes(path)


def test_episodes_of_one_name_are_refused_across_files_as_within_one(tmp_path):
    for name in "ab":
        write_raw(tmp_path / "val" / "content" / f"{name}.json.gz", CONTENT)
    with pytest.raises(EpisodeError, match=r"b\.json\.gz: two episodes are called .* another file"):
        read_split(tmp_path / "val")


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, "which is missing"),
        ((), "which holds no file"),
        (("a", "b"), "none of the 2 files in .* holds an episode"),
    ],
)
def test_a_split_without_episodes_says_what_is_missing(tmp_path, content, words):
    write_raw(tmp_path / "val" / "val.json.gz", {"episodes": []})
    if content is not None:
        (tmp_path / "val" / "content").mkdir()
    for name in content or ():
        write_raw(tmp_path / "val" / "content" / f"{name}.json.gz", {"episodes": []})
    for path in (tmp_path / "val", tmp_path / "val" / "val.json.gz"):
        with pytest.raises(EpisodeError, match=words):
            read_split(path)


def test_a_file_is_written_whole_or_not_at_all(tmp_path, monkeypatch):
    file = tmp_path / "val.json"
    write_episodes(EpisodeDataset(episodes=[]), file)
    before = file.read_bytes()

    def full(path, data):
        path.touch()
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(OSError, match="No space left"):
        write_episodes(EpisodeDataset(episodes=[], category_to_task_category_id={"bed": 1}), file)
    assert file.read_bytes() == before
    assert list(tmp_path.iterdir()) == [file]


@pytest.mark.parametrize("name", ["a.json", "a.json.gz"])
def test_a_byte_order_mark_is_no_content(name, tmp_path):
    text = b"\xef\xbb\xbf" + json.dumps(CONTENT).encode()
    (tmp_path / name).write_bytes(gzip.compress(text) if name.endswith("gz") else text)
    assert read_episodes(tmp_path / name) == EpisodeDataset.model_validate(CONTENT)
