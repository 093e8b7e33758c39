"""Zero-shot object-goal navigation with hybrid perception: camera image and top-down map.

Nearly all that a user needs comes from this namespace. A name is loaded when it is asked for, so
that ``import hypernav`` stays light.
"""

import importlib
import logging
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hypernav.app.build.agents import build_agent, build_search
    from hypernav.app.build.built_agent import BuiltAgent
    from hypernav.app.build.components.component_specs import ComponentSpecs
    from hypernav.app.build.data.scenes import load_scene
    from hypernav.app.build.env import ObjectNavEnv
    from hypernav.app.build.memories.building_memory import BuildingMemory, open_memory
    from hypernav.app.build.native import native_config
    from hypernav.app.build.presets import HyPerNavConfig, preset
    from hypernav.app.build.search import find
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
    from hypernav.core.exploring.exploration import (
        Destination,
        ExplorationView,
        StairsDestination,
    )
    from hypernav.core.exploring.overview import BlockChoice, Overview
    from hypernav.core.geometry.boxes import Box, Detection
    from hypernav.core.geometry.camera import PinholeCamera
    from hypernav.core.geometry.grid import OccupancyGrid
    from hypernav.core.geometry.transforms import Pose2, Transform
    from hypernav.core.goal import Goal
    from hypernav.core.observation import Observation
    from hypernav.core.trace import StepTrace
    from hypernav.core.world import RenderedView, Renderer
    from hypernav.lab.episodes.episode_run import EpisodeResult, EpisodeRun, EpisodeStep
    from hypernav.lab.episodes.search_record import SearchRecord
    from hypernav.lab.evaluation.checks.contracts import check_agent, check_world
    from hypernav.lab.evaluation.evaluate import evaluate
    from hypernav.lab.evaluation.habitat_lab.benchmark import HabitatBenchmark
    from hypernav.lab.evaluation.habitat_lab.env import HabitatEnv
    from hypernav.lab.evaluation.habitat_lab.gym_env import HabitatGymEnv
    from hypernav.lab.evaluation.habitat_lab.task import HabitatTask
    from hypernav.lab.evaluation.record import EpisodeRecord
    from hypernav.lab.evaluation.report.report_page import write_report
    from hypernav.lab.evaluation.report.run_data import Runs, load_runs
    from hypernav.lab.evaluation.run_plan import RunPlan, Selection
    from hypernav.robot.client.links import HttpLink, HttpServer, ServerAddress
    from hypernav.robot.client.robot import Executed, Robot, Sensed
    from hypernav.robot.client.robot_client import RobotClient, StopListener
    from hypernav.robot.driving.base import Base, DepthView, Velocity
    from hypernav.robot.driving.driven_robot import DrivenRobot
    from hypernav.robot.wire.requests import OpenSearch
    from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
    from hypernav.simulator.worlds.box_room import BoxRoom
    from hypernav.simulator.worlds.scenes.scene import Scene
    from hypernav.simulator.worlds.simulation import SimulatedWorld
    from hypernav.simulator.worlds.surface.goal_regions import random_start

__all__ = [
    "Action",
    "Agent",
    "Base",
    "BlockChoice",
    "BlockReasoner",
    "Box",
    "BoxRoom",
    "BuildingMemory",
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
    "Overview",
    "PinholeCamera",
    "Pose2",
    "PresenceCheck",
    "RenderedView",
    "Renderer",
    "Robot",
    "RobotClient",
    "RoomConfig",
    "RunPlan",
    "Runs",
    "Scene",
    "SceneError",
    "SearchRecord",
    "Segmenter",
    "Selection",
    "Sensed",
    "SensorError",
    "ServerAddress",
    "SimulatedWorld",
    "StairsDestination",
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
    "BuildingMemory": "hypernav.app.build.memories.building_memory",
    "BuiltAgent": "hypernav.app.build.built_agent",
    "build_agent": "hypernav.app.build.agents",
    "build_search": "hypernav.app.build.agents",
    "ComponentSpecs": "hypernav.app.build.components.component_specs",
    "open_memory": "hypernav.app.build.memories.building_memory",
    "native_config": "hypernav.app.build.native",
    "HyPerNavConfig": "hypernav.app.build.presets",
    "preset": "hypernav.app.build.presets",
    "load_scene": "hypernav.app.build.data.scenes",
    "find": "hypernav.app.build.search",
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
    "StairsDestination": "hypernav.core.exploring.exploration",
    "BlockChoice": "hypernav.core.exploring.overview",
    "Overview": "hypernav.core.exploring.overview",
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
    "RenderedView": "hypernav.core.world",
    "Renderer": "hypernav.core.world",
    "check_agent": "hypernav.lab.evaluation.checks.contracts",
    "BoxRoom": "hypernav.simulator.worlds.box_room",
    "check_world": "hypernav.lab.evaluation.checks.contracts",
    "evaluate": "hypernav.lab.evaluation.evaluate",
    "HabitatBenchmark": "hypernav.lab.evaluation.habitat_lab.benchmark",
    "HabitatEnv": "hypernav.lab.evaluation.habitat_lab.env",
    "HabitatGymEnv": "hypernav.lab.evaluation.habitat_lab.gym_env",
    "HabitatTask": "hypernav.lab.evaluation.habitat_lab.task",
    "EpisodeRecord": "hypernav.lab.evaluation.record",
    "write_report": "hypernav.lab.evaluation.report.report_page",
    "Runs": "hypernav.lab.evaluation.report.run_data",
    "load_runs": "hypernav.lab.evaluation.report.run_data",
    "RunPlan": "hypernav.lab.evaluation.run_plan",
    "Selection": "hypernav.lab.evaluation.run_plan",
    "GroundTruthDetector": "hypernav.search.perception.local.stand_ins.ground_truth",
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
    "ObjectNavEnv": "hypernav.app.build.env",
    "EpisodeResult": "hypernav.lab.episodes.episode_run",
    "EpisodeRun": "hypernav.lab.episodes.episode_run",
    "EpisodeStep": "hypernav.lab.episodes.episode_run",
    "SearchRecord": "hypernav.lab.episodes.search_record",
    "Scene": "hypernav.simulator.worlds.scenes.scene",
    "SimulatedWorld": "hypernav.simulator.worlds.simulation",
    "random_start": "hypernav.simulator.worlds.surface.goal_regions",
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
