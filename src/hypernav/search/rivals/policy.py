"""Agents that a trained policy drives: PIRLNav and ZSON, with weights that the user provides."""

import math
import zlib
from abc import ABC, abstractmethod
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float32, UInt8

from hypernav.core.embodiment import Action, CameraConfig, Embodiment
from hypernav.core.errors import ConfigError, GoalError
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import same_name
from hypernav.core.observation import Observation
from hypernav.search.models.policy_network import (
    PIRLNAV,
    ZSON,
    PolicyArchitecture,
    PolicyNetwork,
    read_vectors,
)
from hypernav.search.rivals.config import PolicyConfig

Camera = Mapping[str, float]
"""Values of a `CameraConfig` that a policy depends on."""
HM3D_CAMERA: Camera = {
    "width": 640,
    "height": 480,
    "hfov_deg": 79.0,
    "height_m": 0.88,
    "pitch_deg": 0.0,
}
SQUARE_CAMERA: Camera = {
    "width": 128,
    "height": 128,
    "hfov_deg": 90.0,
    "height_m": 1.25,
    "pitch_deg": 0.0,
}
_MOTION = {"forward_m": 0.25, "turn_angle_deg": 30.0}


def check_robot(name: str, embodiment: Embodiment, cameras: tuple[Camera, ...]) -> None:
    """Refuse a robot that a policy was not trained on, and say what differs.

    Raises:
        ConfigError: Its camera, step or turn differs from those of the training.
    """
    motion = embodiment.motion.model_dump()
    wrong = [
        f"embodiment.motion.{key} is {motion[key]:g} instead of {value:g}"
        for key, value in _MOTION.items()
        if motion[key] != value
    ]
    wrong += min((_differences(embodiment.camera, camera) for camera in cameras), key=len)
    if wrong:
        raise ConfigError(
            f"{name} was trained on one robot, and any other breaks it: {', '.join(wrong)}; set "
            "them so with --set"
        )


def _differences(camera: CameraConfig, trained: Camera) -> list[str]:
    values = camera.model_dump()
    return [
        f"embodiment.camera.{key} is {values[key]:g} instead of {value:g}"
        for key, value in trained.items()
        if values[key] != value
    ]


_PIRLNAV_GOALS = ("chair", "bed", "potted plant", "toilet", "tv", "sofa")
"""Goals in the order of their numbers."""


@runtime_checkable
class RecurrentPolicy(Protocol):
    """Scores actions; what it remembers is a state that it returns with every step."""

    @property
    def architecture(self) -> PolicyArchitecture:
        """Dimensions of the policy."""
        ...

    def first_state(self) -> Any:
        """The state before the first step of a search."""
        ...

    def step(
        self,
        rgb: UInt8[np.ndarray, "height width 3"],
        state: Any,
        *,
        last_action: int,
        goal: int | Float32[np.ndarray, "n"],
        pose: tuple[float, float, float] | None = None,
    ) -> tuple[Float32[np.ndarray, "actions"], Any]:
        """Logits of the actions, and the next state; see `PolicyNetwork.step`."""
        ...


class PolicyAgent(ABC):
    """Lets a recurrent policy choose every action; it has neither map nor plan."""

    def __init__(
        self,
        network: RecurrentPolicy,
        embodiment: Embodiment,
        cameras: tuple[Camera, ...],
        config: PolicyConfig,
    ) -> None:
        """Refuse a robot that the policy was not trained on.

        Args:
            network: The policy.
            embodiment: What the robot is.
            cameras: Cameras that the policy was trained with.
            config: Choice of an action.

        Raises:
            ConfigError: The robot's camera, step or turn differs from those of the training.
        """
        check_robot(network.architecture.name, embodiment, cameras)
        self._network = network
        self._embodiment = embodiment
        self._config = config
        self._state: Any = None

    @property
    def embodiment(self) -> Embodiment:
        """The robot that the agent was built for."""
        return self._embodiment

    def reset(self, goal: Goal) -> None:
        """Forget everything and begin a new search.

        Raises:
            GoalError: The policy doesn't know the goal.
        """
        self._goal = self.goal_input(goal)
        self._state = self._network.first_state()
        self._last_action = 0
        self._start: Pose2 | None = None
        self._rng = np.random.default_rng([self._config.seed, zlib.crc32(goal.text.encode())])

    def check_goal(self, goal: Goal) -> None:
        """Refuse a goal that the policy doesn't know.

        Raises:
            GoalError: It doesn't.
        """
        self.goal_input(goal)

    @abstractmethod
    def goal_input(self, goal: Goal) -> int | Float32[np.ndarray, "n"]:
        """The goal as the policy reads it: a number, or a vector.

        Raises:
            GoalError: The policy doesn't know the goal.
        """

    def act(self, observation: Observation) -> Action:
        """The action that the policy chooses; looking up and down are masked."""
        pose = None
        if self._network.architecture.has_pose:
            self._start = self._start or observation.robot
            pose = pose_input(observation.robot, self._start)
        logits, self._state = self._network.step(
            observation.rgb,
            self._state,
            last_action=self._last_action,
            goal=self._goal,
            pose=pose,
        )
        action = self._chosen(logits[: len(Action)].astype(np.float64))
        self._last_action = int(action) + 1
        return action

    def _chosen(self, logits: np.ndarray) -> Action:
        if self._config.choice == "mode":
            return Action(int(logits.argmax()))
        chances = np.exp(logits - logits.max())
        return Action(int(self._rng.choice(len(chances), p=chances / chances.sum())))


