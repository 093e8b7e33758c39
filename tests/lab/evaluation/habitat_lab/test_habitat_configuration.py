from collections import UserDict
from copy import deepcopy
from pathlib import Path
from typing import Any

import pytest

from habitat_room import habitat_config
from hypernav.core.embodiment import BodyConfig, CameraConfig, Embodiment, MotionConfig
from hypernav.core.errors import ConfigError
from hypernav.lab.datasets.benchmarks import BENCHMARKS
from hypernav.lab.evaluation.habitat_lab.configuration import plan_of
from hypernav.lab.evaluation.habitat_lab.task import HabitatTask
from hypernav.lab.evaluation.run_plan import RunPlan

AGENT = "simulator.agents.main_agent"


def changed(key: str, value: Any) -> dict[str, Any]:
    config = deepcopy(habitat_config(Path("data")))
    *path, last = key.split(".")
    node = config["habitat"]
    for part in path:
        node = node[part]
    node[last] = value
    return config


def test_a_composed_configuration_says_robot_task_and_episodes():
    plan, task = plan_of(habitat_config(Path("data")))
    assert plan.config.embodiment == Embodiment(
        body=BodyConfig(radius_m=0.18, height_m=0.88, max_step_m=0.2, max_slope_deg=45.0),
        camera=CameraConfig(width=64, height=48, hfov_deg=79.0, height_m=0.88),
        motion=MotionConfig(forward_m=0.25, turn_angle_deg=30.0),
    )
    assert not plan.config.world.sliding
    assert plan.dataset == "habitat:data/val/val.json.gz"
    assert plan.scenes_dir == Path("data/scene_datasets")
    assert (plan.max_steps, plan.success_distance_m, plan.seed) == (500, 0.1, 100)
    assert task == HabitatTask()


@pytest.mark.parametrize(
    ("key", "value", "read"),
    [
        (f"{AGENT}.sim_sensors.depth_sensor.normalize_depth", False, "normalize_depth"),
        ("environment.iterator_options.shuffle", True, "shuffle"),
        ("task.slack_reward", -0.001, "slack_reward"),
        ("task.success_reward", 10.0, "success_reward"),
    ],
)
def test_a_value_is_read_where_habitat_has_it(key, value, read):
    assert getattr(plan_of(changed(key, value))[1], read) == value


def test_scenes_sensors_and_actions_may_be_others():
    plan, _ = plan_of(changed("dataset.content_scenes", ["wcojb4TFT35", "TEEsavR23oF"]))
    assert plan.selection.scenes == "wcojb4TFT35,TEEsavR23oF"
    sensors = {"semantic_sensor": {"type": "HabitatSimSemanticSensor"}}
    assert plan_of(changed(f"{AGENT}.sim_sensors", sensors))[1].sensors == ("semantic",)
    actions = {name: {"type": "A"} for name in ("stop", "turn_left", "move_forward")}
    assert plan_of(changed("task.actions", actions))[1].actions == tuple(actions)


def test_what_is_absent_is_habitats_default():
    plan, task = plan_of(changed("environment", {}))
    assert (plan.max_steps, task.shuffle) == (1000, True)
    plan, _ = plan_of(changed("task.measurements", {}))
    assert plan.success_distance_m == 0.2


def test_a_camera_that_looks_up_has_a_negative_pitch():
    config = changed(f"{AGENT}.sim_sensors", {})
    view = {"type": "HabitatSimRGBSensor", "orientation": [0.5236, 0, 0], "position": [0, 1.1, 0]}
    config["habitat"]["simulator"]["agents"]["main_agent"]["sim_sensors"] = {"rgb_sensor": view}
    camera = plan_of(config)[0].config.embodiment.camera
    assert camera.pitch_deg == pytest.approx(-30.0, abs=0.01)
    assert camera.height_m == 1.1


def test_any_mapping_will_do_with_or_without_its_root():
    config = habitat_config(Path("data"))
    assert plan_of(UserDict(config)) == plan_of(config) == plan_of(config["habitat"])


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("task.type", "Nav-v0", "'Nav-v0' doesn't exist here; there is ObjectNav-v1"),
        ("dataset.type", "OVON-v1", "'OVON-v1'"),
        ("task.measurements", {"map": {"type": "TopDownMap"}}, "measure 'TopDownMap'"),
        ("task.measurements.distance_to_goal.distance_to", "POINT", "'POINT'"),
        ("task.lab_sensors.heading", {"type": "HeadingSensor"}, "sensor 'HeadingSensor'"),
        ("task.lab_sensors.gps_sensor.dimensionality", 3, "dimensionality '3'"),
        ("task.lab_sensors.objectgoal_sensor.goal_spec", "OBJECT_ID", "'OBJECT_ID'"),
        ("task.actions.teleport", {"type": "TeleportAction"}, "action 'teleport'"),
        ("task.actions.look_up.tilt_angle", 15, "tilt_angle '30.0'"),
        (f"{AGENT}.sim_sensors.rgb_sensor.noise_model", "Gaussian", "'Gaussian'"),
        (f"{AGENT}.sim_sensors.rgb_sensor.width", 32, "share one size"),
        (f"{AGENT}.sim_sensors", {"s": {"type": "X", "position": [0.1, 1, 0]}}, "camera 'X'"),
        ("simulator.agents.other", {"sim_sensors": {}}, "number of agents '2'"),
        ("task.reward_measure", "soft_spl", "reward_measure 'soft_spl'"),
        ("task.success_measure", "success", "success_measure 'success'"),
        ("environment.iterator_options", {"num_episode_sample": 5}, "num_episode_sample '5'"),
        ("environment.iterator_options", {"group_by_scene": False}, "group_by_scene 'False'"),
        ("simulator.action_space_config", "pyrobotnoisy", "action_space_config 'pyrobotnoisy'"),
        ("simulator.turn_angle", 7, "must divide a circle"),
        ("simulator.turn_angle", "thirty", "habitat.simulator.turn_angle"),
        ("task", {}, r"habitat\.task\.actions: .*habitat.get_config"),
    ],
)
def test_what_has_no_counterpart_is_refused_by_name(key, value, words):
    with pytest.raises(ConfigError, match=words):
        plan_of(changed(key, value))


def test_a_camera_beside_the_robots_middle_is_refused():
    view = {"type": "HabitatSimRGBSensor", "position": [0.1, 1.0, 0.0]}
    with pytest.raises(ConfigError, match="above the middle of the robot"):
        plan_of(changed(f"{AGENT}.sim_sensors", {"rgb_sensor": view}))


def test_the_name_of_a_data_set_brings_the_robot_of_its_benchmark():
    for name, benchmark in (("ovon:data", "ovon"), ("houses-val", "hm3d")):
        plan, task = plan_of(name)
        assert plan.config.embodiment == BENCHMARKS[benchmark].embodiment
        assert plan.success_distance_m == BENCHMARKS[benchmark].success_distance_m
        assert (plan.dataset, task) == (name, HabitatTask())


def test_a_plan_is_taken_as_it_is():
    plan = RunPlan("houses-val", max_steps=7)
    assert plan_of(plan) == (plan, HabitatTask())
