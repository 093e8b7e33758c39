"""Zero-shot object-goal navigation with hybrid perception: camera image and top-down map.

All that a user needs comes from this namespace. A name is loaded when it is asked for, so that
``import hypernav`` stays light.
"""

import importlib
import logging
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hypernav.build.agents import build_agent, build_search
    from hypernav.build.built_agent import BuiltAgent
    from hypernav.build.component_specs import ComponentSpecs
    from hypernav.build.data.scenes import load_scene
    from hypernav.build.env import ObjectNavEnv
    from hypernav.build.memories import open_memory
    from hypernav.build.native import native_config
    from hypernav.build.presets import HyPerNavConfig, preset
    from hypernav.build.search import find
    from hypernav.core.components.protocols import (
        Agent,
        BlockReasoner,
        ChatModel,
        Detector,
        Explorer,
        PresenceCheck,
        Segmenter,
    )
    from hypernav.core.config import RoomConfig
    from hypernav.core.embodiment import Action, Embodiment
    from hypernav.core.episode import Episode, Outcome
    from hypernav.core.errors import (
        ComponentError,
        ConfigError,
        ContractError,
        GoalError,
        HyPerNavError,
        LabelsMissingError,
        LinkLostError,
        MissingExtraError,
        ModelError,
        ModelUnavailableError,
        SceneError,
        SensorError,
        StartError,
    )
    from hypernav.core.exploring.exploration import Destination, ExplorationView
    from hypernav.core.geometry.boxes import Box, Detection
    from hypernav.core.geometry.camera import PinholeCamera
    from hypernav.core.geometry.grid import OccupancyGrid
    from hypernav.core.geometry.transforms import Pose2, Transform
    from hypernav.core.goal import Goal
    from hypernav.core.observation import Observation
    from hypernav.core.trace import StepTrace
    from hypernav.episodes.episode_run import EpisodeResult, EpisodeRun, EpisodeStep
    from hypernav.evaluation.checks.contracts import check_agent, check_world
    from hypernav.evaluation.evaluate import evaluate
    from hypernav.evaluation.habitat_lab.benchmark import HabitatBenchmark
    from hypernav.evaluation.habitat_lab.env import HabitatEnv
    from hypernav.evaluation.habitat_lab.gym_env import HabitatGymEnv
    from hypernav.evaluation.habitat_lab.task import HabitatTask
    from hypernav.evaluation.record import EpisodeRecord
    from hypernav.evaluation.report.report_page import write_report
    from hypernav.evaluation.report.run_data import load_runs
    from hypernav.evaluation.run_plan import RunPlan, Selection
    from hypernav.perception.local.ground_truth import GroundTruthDetector
    from hypernav.robot.client.links import HttpLink, HttpServer, ServerAddress
    from hypernav.robot.client.robot import Executed, Robot, Sensed
    from hypernav.robot.client.robot_client import RobotClient, StopListener
    from hypernav.robot.driving.base import Base, DepthView, Velocity
    from hypernav.robot.driving.driven_robot import DrivenRobot
    from hypernav.robot.wire.requests import OpenSearch
    from hypernav.worlds.box_room import BoxRoom
    from hypernav.worlds.scenes.scene import Scene
    from hypernav.worlds.simulation import SimulatedWorld
    from hypernav.worlds.surface.goal_regions import random_start

__all__ = [
    "Action",
    "Agent",
    "Base",
    "BlockReasoner",
    "Box",
    "BoxRoom",
    "BuiltAgent",
    "ChatModel",
    "ComponentError",
    "ComponentSpecs",
    "ConfigError",
    "ContractError",
    "DepthView",
    "Destination",
    "Detection",
    "Detector",
    "DrivenRobot",
    "Embodiment",
    "Episode",
    "EpisodeRecord",
    "EpisodeResult",
    "EpisodeRun",
    "EpisodeStep",
    "Executed",
    "ExplorationView",
    "Explorer",
    "Goal",
    "GoalError",
    "GroundTruthDetector",
    "HabitatBenchmark",
    "HabitatEnv",
    "HabitatGymEnv",
    "HabitatTask",
    "HttpLink",
    "HttpServer",
    "HyPerNavConfig",
    "HyPerNavError",
    "LabelsMissingError",
    "LinkLostError",
    "MissingExtraError",
    "ModelError",
    "ModelUnavailableError",
    "ObjectNavEnv",
    "Observation",
    "OccupancyGrid",
    "OpenSearch",
    "Outcome",
    "PinholeCamera",
    "Pose2",
    "PresenceCheck",
    "Robot",
    "RobotClient",
    "RoomConfig",
    "RunPlan",
    "Scene",
    "SceneError",
    "Segmenter",
    "Selection",
    "Sensed",
    "SensorError",
    "ServerAddress",
    "SimulatedWorld",
    "StartError",
    "StepTrace",
    "StopListener",
    "Transform",
    "Velocity",
    "build_agent",
    "build_search",
    "check_agent",
    "check_world",
    "evaluate",
    "find",
    "load_runs",
    "load_scene",
    "native_config",
    "open_memory",
    "preset",
    "random_start",
    "write_report",
]

