import math
import subprocess
import sys
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import hypernav.envs
from box_scenes import room_boxes, scene_of
from certainty import certain
from hypernav.app.build.env import ObjectNavConfig, ObjectNavEnv
from hypernav.core.embodiment import Action, CameraConfig, Embodiment
from hypernav.core.errors import ConfigError, GoalError, SceneError, StartError, WorldError
from hypernav.core.geometry.transforms import Pose2
from hypernav.simulator.worlds.config import NoiseConfig, SimulationConfig
from hypernav.simulator.worlds.simulation import SimulatedWorld

BED = ("bed", (4.4, 1.0, 0.0), (6.0, 3.0, 0.5))
SOFA = ("sofa", (0.0, 3.2, 0.0), (1.6, 4.0, 0.8))
SCENE = scene_of(*room_boxes(), BED, SOFA)
EMBODIMENT = Embodiment(camera=CameraConfig(width=32, height=24))
CONFIG = ObjectNavConfig(embodiment=EMBODIMENT)
FACING_BED = (1.0, 2.0, 0.0)
ENV_ID = "hypernav/ObjectNav-v0"
GO = int(Action.MOVE_FORWARD)
STOP = int(Action.STOP)


def make(goal: str | None = "bed", **options) -> ObjectNavEnv:
    options.setdefault("config", CONFIG)
    return ObjectNavEnv(SCENE, goal, **options)


@pytest.mark.parametrize(
    "noise", [NoiseConfig(), NoiseConfig(depth_sigma_m=0.01, turn_sigma_deg=1)]
)
def test_gymnasiums_own_checker_accepts_it(noise):
    config = ObjectNavConfig(embodiment=EMBODIMENT, simulation=SimulationConfig(noise=noise))
    env = gymnasium.make(ENV_ID, scene=SCENE, config=config, render_mode="rgb_array")
    check_env(env.unwrapped)


def test_gymnasium_finds_it_by_module_and_name():
    config = ObjectNavConfig(embodiment=Embodiment(camera=CameraConfig(width=32, height=24)))
    gymnasium.register_envs(hypernav.envs)
    env = gymnasium.make(f"hypernav.envs:{ENV_ID}", scene=SCENE, config=config)
    assert isinstance(env.unwrapped, ObjectNavEnv)


def test_a_size_overrides_the_cameras():
    env = gymnasium.make(ENV_ID, scene=SCENE, size=(40, 30))
    observation, _ = env.reset(seed=0)
    assert observation["rgb"].shape == (30, 40, 3)
    assert observation["depth"].shape == (30, 40)


def test_without_colours_an_observation_has_no_image_and_the_rest_is_the_same():
    with_image, _ = make().reset(seed=3)
    env = make(colours=False)
    check_env(env, skip_render_check=True)
    without, _ = env.reset(seed=3)
    assert set(with_image) - set(without) == {"rgb"}
    for name in ("depth", "pose"):
        assert np.array_equal(without[name], with_image[name])


def test_many_run_side_by_side():
    envs: Any = gymnasium.make_vec(
        ENV_ID, num_envs=2, vectorization_mode="sync", scene=SCENE, goal="bed", size=(32, 24)
    )
    observation, _ = envs.reset(seed=[1, 2])
    assert observation["depth"].shape == (2, 24, 32)
    assert observation["goal"] == ("bed", "bed")
    _, rewards, terminated, _, info = envs.step(np.array([GO, STOP]))
    assert rewards.tolist() == [0.0, 0.0]
    assert terminated.tolist() == [False, True]
    assert info["steps"].tolist() == [1, 1]
    envs.close()


