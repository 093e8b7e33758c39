"""A file in Habitat's format is a data set that measures like the split it was written from."""

import gzip
import json
import shutil
from dataclasses import replace

import numpy as np
import pytest

from box_houses import box_house
from eval_runs import write_room
from hypernav.app.build.data.datasets import fingerprint, load_episodes
from hypernav.core.errors import EpisodeError
from hypernav.lab.evaluation.workers.job import Job
from hypernav.lab.evaluation.workers.worker import EpisodeWorker
from hypernav.simulator.houses.building import Building
from hypernav.simulator.houses.episodes import splits
from hypernav.simulator.houses.episodes.splits import load_split
from hypernav.simulator.houses.export import habitat_data
from small_worlds import InScenes, small_config

SPLIT = "houses-train"
HOUSES = range(5, 7)


@pytest.fixture(scope="module")
def split(tmp_path_factory):
    """A split of two houses out of boxes."""
    cache = tmp_path_factory.mktemp("cache")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(splits, "cached_building", box_house)
        patch.setattr(habitat_data, "cached_building", box_house)
        patch.setattr(splits, "cache_folder", lambda: cache)
        yield load_split(SPLIT, numbers=HOUSES)


@pytest.fixture(scope="module")
def written(split, tmp_path_factory):
    """The split in one file."""
    file = tmp_path_factory.mktemp("split") / "val.json.gz"
    habitat_data.write_split(split, file)
    return file


@pytest.fixture
def file(written, tmp_path):
    """A copy of it."""
    return shutil.copyfile(written, tmp_path / "val.json.gz")


def records(episodes, tmp_path, count=5):
    """What comes of the first few episodes, without the seconds that they took."""
    worker = EpisodeWorker(Job(tmp_path, small_config(), world=InScenes(open_box_house)))
    chosen = [replace(episode, max_steps=40) for episode in episodes[:count]]
    return [worker.run(episode).model_dump(mode="json", exclude={"seconds"}) for episode in chosen]


def open_box_house(scene_id):
    return box_house(Building.named(scene_id))


def edit(path, change):
    content = json.loads(gzip.decompress(path.read_bytes()))
    change(content)
    path.write_bytes(gzip.compress(json.dumps(content).encode()))


def all_view_points(content):
    for goals in content["goals_by_category"].values():
        for goal in goals:
            yield from goal["view_points"]


def test_a_written_split_gives_the_same_records_as_the_split_itself(file, tmp_path):
    own, read = load_episodes(f"{SPLIT}#5:7"), load_episodes(f"habitat:{file}")
    assert read == own
    assert all(episode.view_points is None for episode in own)
    assert all(episode.view_points is not None for episode in read)
    assert records(read, tmp_path) == records(own, tmp_path)


def test_editing_a_view_point_changes_the_result(file, tmp_path):
    before = load_episodes(f"habitat:{file}")

    def keep_one(content):
        for goals in content["goals_by_category"].values():
            for goal in goals:
                del goal["view_points"][1:]

    edit(file, keep_one)
    after = load_episodes(f"habitat:{file}")
    assert fingerprint(after) != fingerprint(before)
    first, changed = records(before, tmp_path, 1)[0], records(after, tmp_path, 1)[0]
    assert changed["shortest_path_m"] > first["shortest_path_m"]
    assert changed["distance_to_goal_m"] > first["distance_to_goal_m"]


def test_a_split_in_a_folder_is_habitats_layout(split, tmp_path):
    habitat_data.write_split(split, tmp_path / "val")
    assert sorted(p.name for p in (tmp_path / "val" / "content").iterdir()) == [
        "houses-5.json.gz",
        "houses-6.json.gz",
    ]
    by_folder = load_episodes(f"habitat:{tmp_path / 'val'}")
    by_file = load_episodes(f"habitat:{tmp_path / 'val' / 'val.json.gz'}")
    assert by_folder == by_file
    assert {e.key for e in by_folder} == {e.key for e in load_episodes(f"{SPLIT}#5:7")}


def test_a_goal_whose_file_brings_no_view_points_is_measured_by_the_scene(file):
    count = len(load_episodes(f"habitat:{file}"))
    assert count > 0

    def drop_all(content):
        for goals in content["goals_by_category"].values():
            for goal in goals:
                goal["view_points"] = []

    edit(file, drop_all)
    assert [e.view_points for e in load_episodes(f"habitat:{file}")] == [None] * count


@pytest.fixture
def room_file(written, tmp_path):
    """An episode file about a scene beside it."""
    (tmp_path / "set").mkdir()
    file = shutil.copyfile(written, tmp_path / "set" / "val.json.gz")

    def rename(content):
        content["episodes"] = content["episodes"][:1]
        content["episodes"][0]["scene_id"] = "scans/room.glb"
        key = f"_{content['episodes'][0]['object_category']}"
        goals = next(v for k, v in content["goals_by_category"].items() if k.endswith(key))
        content["goals_by_category"] = {f"room.glb{key}": goals}

    edit(file, rename)
    return file


def test_scenes_lie_below_the_folder_of_the_file(room_file):
    scene = write_room(room_file.parent / "scans" / "room.glb")
    assert [e.scene_id for e in load_episodes(f"habitat:{room_file}")] == [str(scene)]


def test_or_below_the_folder_that_is_named(room_file, tmp_path):
    scene = write_room(tmp_path / "elsewhere" / "scans" / "room.glb")
    found = load_episodes(f"habitat:{room_file}", scenes_dir=tmp_path / "elsewhere")
    assert [e.scene_id for e in found] == [str(scene)]


def test_or_with_other_textures_below_the_folder_of_scenes(room_file, tmp_path):
    scene = write_room(tmp_path / "scene_datasets" / "scans" / "room.basis.glb")
    for scenes_dir in (None, tmp_path):
        found = load_episodes(f"habitat:{room_file}", scenes_dir=scenes_dir)
        assert [e.scene_id for e in found] == [str(scene)]


def test_a_scene_that_is_nowhere_says_all_places_where_it_was_looked_for(room_file, tmp_path):
    (tmp_path / "scene_datasets").mkdir()
    places = rf"below {room_file.parent} or {tmp_path / 'scene_datasets'};"
    with pytest.raises(EpisodeError, match=rf"val\.json\.gz: there is no scene .*{places}"):
        load_episodes(f"habitat:{room_file}")


def test_two_episodes_of_one_name_are_refused(file):
    edit(file, lambda content: content["episodes"].append(content["episodes"][0]))
    with pytest.raises(EpisodeError, match="two episodes are called 5-0"):
        load_episodes(f"habitat:{file}")


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("habitat:nowhere.json.gz", "no episode file"),
        ("habitat:val.json.gz#3", "choose episodes with --episodes"),
    ],
)
def test_what_is_wrong_with_the_name_is_said(name, words):
    with pytest.raises(EpisodeError, match=words):
        load_episodes(name)


def test_habitats_own_sample_is_read_with_its_view_points(test_data, tmp_path):
    sample = test_data / "habitat" / "objectnav_mp3d_v1_sample.json.gz"
    content = json.loads(gzip.decompress(sample.read_bytes()))
    for scene in {episode["scene_id"] for episode in content["episodes"]}:
        write_room(tmp_path / scene)
    episodes = load_episodes(f"habitat:{sample}", scenes_dir=tmp_path)
    assert len(episodes) == len(content["episodes"])
    points = episodes[0].view_points
    assert points is not None
    assert np.isfinite(points).all()
