import random
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from habitat_room import CATEGORIES, habitat_config
from hypernav.core.errors import EpisodeError, WorldError
from hypernav.lab.evaluation.habitat_lab.env import HabitatEnv
from hypernav.lab.evaluation.habitat_lab.task import HabitatTask

STOP, GO, LEFT, RIGHT, UP, DOWN = range(6)


@pytest.fixture(scope="module")
def shared(room: Path) -> Iterator[HabitatEnv]:
    with HabitatEnv(habitat_config(room)) as env:
        yield env


@pytest.fixture
def env(shared: HabitatEnv) -> HabitatEnv:
    shared.seed(100)
    return shared


def test_episodes_of_a_scene_follow_each_other_and_begin_again(env):
    assert env.number_of_episodes == 3
    assert [episode.episode_id for episode in env.episodes] == ["0", "2", "1"]
    assert env.current_episode.episode_id == "0"
    seen = [(env.reset(), env.current_episode)[1].episode_id for _ in range(4)]
    assert seen == ["0", "2", "1", "0"]
    assert env.current_episode.object_category == "bed"
    assert env.current_episode.scene_id.endswith("b.glb")


def test_the_spaces_are_those_of_the_data_set(env):
    observations = env.reset()
    assert env.observation_space.contains(observations)
    assert observations["objectgoal"] == [CATEGORIES["bed"]]
    assert env.observation_space["objectgoal"].high == [max(CATEGORIES.values())]
    assert env.action_space.n == 6


def test_the_measures_are_those_computed_by_hand(env):
    """The bed's view point is 2.5 m ahead of the start; a detour of two steps costs SPL."""
    env.reset()
    zero = {"count": 0, "is_collision": False}
    assert env.get_metrics() == {
        "distance_to_goal": pytest.approx(2.5),
        "success": 0.0,
        "spl": 0.0,
        "soft_spl": 0.0,
        "distance_to_goal_reward": 0.0,
        "num_steps": 0,
        "collisions": zero,
    }
    observations = env.step(GO)
    assert observations["gps"] == pytest.approx([0.25, 0.0])
    assert env.get_metrics() == {
        "distance_to_goal": pytest.approx(2.25),
        "success": 0.0,
        "spl": 0.0,
        "soft_spl": pytest.approx(1.0 - 2.25 / 2.5),
        "distance_to_goal_reward": pytest.approx(0.25),
        "num_steps": 1,
        "collisions": zero,
    }
    for action in [*6 * [LEFT], GO, *6 * [RIGHT], *10 * [GO]]:
        env.step(action)
    assert env.get_metrics()["success"] == 0.0
    assert not env.episode_over
    env.step(STOP)
    assert env.episode_over
    metrics = env.get_metrics()
    assert metrics["success"] == 1.0
    assert metrics["spl"] == pytest.approx(2.5 / 3.0)
    assert metrics["soft_spl"] == pytest.approx(2.5 / 3.0, abs=1e-3)
    assert metrics["distance_to_goal"] == pytest.approx(0.0, abs=1e-3)
    assert metrics["num_steps"] == 25


def test_stop_elsewhere_is_no_success(env):
    env.reset()
    env.step(GO)
    env.step("stop")
    metrics = env.get_metrics()
    assert (metrics["success"], metrics["spl"]) == (0.0, 0.0)
    assert metrics["soft_spl"] == pytest.approx(0.1)


def test_collisions_are_counted(env):
    env.reset()
    for _ in range(12):
        env.step(GO)
    blocked = env.get_metrics()["collisions"]
    assert blocked["is_collision"]
    assert blocked["count"] >= 1
    env.step(DOWN)
    assert env.get_metrics()["collisions"] == {"count": blocked["count"], "is_collision": False}


def test_an_action_is_a_number_a_name_or_a_mapping(env):
    def compass(action):
        env.seed(100)
        env.reset()
        return float(env.step(action)["compass"][0])

    forms = (2, np.int64(2), "turn_left", {"action": 2}, {"action": "turn_left", "action_args": {}})
    assert {compass(form) for form in forms} == {compass(LEFT)}
    assert compass(LEFT) == pytest.approx(np.pi / 6)


