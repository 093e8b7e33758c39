"""Translates habitat-lab's configuration of an ObjectNav task into our plan of a run.

Only what changes observations, actions, episodes or measures is read. What has no counterpart here
is refused, so that no environment differs from what its configuration says. Values that are absent
are habitat-lab's defaults (``habitat/config/default_structured_configs.py``).
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.errors import ConfigError
from hypernav.io.layered_config import layered
from hypernav.lab.datasets.benchmarks import BENCHMARKS, benchmark_of
from hypernav.lab.evaluation.habitat_lab.task import HabitatTask
from hypernav.lab.evaluation.run_plan import RunPlan, Selection

_CAMERAS = {
    "HabitatSimRGBSensor": "rgb",
    "HabitatSimDepthSensor": "depth",
    "HabitatSimSemanticSensor": "semantic",
}
_LAB_SENSORS = ("ObjectGoalSensor", "CompassSensor", "GPSSensor")
_MEASURES = (
    "DistanceToGoal",
    "Success",
    "SPL",
    "SoftSPL",
    "DistanceToGoalReward",
    "NumStepsMeasure",
    "Collisions",
)
_TASK = "ObjectNav-v1"
_EXACT_MOTION = ("v0", "v1")
"""Habitat's sets of actions without noise of the motors."""
_EVERYTHING = ["*"]
_Vector = tuple[float, float, float]


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="ignore")


class _Camera(_Part):
    type: str
    width: int = 640
    height: int = 480
    hfov: float = 90.0
    position: _Vector = (0.0, 1.25, 0.0)
    orientation: _Vector = (0.0, 0.0, 0.0)
    sensor_subtype: str = "PINHOLE"
    noise_model: str = "None"
    min_depth: float = 0.0
    max_depth: float = 10.0
    normalize_depth: bool = True

    @property
    def view(self) -> tuple[Any, ...]:
        """The values that all cameras of a robot must share."""
        return (self.width, self.height, self.hfov, self.position, self.orientation)


class _Agent(_Part):
    height: float = 1.5
    radius: float = 0.1
    max_climb: float = 0.2
    max_slope: float = 45.0
    sim_sensors: dict[str, _Camera] = Field(default_factory=dict)


class _Physics(_Part):
    allow_sliding: bool = True


class _Simulator(_Part):
    forward_step_size: float = 0.25
    turn_angle: float = 10.0
    action_space_config: str = "v0"
    agents: dict[str, _Agent]
    habitat_sim_v0: _Physics = _Physics()


class _Iterator(_Part):
    shuffle: bool = True
    group_by_scene: bool = True
    num_episode_sample: int = -1
    max_scene_repeat_episodes: int = -1


class _Environment(_Part):
    max_episode_steps: int = 1000
    iterator_options: _Iterator = _Iterator()


class _Entity(_Part):
    """An action, a sensor or a measure; each uses some of the values."""

    type: str
    tilt_angle: float = 15.0
    goal_spec: str = "TASK_CATEGORY_ID"
    dimensionality: int = 2
    distance_to: str = "POINT"
    success_distance: float = 0.2


class _Task(_Part):
    type: str = "Nav-v0"
    reward_measure: str | None = None
    success_measure: str | None = None
    actions: dict[str, _Entity]
    lab_sensors: dict[str, _Entity] = Field(default_factory=dict)
    measurements: dict[str, _Entity] = Field(default_factory=dict)
    slack_reward: float = -0.01
    success_reward: float = 2.5


class _Dataset(_Part):
    type: str
    split: str = "train"
    data_path: str
    scenes_dir: str = "data/scene_datasets"
    content_scenes: list[str] = _EVERYTHING


class _Habitat(_Part):
    seed: int = 100
    environment: _Environment = _Environment()
    simulator: _Simulator
    task: _Task
    dataset: _Dataset


def plan_of(config: str | RunPlan | Mapping[str, Any]) -> tuple[RunPlan, HabitatTask]:
    """The plan and the task that a configuration means.

    Args:
        config: The name of a data set, which is run with the robot and the limits of its benchmark,
            else those of HM3D; a plan; or a composed configuration of habitat-lab.

    Raises:
        ConfigError: The configuration asks for something that doesn't exist here.
    """
    if isinstance(config, RunPlan):
        return config, HabitatTask()
    if isinstance(config, str):
        benchmark = benchmark_of(config) or BENCHMARKS["hm3d"]
        plan = RunPlan(
            config,
            config=HyPerNavConfig(embodiment=benchmark.embodiment),
            max_steps=benchmark.max_steps,
            success_distance_m=benchmark.success_distance_m,
        )
        return plan, HabitatTask()
    try:
        habitat = _Habitat.model_validate(_plain(config.get("habitat", config)))
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(map(str, first["loc"]))
        raise ConfigError(
            f"habitat.{key}: {first['msg']}; expected a composed configuration of habitat-lab, "
            "such as habitat.get_config returns"
        ) from error
    return _plan(habitat), _task(habitat)


