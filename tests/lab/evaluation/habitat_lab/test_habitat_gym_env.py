import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from certainty import certain
from habitat_room import habitat_config
from hypernav.core.errors import WorldError
from hypernav.lab.evaluation.habitat_lab.gym_env import HabitatGymEnv
from hypernav.lab.evaluation.habitat_lab.task import HabitatTask

STOP, GO, LEFT = range(3)


@pytest.mark.parametrize("sensors", [("rgb", "depth"), ("rgb", "depth", "semantic")])
def test_gymnasiums_own_checker_accepts_it(room, sensors):
    task = HabitatTask(sensors=sensors, shuffle=True)
    name = "hypernav.envs:hypernav/HabitatObjectNav-v0"
    made = gymnasium.make(
        name, config=habitat_config(room), task=task, render_mode="rgb_array", max_episode_steps=9
    )
    check_env(made.unwrapped)
    made.close()


def test_the_reward_is_habitats(room):
    env = HabitatGymEnv(habitat_config(room))
    env.reset(seed=100)
    rewards = [env.step(GO)[1] for _ in range(10)]
    assert rewards == pytest.approx(10 * [0.25 - 0.01], abs=1e-3)
    _, reward, terminated, truncated, info = env.step(STOP)
    assert reward == pytest.approx(2.5 - 0.01)
    assert (terminated, truncated) == (True, False)
    assert info["spl"] == pytest.approx(1.0, abs=1e-3)
    env.close()


def test_the_step_limit_truncates_and_a_reset_goes_on(room):
    config = habitat_config(room)
    config["habitat"]["environment"]["max_episode_steps"] = 2
    env = HabitatGymEnv(config)
    first, _ = env.reset(seed=100)
    assert [env.step(LEFT)[2:4] for _ in range(2)] == [(False, False), (False, True)]
    env.reset()
    assert env.habitat_env.current_episode.episode_id == "2"
    again, _ = env.reset(seed=100)
    assert np.array_equal(first["rgb"], again["rgb"])
    env.close()


def test_render_shows_the_camera(room):
    env = HabitatGymEnv(habitat_config(room), render_mode="rgb_array")
    observation, _ = env.reset()
    assert np.array_equal(certain(env.render()), observation["rgb"])
    env.render_mode = None
    assert env.render() is None
    env.close()
    with pytest.raises(WorldError, match="render_mode"):
        HabitatGymEnv(habitat_config(room), render_mode="human")
