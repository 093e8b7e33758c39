"""Object-goal navigation as a Gymnasium environment, ``hypernav/ObjectNav-v0``."""

import copy
import math
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from jaxtyping import UInt8
from pydantic import Field

from hypernav.app.build.our_worlds import in_our_own
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.app.build.worlds import open_world
from hypernav.core.config import MOST_STEPS, RoomConfig
from hypernav.core.embodiment import Action, Embodiment
from hypernav.core.episode import SUCCESS_DISTANCE_M, Episode
from hypernav.core.errors import GoalError, WorldError
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.world import Simulator
from hypernav.io.layered_config import with_values
from hypernav.lab.episodes.trial import Trial
from hypernav.simulator.worlds.config import SimulationConfig
from hypernav.simulator.worlds.scenes.scene import Scene

_OPTIONS = ("goal", "start")
_LONGEST_GOAL = 200
_FARTHEST_M = 10_000.0
_CHARACTERS = "".join(chr(code) for code in range(32, 0x10000) if chr(code).isprintable())


class ObjectNavConfig(RoomConfig):
    """The task of the environment.

    Attributes:
        embodiment: Body, camera and motion of the robot.
        simulation: How the robot is simulated.
        max_steps: Number of actions after which an episode is truncated.
        success_distance_m: Greatest geodesic distance to a view point at which STOP is a success.
        nearest_start_m: Smallest geodesic distance of a random start to the goal.
        farthest_start_m: Greatest geodesic distance of a random start to the goal.
    """

    embodiment: Embodiment = Embodiment()
    simulation: SimulationConfig = SimulationConfig()
    max_steps: int = Field(default=500, ge=1, le=MOST_STEPS)
    success_distance_m: float = Field(default=SUCCESS_DISTANCE_M, gt=0.0, le=100.0)
    nearest_start_m: float = Field(default=2.0, ge=0.0, le=1000.0)
    farthest_start_m: float = Field(default=30.0, gt=0.0, le=1000.0)