def _plan(habitat: _Habitat) -> RunPlan:
    data, task = habitat.dataset, habitat.task
    _check("type of task or data set", (data.type, task.type), [_TASK])
    _check("measure", (entity.type for entity in task.measurements.values()), _MEASURES)
    measures = {entity.type: entity for entity in task.measurements.values()}
    if "DistanceToGoal" in measures:
        _check("distance_to", [measures["DistanceToGoal"].distance_to], ["VIEW_POINTS"])
    success = measures.get("Success", _Entity(type="Success"))
    order = habitat.environment.iterator_options
    _check("group_by_scene", [str(order.group_by_scene)], ["True"])
    _check("num_episode_sample", [str(order.num_episode_sample)], ["-1"])
    _check("max_scene_repeat_episodes", [str(order.max_scene_repeat_episodes)], ["-1"])
    scenes = None if data.content_scenes == _EVERYTHING else ",".join(data.content_scenes)
    return RunPlan(
        f"habitat:{data.data_path.format(split=data.split)}",
        Selection(scenes=scenes),
        config=_robot(habitat.simulator),
        max_steps=habitat.environment.max_episode_steps,
        success_distance_m=success.success_distance,
        seed=habitat.seed,
        scenes_dir=Path(data.scenes_dir),
    )


def _robot(simulator: _Simulator) -> HyPerNavConfig:
    _check("action_space_config", [simulator.action_space_config], _EXACT_MOTION)
    _check("number of agents", [str(len(simulator.agents))], ["1"])
    [agent] = simulator.agents.values()
    cameras = list(agent.sim_sensors.values())
    _check("camera", (camera.type for camera in cameras), _CAMERAS)
    _check("noise_model", (camera.noise_model for camera in cameras), ["None"])
    _check("sensor_subtype", (camera.sensor_subtype for camera in cameras), ["PINHOLE"])
    if len({camera.view for camera in cameras}) != 1:
        raise ConfigError("habitat: the sensors of a robot share one size, position and view here")
    camera = cameras[0]
    if camera.position[0] or camera.position[2] or any(camera.orientation[1:]):
        raise ConfigError(
            "habitat: a camera here is above the middle of the robot and looks forward, up or "
            f"down; got the position {camera.position} and the orientation {camera.orientation}"
        )
    values = {
        "embodiment.body.radius_m": agent.radius,
        "embodiment.body.height_m": agent.height,
        "embodiment.body.max_step_m": agent.max_climb,
        "embodiment.body.max_slope_deg": agent.max_slope,
        "embodiment.camera.width": camera.width,
        "embodiment.camera.height": camera.height,
        "embodiment.camera.hfov_deg": camera.hfov,
        "embodiment.camera.height_m": camera.position[1],
        "embodiment.camera.pitch_deg": 0.0 - math.degrees(camera.orientation[0]),
        "embodiment.motion.forward_m": simulator.forward_step_size,
        "embodiment.motion.turn_angle_deg": simulator.turn_angle,
        "world.sliding": simulator.habitat_sim_v0.allow_sliding,
    }
    for depth in cameras:
        if _CAMERAS[depth.type] == "depth":
            values["embodiment.camera.min_depth_m"] = depth.min_depth
            values["embodiment.camera.max_depth_m"] = depth.max_depth
    assignments = [f"{key}={value}" for key, value in values.items()]
    return layered(HyPerNavConfig(), environment={}, assignments=assignments)


def _task(habitat: _Habitat) -> HabitatTask:
    task = habitat.task
    _check("sensor", (entity.type for entity in task.lab_sensors.values()), _LAB_SENSORS)
    for entity in task.lab_sensors.values():
        _check("goal_spec", [entity.goal_spec], ["TASK_CATEGORY_ID"])
        _check("dimensionality", [str(entity.dimensionality)], ["2"])
    _check("action", task.actions, HabitatTask().actions)
    _check("reward_measure", [str(task.reward_measure)], ["distance_to_goal_reward", "None"])
    _check("success_measure", [str(task.success_measure)], ["spl", "None"])
    [agent] = habitat.simulator.agents.values()
    tilts = [entity.tilt_angle for name, entity in task.actions.items() if "look" in name]
    _check("second tilt_angle", map(str, tilts), map(str, tilts[:1]))
    depths = [camera for camera in agent.sim_sensors.values() if _CAMERAS[camera.type] == "depth"]
    values = {
        "sensors": [_CAMERAS[camera.type] for camera in agent.sim_sensors.values()],
        "actions": list(task.actions),
        "normalize_depth": all(camera.normalize_depth for camera in depths),
        "tilt_deg": tilts[0] if tilts else HabitatTask().tilt_deg,
        "shuffle": habitat.environment.iterator_options.shuffle,
        "slack_reward": task.slack_reward,
        "success_reward": task.success_reward,
    }
    return layered(
        HabitatTask(), environment={}, assignments=[f"{k}={v}" for k, v in values.items()]
    )


def _check(what: str, found: Iterable[str], known: Iterable[str]) -> None:
    """Refuse what has no counterpart here.

    Raises:
        ConfigError: A name is unknown.
    """
    known = tuple(known)
    for name in found:
        if name not in known:
            raise ConfigError(
                f"habitat: the {what} '{name:.60}' doesn't exist here; there is {', '.join(known)}"
            )


def _plain(node: Any) -> Any:
    """A configuration as plain containers, with its references resolved."""
    if isinstance(node, Mapping):
        return {str(key): _plain(value) for key, value in node.items()}
    if isinstance(node, Sequence) and not isinstance(node, str):
        return [_plain(value) for value in node]
    return node