_MODULES = {
    "BuiltAgent": "hypernav.build.built_agent",
    "build_agent": "hypernav.build.agents",
    "build_search": "hypernav.build.agents",
    "ComponentSpecs": "hypernav.build.component_specs",
    "open_memory": "hypernav.build.memories",
    "native_config": "hypernav.build.native",
    "HyPerNavConfig": "hypernav.build.presets",
    "preset": "hypernav.build.presets",
    "load_scene": "hypernav.build.data.scenes",
    "find": "hypernav.build.search",
    "Action": "hypernav.core.embodiment",
    "Agent": "hypernav.core.components.protocols",
    "BlockReasoner": "hypernav.core.components.protocols",
    "ChatModel": "hypernav.core.components.protocols",
    "Detector": "hypernav.core.components.protocols",
    "Explorer": "hypernav.core.components.protocols",
    "PresenceCheck": "hypernav.core.components.protocols",
    "Segmenter": "hypernav.core.components.protocols",
    "RoomConfig": "hypernav.core.config",
    "Destination": "hypernav.core.exploring.exploration",
    "ExplorationView": "hypernav.core.exploring.exploration",
    "Embodiment": "hypernav.core.embodiment",
    "Episode": "hypernav.core.episode",
    "Outcome": "hypernav.core.episode",
    "ComponentError": "hypernav.core.errors",
    "ConfigError": "hypernav.core.errors",
    "ContractError": "hypernav.core.errors",
    "GoalError": "hypernav.core.errors",
    "HyPerNavError": "hypernav.core.errors",
    "LabelsMissingError": "hypernav.core.errors",
    "LinkLostError": "hypernav.core.errors",
    "MissingExtraError": "hypernav.core.errors",
    "ModelError": "hypernav.core.errors",
    "ModelUnavailableError": "hypernav.core.errors",
    "SceneError": "hypernav.core.errors",
    "SensorError": "hypernav.core.errors",
    "StartError": "hypernav.core.errors",
    "Box": "hypernav.core.geometry.boxes",
    "Detection": "hypernav.core.geometry.boxes",
    "PinholeCamera": "hypernav.core.geometry.camera",
    "OccupancyGrid": "hypernav.core.geometry.grid",
    "Pose2": "hypernav.core.geometry.transforms",
    "Transform": "hypernav.core.geometry.transforms",
    "Goal": "hypernav.core.goal",
    "Observation": "hypernav.core.observation",
    "StepTrace": "hypernav.core.trace",
    "check_agent": "hypernav.evaluation.checks.contracts",
    "BoxRoom": "hypernav.worlds.box_room",
    "check_world": "hypernav.evaluation.checks.contracts",
    "evaluate": "hypernav.evaluation.evaluate",
    "HabitatBenchmark": "hypernav.evaluation.habitat_lab.benchmark",
    "HabitatEnv": "hypernav.evaluation.habitat_lab.env",
    "HabitatGymEnv": "hypernav.evaluation.habitat_lab.gym_env",
    "HabitatTask": "hypernav.evaluation.habitat_lab.task",
    "EpisodeRecord": "hypernav.evaluation.record",
    "write_report": "hypernav.evaluation.report.report_page",
    "load_runs": "hypernav.evaluation.report.run_data",
    "RunPlan": "hypernav.evaluation.run_plan",
    "Selection": "hypernav.evaluation.run_plan",
    "GroundTruthDetector": "hypernav.perception.local.ground_truth",
    "HttpLink": "hypernav.robot.client.links",
    "HttpServer": "hypernav.robot.client.links",
    "ServerAddress": "hypernav.robot.client.links",
    "Executed": "hypernav.robot.client.robot",
    "Robot": "hypernav.robot.client.robot",
    "Sensed": "hypernav.robot.client.robot",
    "RobotClient": "hypernav.robot.client.robot_client",
    "StopListener": "hypernav.robot.client.robot_client",
    "Base": "hypernav.robot.driving.base",
    "DepthView": "hypernav.robot.driving.base",
    "DrivenRobot": "hypernav.robot.driving.driven_robot",
    "Velocity": "hypernav.robot.driving.base",
    "OpenSearch": "hypernav.robot.wire.requests",
    "ObjectNavEnv": "hypernav.build.env",
    "EpisodeResult": "hypernav.episodes.episode_run",
    "EpisodeRun": "hypernav.episodes.episode_run",
    "EpisodeStep": "hypernav.episodes.episode_run",
    "Scene": "hypernav.worlds.scenes.scene",
    "SimulatedWorld": "hypernav.worlds.simulation",
    "random_start": "hypernav.worlds.surface.goal_regions",
}

logging.getLogger("hypernav").addHandler(logging.NullHandler())
importlib.import_module("hypernav.io.cache_folder").choose_kernel_folder()


def __getattr__(name: str) -> Any:
    """Load a public name when it is asked for."""
    if name in _MODULES:
        loaded = getattr(importlib.import_module(_MODULES[name]), name)
        globals()[name] = loaded
        return loaded
    raise AttributeError(f"module 'hypernav' has no attribute '{name}'")


def __dir__() -> list[str]:
    """The public names, for completion in a shell or notebook."""
    return sorted({*globals(), *__all__})