@pytest.mark.parametrize("action", [6, -1, "jump", None, {"action": "jump"}, {}, 1.0])
def test_an_action_that_does_not_exist_is_refused_with_those_that_do(env, action):
    env.reset()
    with pytest.raises(WorldError, match=r"the actions are 0 stop, 1 move_forward, .*5 look_down"):
        env.step(action)


def test_looking_down_and_up_again_shows_the_same_images(env):
    level = env.reset()
    down = env.step(DOWN)
    again = env.step(UP)
    assert down["depth"][40:].mean() < level["depth"][40:].mean()
    assert down["gps"] == pytest.approx(level["gps"])
    for name in ("rgb", "depth"):
        assert np.array_equal(again[name], level[name])
    assert env.get_metrics()["num_steps"] == 2


def test_the_camera_is_level_again_in_the_next_episode(env):
    level = env.reset()
    env.step(DOWN)
    env.seed(100)
    assert np.array_equal(env.reset()["depth"], level["depth"])


def test_the_steps_run_out(room):
    config = habitat_config(room)
    config["habitat"]["environment"]["max_episode_steps"] = 2
    with HabitatEnv(config) as env:
        env.reset()
        env.step(LEFT)
        assert not env.episode_over
        env.step(LEFT)
        assert env.episode_over
        assert not env.is_stop_called
        with pytest.raises(WorldError, match="call reset first"):
            env.step(LEFT)


def test_the_next_episode_can_be_chosen(env):
    env.reset()
    env.current_episode = env.episodes[2]
    with pytest.raises(WorldError, match="call reset first"):
        env.step(GO)
    env.reset()
    assert env.current_episode.episode_id == "1"
    env.reset()
    assert env.current_episode.episode_id == "2"


def test_episodes_can_be_left_out(room):
    with HabitatEnv(habitat_config(room)) as env:
        env.episodes = [episode for episode in env.episodes if episode.episode_id == "1"]
        assert env.number_of_episodes == 1
        env.reset()
        assert env.current_episode.episode_id == "1"
        with pytest.raises(EpisodeError, match="at least one"):
            env.episodes = []


def test_shuffled_episodes_come_in_habitats_order(room):
    config = habitat_config(room)
    config["habitat"]["environment"]["iterator_options"]["shuffle"] = True
    with HabitatEnv(config) as env:
        given = sorted(env.episodes, key=lambda episode: int(episode.episode_id))
        for seed in (100, 1, 2, 3):
            env.seed(seed)
            expected = list(given)
            random.Random(seed).shuffle(expected)
            scenes = list(dict.fromkeys(episode.scene_id for episode in expected))
            expected.sort(key=lambda episode: scenes.index(episode.scene_id))
            assert env.episodes == expected


def test_semantic_shows_the_number_of_the_annotation(room):
    task = HabitatTask(sensors=("semantic",))
    with HabitatEnv(habitat_config(room), task) as env:
        observations = env.reset()
        assert set(observations) == {"semantic", "objectgoal", "compass", "gps"}
        bed = 6
        assert bed in observations["semantic"]


def test_categories_without_numbers_are_counted_in_alphabetical_order(env):
    given = env.episodes
    bed, chair = (replace(given[0], object_category=name, category_ids={}) for name in "bc")
    try:
        env.episodes = [chair, replace(bed, episode_id="9")]
        assert [env.reset()["objectgoal"][0] for _ in range(2)] == [1, 0]
    finally:
        env.episodes = given


def test_an_observation_belongs_to_its_reader(env):
    first = env.reset()
    first["rgb"][:] = 0
    assert env.step(STOP)["rgb"].any()
    assert env.render().any()


def test_misuse_is_told_in_words(room):
    env = HabitatEnv(habitat_config(room))
    for use in (env.get_metrics, lambda: env.step(GO), env.render):
        with pytest.raises(WorldError, match="reset"):
            use()
    with pytest.raises(WorldError, match="shows 'rgb'"):
        env.render("human")