class ObjectNavEnv(gymnasium.Env[dict[str, Any], Any]):
    """Find an object in a scene.

    An observation holds ``rgb`` (unless it is made without colours), ``depth`` (metres, 0 where
    there is no return), ``pose`` (x, y in metres and yaw in radians, as odometry reports it, in the
    ``map`` frame that starts at the start pose) and ``goal`` (text). Actions have Habitat's
    numbers, see `hypernav.core.embodiment.Action`.

    STOP terminates the episode; the step limit truncates it. The reward is 1 for a STOP at the
    goal and 0 otherwise. ``info`` holds the measures of
    `hypernav.core.episode.EpisodeMetrics`, ``steps`` and ``collided``.

    `reset` takes the options ``goal`` (text) and ``start`` (``(x, y, yaw)`` in the scene frame).
    Without them the goal is the constructor's, else drawn from the categories with view points, and
    the start is drawn from the positions from which the goal can be reached.
    """

    # Gymnasium declares it as an attribute of instances.
    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 10}  # noqa: RUF012

    def __init__(
        self,
        scene: Scene | Simulator | str | Path,
        goal: str | None = None,
        *,
        config: ObjectNavConfig | None = None,
        size: tuple[int, int] | None = None,
        colours: bool = True,
        render_mode: str | None = None,
    ) -> None:
        """Open a scene.

        Args:
            scene: A scene, its name or file, or an existing world with its own configuration.
            goal: The object to find in every episode; None draws a goal at each reset.
            config: The task of the environment.
            size: Columns and rows of the images, pixels; None takes those of ``config``.
            colours: Whether observations have ``rgb``; drawing colours is most of a step's work.
            render_mode: "rgb_array", which needs colours, or None.

        Raises:
            ConfigError: Images of this size are impossible.
            SceneError: The file is not a scene, or the robot fits nowhere.
            WorldError: The render mode doesn't exist or has no colours to show, or a size is given
                for a world that has its own camera.
        """
        if render_mode not in (None, "rgb_array"):
            raise WorldError(f"render_mode must be 'rgb_array' or None, got {render_mode!r}")
        if render_mode is not None and not colours:
            raise WorldError("render_mode 'rgb_array' shows colours; leave colours=False out")
        if size is not None and isinstance(scene, Simulator):
            raise WorldError("size is for scenes; this world has its own camera, leave size out")
        self.config: ObjectNavConfig = _sized(config or ObjectNavConfig(), size)
        self._owns_world = not isinstance(scene, Simulator)
        robot = {"world": self.config.simulation, "embodiment": self.config.embodiment}
        simulated = HyPerNavConfig().model_copy(update=robot)
        if isinstance(scene, Simulator):
            self.world: Simulator = scene
        elif isinstance(scene, Scene):
            self.world = in_our_own(scene, simulated)
        else:
            self.world = open_world(str(scene), simulated)
        self.world.colours = colours
        self.render_mode = render_mode
        self._fixed_goal = None if goal is None else _checked_goal(goal)
        camera = self.world.embodiment.camera
        shape = (camera.height, camera.width)
        turn = np.array([_FARTHEST_M, _FARTHEST_M, math.pi])
        parts: dict[str, gymnasium.Space[Any]] = {
            "rgb": spaces.Box(0, 255, (*shape, 3), np.uint8),
            "depth": spaces.Box(0.0, camera.max_depth_m, shape, np.float32),
            "pose": spaces.Box(-turn, turn, (3,), np.float64),
            "goal": spaces.Text(_LONGEST_GOAL, charset=_CHARACTERS),
        }
        self._parts = [name for name in parts if colours or name != "rgb"]
        self.observation_space: gymnasium.Space[dict[str, Any]] = spaces.Dict(
            {name: parts[name] for name in self._parts}
        )
        self.action_space: gymnasium.Space[Any] = spaces.Discrete(len(Action))
        self._trial: Trial | None = None

    @property
    def observation(self) -> Observation:
        """The latest observation with its camera and labels.

        Raises:
            WorldError: Before the first `reset`.
        """
        return self.trial.observation

    @property
    def trial(self) -> Trial:
        """The state of the present episode: its steps, its ending and its measures.

        Raises:
            WorldError: Before the first `reset`.
        """
        if self._trial is None:
            raise WorldError("no episode before reset: call reset first")
        return self._trial

    @property
    def goal(self) -> Goal:
        """The object to find in the present episode.

        Raises:
            WorldError: Before the first `reset`.
        """
        return self.trial.episode.goal

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Begin an episode.

        Args:
            seed: Seed of everything that is drawn in this and the following episodes.
            options: The options ``goal`` and ``start``, see the class.

        Raises:
            GoalError: The goal is empty or too long, or none was given and the scene has none.
            StartError: The robot can't stand at the start.
            WorldError: An option doesn't exist or is malformed.
        """
        super().reset(seed=seed)
        options = options or {}
        if unknown := sorted(set(options) - set(_OPTIONS)):
            raise WorldError(f"unknown reset option {unknown[0]!r}; there are {_OPTIONS}")
        goal = self._choose_goal(options)
        start = self._given_start(options) or self.world.truth.random_start(
            self.np_random,
            goal,
            nearest_m=self.config.nearest_start_m,
            farthest_m=self.config.farthest_start_m,
        )
        episode = Episode(
            scene_id=self.world.truth.name,
            episode_id="",
            goal=goal,
            start=start,
            max_steps=self.config.max_steps,
            success_distance_m=self.config.success_distance_m,
        )
        self._trial = Trial(self.world, episode, self.np_random)
        return self._observed(), self._info()

    def step(self, action: Any) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        """Take an action and observe.

        Raises:
            WorldError: The action doesn't exist, or the episode is over or has not begun.
        """
        if self._trial is None or self._trial.is_over:
            raise WorldError("step without a running episode: call reset first")
        if not self.action_space.contains(action):
            raise WorldError(f"an action is one of 0, 1, 2, 3, got {action!r}")
        self._trial.take(Action(int(action)))
        terminated = self._trial.ending is not None
        truncated = self._trial.is_over and not terminated
        info = self._info()
        return self._observed(), float(info["success"]), terminated, truncated, info

    def render(self) -> UInt8[np.ndarray, "height width 3"] | None:  # pyright: ignore[reportIncompatibleMethodOverride]
        """The camera image if the render mode is "rgb_array", else None."""
        return self.observation.rgb if self.render_mode == "rgb_array" else None

    def close(self) -> None:
        """Close the world, unless the caller passed it in."""
        if self._owns_world:
            self.world.close()

    def _choose_goal(self, options: Mapping[str, Any]) -> Goal:
        if options.get("goal") is not None:
            return _checked_goal(options["goal"])
        if self._fixed_goal is not None:
            return self._fixed_goal
        categories = self.world.truth.goals()
        if not categories:
            raise GoalError(
                f"scene '{self.world.truth.name}' has no labelled object that can be reached; "
                "name a goal: options={'goal': ...}"
            )
        return Goal(categories[int(self.np_random.integers(len(categories)))])

    def _given_start(self, options: Mapping[str, Any]) -> Pose2 | None:
        start = options.get("start")
        if start is None or isinstance(start, Pose2):
            return start
        numbers = np.asarray(start, dtype=np.float64)
        if numbers.shape != (3,) or not np.isfinite(numbers).all():
            raise WorldError(f"the option 'start' is (x, y, yaw), got {start!r}")
        return Pose2(float(numbers[0]), float(numbers[1]), float(numbers[2]))

    def _observed(self) -> dict[str, Any]:
        seen = self.observation
        parts = {
            "rgb": seen.rgb,
            "depth": seen.depth,
            "pose": np.array([seen.robot.x, seen.robot.y, seen.robot.yaw]),
            "goal": self.goal.text,
        }
        # Copies: the caller may change what it gets, and STOP shows the last image again.
        return {name: copy.copy(parts[name]) for name in self._parts}

    def _info(self) -> dict[str, Any]:
        metrics = asdict(self.trial.measure())
        return {**metrics, "steps": self.trial.steps, "collided": self.world.collided}


def _sized(config: ObjectNavConfig, size: tuple[int, int] | None) -> ObjectNavConfig:
    """The task with images of so many columns and rows."""
    if size is None:
        return config
    width, height = size
    camera = {"camera": {"width": width, "height": height}}
    return with_values(config, {"embodiment": camera}, source="size")


def _checked_goal(text: str) -> Goal:
    """A goal whose text fits the observation space."""
    if len(text) > _LONGEST_GOAL or any(character not in _CHARACTERS for character in text):
        raise GoalError(
            f"a goal here is a line of at most {_LONGEST_GOAL} printable characters, got {text!r}"
        )
    return Goal(text)