@pytest.mark.slow
def test_a_generated_house_is_a_scene():
    program = (
        "import gymnasium, hypernav.envs as _; "
        f"env = gymnasium.make('{ENV_ID}', scene='houses:7', size=(16, 12), colours=False); "
        "print(env.reset(seed=0)[0]['depth'].shape)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.stdout.split("\n")[-2] == "(12, 16)", done.stderr


def test_stop_at_the_goal_terminates_and_succeeds():
    env = make()
    _, info = env.reset(options={"start": FACING_BED})
    assert info["shortest_path_m"] == pytest.approx(2.4, abs=0.06)
    steps = [env.step(GO) for _ in range(5)]
    for _, reward, terminated, truncated, info in steps:
        assert (reward, terminated, truncated, info["success"]) == (0.0, False, False, False)
    assert steps[-1][0]["pose"] == pytest.approx([2.5, 0.0, 0.0])
    _, reward, terminated, truncated, info = env.step(STOP)
    assert (reward, terminated, truncated) == (1.0, True, False)
    assert info["success"]
    assert info["spl"] == pytest.approx(2.4 / 2.5, abs=0.03)
    assert info["path_length_m"] == pytest.approx(2.5)
    assert info["steps"] == 6
    with pytest.raises(WorldError, match="call reset first"):
        env.step(GO)


def test_stop_elsewhere_terminates_without_success():
    env = make()
    env.reset(options={"start": FACING_BED})
    _, reward, terminated, _, info = env.step(STOP)
    assert (reward, terminated, info["success"], info["spl"]) == (0.0, True, False, 0.0)


def test_the_step_limit_truncates():
    env = make(config=ObjectNavConfig(embodiment=EMBODIMENT, max_steps=3))
    env.reset(options={"start": FACING_BED})
    turn = int(Action.TURN_LEFT)
    assert [env.step(turn)[2:4] for _ in range(3)] == [
        (False, False),
        (False, False),
        (False, True),
    ]
    with pytest.raises(WorldError, match="call reset first"):
        env.step(turn)


def test_stop_in_the_last_step_is_a_termination():
    env = make(config=ObjectNavConfig(embodiment=EMBODIMENT, max_steps=1))
    env.reset(options={"start": FACING_BED})
    assert env.step(STOP)[2:4] == (True, False)


def test_a_goal_that_is_not_there_is_legal():
    env = make("umbrella")
    observation, info = env.reset(seed=1)
    assert observation["goal"] == "umbrella"
    assert info["distance_to_goal_m"] == math.inf
    assert env.step(STOP)[4]["success"] is False


def test_goals_and_starts_are_drawn_from_the_seed():
    env, other = make(None), make(None)
    drawn = [env.reset(seed=7 if k == 0 else None)[1] for k in range(6)]
    again = [other.reset(seed=7 if k == 0 else None)[1] for k in range(6)]
    assert drawn == again
    goals = {env.reset()[0]["goal"] for _ in range(20)}
    assert goals == {"bed", "sofa"}
    for _ in range(10):
        assert env.reset()[1]["shortest_path_m"] >= 2.0


def test_options_override_the_constructor():
    env = make("bed")
    observation, _ = env.reset(options={"goal": "couch", "start": Pose2(2.0, 1.0, 1.0)})
    assert observation["goal"] == "couch"
    assert env.goal.text == "couch"
    assert env.world.truth.pose == Pose2(2.0, 1.0, 1.0)
    assert env.reset()[0]["goal"] == "bed"


def test_the_typed_observation_is_at_hand():
    env = make()
    observation, _ = env.reset(seed=0)
    assert np.array_equal(env.observation.rgb, observation["rgb"])
    assert env.observation.truth is not None
    assert env.observation_space.contains(observation)


def test_a_ready_world_is_used_as_it_is():
    world = SimulatedWorld(SCENE, embodiment=EMBODIMENT)
    env = ObjectNavEnv(world, "bed")
    assert env.world is world
    assert env.reset(seed=0)[0]["rgb"].shape == (24, 32, 3)


def test_render_shows_the_camera():
    env = make(render_mode="rgb_array")
    observation, _ = env.reset(seed=0)
    assert np.array_equal(certain(env.render()), observation["rgb"])
    assert make().render() is None


def test_misuse_is_told_in_words(tmp_path):
    env = make()
    for use in (lambda: env.observation, lambda: env.goal, lambda: env.step(GO)):
        with pytest.raises(WorldError, match="reset"):
            use()
    with pytest.raises(WorldError, match=r"unknown reset option 'gaol'.*'goal'"):
        env.reset(options={"gaol": "bed"})
    with pytest.raises(WorldError, match=r"\(x, y, yaw\)"):
        env.reset(options={"start": (1.0, 2.0)})
    with pytest.raises(StartError, match="nearest position"):
        env.reset(options={"start": (5.0, 2.0, 0.0)})
    with pytest.raises(GoalError, match="empty"):
        env.reset(options={"goal": " "})
    with pytest.raises(GoalError, match="at most 200"):
        env.reset(options={"goal": "bed" * 100})
    env.reset(seed=0)
    with pytest.raises(WorldError, match="0, 1, 2, 3"):
        env.step(4)
    with pytest.raises(WorldError, match="render_mode"):
        make(render_mode="human")
    with pytest.raises(WorldError, match="colours"):
        make(render_mode="rgb_array", colours=False)
    with pytest.raises(ConfigError, match=r"embodiment.camera.width.*got 4"):
        make(size=(4, 24))
    with pytest.raises(WorldError, match="leave size out"):
        ObjectNavEnv(SimulatedWorld(SCENE, embodiment=EMBODIMENT), size=(32, 24))
    with pytest.raises(SceneError):
        ObjectNavEnv(tmp_path / "nothing.glb")
    bare = ObjectNavEnv(scene_of(*room_boxes()), config=CONFIG)
    with pytest.raises(GoalError, match="no labelled object"):
        bare.reset(seed=0)
