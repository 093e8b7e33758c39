import json
from pathlib import Path

import pytest

from eval_runs import spec, write_room
from hypernav.app.build.data.datasets import canonical_name, fingerprint, load_episodes, select
from hypernav.app.build.data.scenes import load_scene
from hypernav.core.errors import ComponentError, ConfigError, EpisodeError, SceneError
from hypernav.simulator.worlds.scenes.loading import read_scene
from hypernav.simulator.worlds.simulation import SimulatedWorld
from small_worlds import small_config

EPISODES = [spec(str(k), scene) for k, scene in enumerate(["houses:7", "houses:8", "houses:9"] * 2)]


@pytest.fixture(scope="module")
def room(tmp_path_factory):
    return write_room(tmp_path_factory.mktemp("scene") / "room.glb")


def test_a_scene_is_all_its_goals_from_seeded_starts(room):
    world = small_config().world
    episodes = load_episodes(f"scene:{room}#3", world)
    assert [e.episode_id for e in episodes] == [
        f"{g}-{k}" for g in ("bed", "sofa") for k in range(3)
    ]
    assert len({e.start for e in episodes}) == 6
    assert load_episodes(f"scene:{room}#3", world) == episodes
    # More starts leave those that were there as they are.
    assert set(episodes) < set(load_episodes(f"scene:{room}#4", world))
    simulated = SimulatedWorld(read_scene(room), world)
    for episode in episodes:
        assert simulated.walkable.is_standable(*episode.start.xy)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("houses-train#x", "expected house numbers"),
        ("houses-train#5:", "expected house numbers"),
        ("houses-val#5", "houses-val has the houses"),
        ("houses-train#1000:1002", "belong to houses-val"),
    ],
)
def test_a_data_set_that_does_not_exist_is_named_with_the_remedy(name, words):
    with pytest.raises(EpisodeError, match=words):
        load_episodes(name)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("houses-vall", "did you mean 'houses-val'"),
        ("gibson", "use houses-val, houses-ovon"),
        ("hm3d", "expected hm3d:DIR"),
        ("habitat", "expected habitat:FILE"),
        ("houses-val:3", "nothing follows this name"),
    ],
)
def test_a_data_set_that_does_not_exist_is_named_with_those_that_do(name, words):
    with pytest.raises(ConfigError, match=words):
        load_episodes(name)


def test_a_scene_that_does_not_exist_is_named():
    with pytest.raises(SceneError, match=r"nowhere\.glb"):
        load_episodes("scene:nowhere.glb")


def test_an_own_episode_that_begins_nowhere_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    (tmp_path / "own_episodes.py").write_text(
        "from hypernav import Episode, Goal, Pose2\n\n"
        "def nowhere(request):\n"
        "    return [Episode('builtin', 'first', Goal('bed'), Pose2(1.0, float('nan'), 0.0))]\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(ComponentError, match=r"own_episodes:nowhere: .* 'first' with the start"):
        load_episodes("own_episodes:nowhere")


def test_starts_must_be_a_number(room):
    with pytest.raises(EpisodeError, match="number of starts"):
        load_episodes(f"scene:{room}#many")


@pytest.mark.parametrize(
    ("chosen", "ids"),
    [
        ({"part": "0:2"}, "01"),
        ({"part": "4:100"}, "45"),
        ({"part": ":3"}, "012"),
        ({"part": "4:"}, "45"),
        ({"scenes": "8"}, "14"),
        ({"scenes": "houses:7, 9"}, "0235"),
        ({"scenes": "0"}, "03"),
        ({"scenes": "8", "part": "0:3"}, "1"),
        ({"goals": "bed"}, "012345"),
        ({"goals": "berth,", "words": {"berth": "bed"}}, "012345"),
        ({"scenes": "8, ,"}, "14"),
        ({}, "012345"),
    ],
)
def test_choosing_episodes(chosen, ids):
    assert "".join(e.episode_id for e in select(EPISODES, **chosen)) == ids


@pytest.mark.parametrize(
    ("chosen", "words"),
    [
        ({"part": "3"}, "expected FIRST:END"),
        ({"part": "5:2"}, "holds none of the 6"),
        ({"part": "6:9"}, "holds none of the 6"),
        ({"part": "-1:2"}, "expected FIRST:END"),
        ({"scenes": "houses:10"}, "there are 3, from houses:7 to houses:9"),
        ({"goals": "piano"}, "no episode asks for 'piano'"),
        ({"goals": " ,"}, "--goals ' ,': names nothing"),
        ({"scenes": ","}, "--scenes ',': names nothing"),
        ({"part": "0:1", "scenes": "9"}, "the selection leaves none"),
    ],
)
def test_choosing_what_is_not_there_is_an_error(chosen, words):
    with pytest.raises(EpisodeError, match=words):
        select(EPISODES, **chosen)


def test_the_fingerprint_knows_every_episode_and_the_order():
    assert fingerprint(EPISODES) == fingerprint(list(EPISODES))
    assert fingerprint(EPISODES) != fingerprint(EPISODES[:-1])
    assert fingerprint(EPISODES) != fingerprint(EPISODES[::-1])


def test_the_same_building_in_another_folder_gives_the_same_episodes(room, tmp_path):
    moved = tmp_path / room.name
    moved.write_bytes(room.read_bytes())
    here, there = (load_episodes(f"scene:{path}#2") for path in (room, moved))
    assert [e.start for e in here] == [e.start for e in there]
    assert [e.seed(0) for e in here] == [e.seed(0) for e in there]


def test_every_episode_has_a_seed_of_its_own():
    seeds = {e.seed(0) for e in EPISODES} | {e.seed(1) for e in EPISODES}
    assert len(seeds) == 12
    assert EPISODES[0].seed(0) == spec("0", "houses:7").seed(0)


@pytest.mark.parametrize(
    ("name", "canonical"),
    [
        ("hm3d:d2/#v1/val/", "hm3d:d2#v1/val"),
        ("hm3d:/#val", "hm3d:/#val"),
        ("houses-val#1000:1004", "houses-val#1000:1004"),
    ],
)
def test_slashes_that_say_nothing_are_left_out(name, canonical):
    assert canonical_name(name) == canonical


@pytest.mark.parametrize(
    ("name", "starts"), [("flat#3.glb", ""), ("flat#3.glb", "#1"), ("a#2", "")]
)
def test_a_hash_in_the_path_of_a_scene_belongs_to_its_name(room, tmp_path, name, starts):
    path = tmp_path / name if name.endswith(".glb") else tmp_path / name / "room.glb"
    path.parent.mkdir(exist_ok=True)
    path.write_bytes(room.read_bytes())
    assert {e.scene_id for e in load_episodes(f"scene:{path}{starts}")} == {str(path)}
    assert canonical_name(f"scene:{path}{starts}") == f"scene:{path}{starts}"


def test_back_slashes_in_a_scene_id_are_named(tmp_path):
    episodes = tmp_path / "episodes.json"
    text = {
        "episodes": [
            {
                "episode_id": "0",
                "scene_id": "homes\\room.glb",
                "start_position": [1, 0, -1],
                "start_rotation": [0, 0, 0, 1],
                "object_category": "bed",
                "goals": [],
            }
        ],
        "goals_by_category": {},
    }
    episodes.write_text(json.dumps(text))
    with pytest.raises(EpisodeError, match="back slashes separate no folders"):
        load_episodes(f"habitat:{episodes}")
    with pytest.raises(SceneError, match="back slashes separate no folders"):
        load_scene("homes\\room.glb")