class PirlnavAgent(PolicyAgent):
    """PIRLNav's policy, for its six goals.

    Source: Ramrakhya et al., "PIRLNav: Pretraining with Imitation and RL Finetuning for
    ObjectNav", 2023. Ours: looking up and down is masked; images are not shifted and recoloured at
    random, as its configuration does even in evaluation.
    """

    def __init__(
        self, path: str, embodiment: Embodiment, config: PolicyConfig | None = None
    ) -> None:
        """Load a checkpoint.

        Args:
            path: Converted checkpoint, safetensors.
            embodiment: What the robot is.
            config: Choice of an action.

        Raises:
            ConfigError: The robot is not the one of its training.
            MissingExtraError: torch or safetensors is not installed.
            ModelError: The file can't be used.
        """
        check_robot(PIRLNAV.name, embodiment, (HM3D_CAMERA,))
        network = PolicyNetwork.load(Path(path), PIRLNAV)
        super().__init__(network, embodiment, (HM3D_CAMERA,), config or PolicyConfig())

    def goal_input(self, goal: Goal) -> int:
        """The number of a goal.

        Raises:
            GoalError: It has none.
        """
        for number, name in enumerate(_PIRLNAV_GOALS):
            if same_name(goal.text, name):
                return number
        raise GoalError(
            f"PIRLNav was trained for {', '.join(_PIRLNAV_GOALS)} alone, and the goal is "
            f"'{goal.text}'"
        )


class ZsonAgent(PolicyAgent):
    """ZSON's policy, for any goal that there is a vector for.

    Source: Majumdar et al., "ZSON: Zero-Shot Object-Goal Navigation using Multimodal Goal
    Embeddings", 2022.
    """

    def __init__(
        self, path: str, embodiment: Embodiment, config: PolicyConfig | None = None
    ) -> None:
        """Load a checkpoint and the goals' vectors.

        Args:
            path: Converted checkpoint, safetensors.
            embodiment: What the robot is.
            config: Choice of an action; file of the goals' vectors.

        Raises:
            ConfigError: The robot differs from that of the training, or no vectors are named.
            MissingExtraError: torch or safetensors is not installed.
            ModelError: A file can't be used.
        """
        config = config or PolicyConfig()
        cameras = (HM3D_CAMERA, SQUARE_CAMERA)
        check_robot(ZSON.name, embodiment, cameras)
        network = PolicyNetwork.load(Path(path), ZSON)
        super().__init__(network, embodiment, cameras, config)
        self._vectors = read_vectors(config.goals, ZSON.goal_size)

    def goal_input(self, goal: Goal) -> Float32[np.ndarray, "n"]:
        """The vector of a goal.

        Raises:
            GoalError: The file holds none.
        """
        for name, vector in self._vectors.items():
            if same_name(goal.text, name):
                return vector
        raise GoalError(
            f"{self._config.goals} holds no vector for '{goal.text}'; it has "
            f"{', '.join(self._vectors)}"
        )


def pose_input(robot: Pose2, start: Pose2) -> tuple[float, float, float]:
    """Habitat's GPS and compass: metres ahead and to the right of the start, heading in radians.

    Args:
        robot: Pose of the robot, ``map`` frame.
        start: Pose at the start of the search, same frame.
    """
    away_x, away_y = robot.x - start.x, robot.y - start.y
    ahead = math.cos(start.yaw) * away_x + math.sin(start.yaw) * away_y
    left = math.cos(start.yaw) * away_y - math.sin(start.yaw) * away_x
    return ahead, -left, math.remainder(robot.yaw - start.yaw, math.tau)
