"""ObjectNav with the interface of habitat-lab's ``habitat.Env``.

Source: habitat-lab, ``habitat/core/env.py`` and ``habitat/config/habitat/task/objectnav.yaml``.
"""

import math
import random
from collections.abc import Iterable, Iterator, Mapping
from itertools import chain
from typing import Any

import numpy as np
from gymnasium import spaces
from jaxtyping import UInt8

from hypernav.app.build.worlds import open_world
from hypernav.core.embodiment import Action
from hypernav.core.episode import Episode
from hypernav.core.errors import EpisodeError, WorldError
from hypernav.core.observation import Observation
from hypernav.core.world import Simulator, TiltsCamera
from hypernav.lab.episodes.referee import Referee
from hypernav.lab.evaluation.habitat_lab.configuration import plan_of
from hypernav.lab.evaluation.habitat_lab.sensors import observed, semantic_ids_of, sensor_spaces
from hypernav.lab.evaluation.habitat_lab.task import HabitatTask
from hypernav.lab.evaluation.run_plan import RunPlan


def passes(episodes: Iterable[Episode], *, shuffle: bool, seed: int) -> Iterator[list[Episode]]:
    """The orders of endless passes through all episodes; those of a scene stay together.

    Source: habitat-lab, ``habitat/core/dataset.py`` (``EpisodeIterator``).

    Args:
        episodes: The episodes in the data set's order.
        shuffle: Whether each pass has an order of its own.
        seed: Seed of these orders.
    """
    # habitat-lab shuffles with Python's generator too, so the same seed gives the same order.
    rng = random.Random(seed)
    order = list(episodes)
    while True:
        if shuffle:
            rng.shuffle(order)
        scenes: dict[str, list[Episode]] = {}
        for episode in order:
            scenes.setdefault(episode.scene_id, []).append(episode)
        order = [episode for group in scenes.values() for episode in group]
        yield list(order)


def category_of(episode: Episode) -> str:
    """The category that an episode asks for."""
    return episode.object_category or episode.goal.text


def category_numbers(episodes: Iterable[Episode]) -> dict[str, int]:
    """The data set's numbers of categories; without any, their numbers in alphabetical order.

    Args:
        episodes: All episodes of the environment.
    """
    episodes = list(episodes)
    asked = {category_of(episode) for episode in episodes}
    numbers = {name: n for episode in episodes for name, n in episode.category_ids.items()}
    if asked <= set(numbers):
        return numbers
    return {name: number for number, name in enumerate(sorted(asked))}


class HabitatEnv:
    """A data set's episodes with observations, actions and measures of habitat-lab's ObjectNav.

    Replaces ``habitat.Env``. An observation is a dictionary of ``rgb`` (uint8), ``depth``
    (float32, height × width × 1, 0 to 1 from the nearest to the farthest depth of the sensor),
    ``semantic`` (int32, where it is asked for), ``objectgoal`` (int64, number of the category),
    ``gps`` (float32, metres forward and to the right of the start) and ``compass`` (float32,
    radians, counter-clockwise from the start). GPS and compass are what odometry reports, so
    without noise the true pose.

    Attributes:
        number_of_episodes: Number of all episodes.
        observation_space: Space of the observations.
        action_space: Numbers of the actions, in the order of `HabitatTask.actions`.
        episode_over: Whether the agent stopped, or the steps ran out.
        is_stop_called: Whether the agent stopped.
        task: Sensors, actions and rewards.
    """

    def __init__(
        self, config: str | RunPlan | Mapping[str, Any], task: HabitatTask | None = None
    ) -> None:
        """Read the episodes; scenes are opened when they are needed.

        Args:
            config: Name of a data set (``hm3d:data``, ``houses-val``), which is run with the robot
                and the limits of its benchmark, else those of HM3D; a plan; or a composed
                configuration of habitat-lab.
            task: Sensors, actions and rewards; by default those that the configuration says.

        Raises:
            ConfigError: The configuration asks for something that doesn't exist here.
            EpisodeError: There is no such data set, or nothing in it is chosen.
            SceneError: A scene cannot be used.
        """
        self._plan, configured = plan_of(config)
        self.task: HabitatTask = task or configured
        self._seed = self._plan.seed
        self._world: Simulator | None = None
        self._seen: Observation | None = None
        self._scene_id = ""
        self._referee: Referee | None = None
        self._current: Episode | None = None
        self._is_next_set = False
        self.episodes = self._plan.episodes()
        camera = self._plan.config.embodiment.camera
        self.observation_space: spaces.Dict = spaces.Dict(
            sensor_spaces(camera, self.task, max(self._numbers.values()))
        )
        self.action_space: spaces.Discrete = spaces.Discrete(len(self.task.actions))
        self.episode_over: bool = False
        self.is_stop_called: bool = False
        self._steps = 0
        self._collisions = 0
        self._collided = False
        self._approached_m = 0.0

    @property
    def episodes(self) -> list[Episode]:
        """All episodes, grouped by scene. Other episodes may be assigned."""
        return self._episodes

    @episodes.setter
    def episodes(self, episodes: Iterable[Episode]) -> None:
        self._given = list(episodes)
        if not self._given:
            raise EpisodeError("an environment needs at least one episode")
        self._numbers = category_numbers(self._given)
        self.seed(self._seed)

    @property
    def number_of_episodes(self) -> int:
        """Number of all episodes."""
        return len(self._episodes)

    @property
    def current_episode(self) -> Episode:
        """The episode that is running; before the first `reset`, the first one.

        An episode that is assigned is the next to run.
        """
        if self._current is None:
            self.current_episode = next(self._order)
        assert self._current is not None
        return self._current

    @current_episode.setter
    def current_episode(self, episode: Episode) -> None:
        self._current = episode
        self._is_next_set = True
        self._referee = None

    def seed(self, seed: int) -> None:
        """Start again with the first episode.

        Args:
            seed: Seed of all noise, and of the order if episodes are shuffled.
        """
        self._seed = seed
        orders = passes(self._given, shuffle=self.task.shuffle, seed=seed)
        self._episodes = next(orders)
        self._order = chain(self._episodes, chain.from_iterable(orders))
        self._current = self._referee = None
        self._is_next_set = False

    def reset(self) -> dict[str, Any]:
        """Begin the next episode; after the last one, the first follows.

        Returns:
            The first observation.

        Raises:
            SceneError: The scene cannot be used.
            StartError: The robot can't stand at the start.
        """
        if not self._is_next_set:
            self._current = next(self._order)
        self._is_next_set = False
        episode = self.current_episode
        self._world = world = self._world_of(episode.scene_id)
        self._seen = world.reset(episode, np.random.default_rng(episode.seed(self._seed)))
        goal = world.truth.goal_truth(episode.goal, episode.view_points)
        self._referee = Referee(goal, world.truth.position)
        self._steps = self._collisions = 0
        self.episode_over = self.is_stop_called = self._collided = False
        self._approached_m = 0.0
        return self._observed()

    def step(self, action: Any) -> dict[str, Any]:
        """Take an action and observe.

        Args:
            action: Number or name of the action, or a mapping with either as ``action``.

        Raises:
            WorldError: There is no such action, or no running episode.
        """
        world, referee = self._running()
        name = self._name_of(action)
        before_m = referee.distance_to_goal_m
        self._collided = False
        if name in _TILTS:
            if not isinstance(world, TiltsCamera):
                raise WorldError(f"the camera of the world '{self._plan.world}' can't be tilted")
            self._seen = world.tilt(_TILTS[name] * self.task.tilt_deg)
        else:
            self._seen = world.step(_MOTIONS[name])
            self._collided = world.collided
        referee.watch(world.truth.position)
        after_m = referee.distance_to_goal_m
        # Equal distances may both be infinite.
        self._approached_m = 0.0 if after_m == before_m else before_m - after_m
        self._steps += 1
        self._collisions += self._collided
        self.is_stop_called = name == "stop"
        self.episode_over = self.is_stop_called or self._steps >= self._plan.max_steps
        return self._observed()

    def get_metrics(self) -> dict[str, Any]:
        """The measures so far, by habitat-lab's names, lengths in metres.

        Raises:
            WorldError: Before the first `reset`.
        """
        if self._referee is None:
            raise WorldError("no episode before reset: call reset first")
        measured = self._referee.measure(
            stopped=self.is_stop_called, success_distance_m=self._plan.success_distance_m
        )
        return {
            "distance_to_goal": measured.distance_to_goal_m,
            "success": float(measured.success),
            "spl": measured.spl,
            "soft_spl": measured.soft_spl,
            "distance_to_goal_reward": self._approached_m,
            "num_steps": self._steps,
            "collisions": {"count": self._collisions, "is_collision": self._collided},
        }

    def render(self, mode: str = "rgb") -> UInt8[np.ndarray, "height width 3"]:
        """The camera image.

        Raises:
            WorldError: The mode isn't ``rgb``, or there is no episode.
        """
        if mode != "rgb" or self._world is None or self._seen is None:
            raise WorldError(f"render shows 'rgb' after reset, got the mode {mode!r:.40}")
        return self._seen.rgb.copy()

    def close(self) -> None:
        """Close the scene that is open."""
        if self._world is not None:
            self._world.close()
        self._world = self._referee = None

    def __enter__(self) -> "HabitatEnv":
        """The environment itself."""
        return self

    def __exit__(self, *error: object) -> None:
        """Close the environment."""
        self.close()

    def _world_of(self, scene_id: str) -> Simulator:
        """The world of a scene; one at a time, as a scan takes a lot of memory."""
        if self._world is not None and scene_id == self._scene_id:
            return self._world
        self.close()
        config = self._plan.config
        # Depth is clipped later, as in habitat-lab: a 0 here could mean too near or too far.
        camera = config.embodiment.camera.model_copy(
            update={"min_depth_m": 0.0, "max_depth_m": math.inf}
        )
        update = {
            "embodiment": config.embodiment.model_copy(update={"camera": camera}),
            "world": config.world.model_copy(update={"labels": "semantic" in self.task.sensors}),
        }
        opened = open_world(scene_id, config.model_copy(update=update), self._plan.world, threads=1)
        self._scene_id = scene_id
        self._semantic_ids = semantic_ids_of(opened.truth.instances, scene_id)
        return opened

    def _running(self) -> tuple[Simulator, Referee]:
        if self._world is None or self._referee is None or self.episode_over:
            raise WorldError("step without a running episode: call reset first")
        return self._world, self._referee

    def _name_of(self, action: object) -> str:
        if isinstance(action, Mapping):
            return self._name_of(action.get("action"))
        actions = self.task.actions
        if isinstance(action, str) and action in actions:
            return action
        if isinstance(action, int | np.integer) and 0 <= action < len(actions):
            return actions[int(action)]
        named = ", ".join(f"{number} {name}" for number, name in enumerate(actions))
        raise WorldError(f"there is no action {action!r:.60}; the actions are {named}")

    def _observed(self) -> dict[str, Any]:
        assert self._seen is not None, "an observation comes after reset"
        number = self._numbers[category_of(self.current_episode)]
        camera = self._plan.config.embodiment.camera
        return observed(self._seen, camera, self.task, number, self._semantic_ids)


_TILTS = {"look_up": -1.0, "look_down": 1.0}
_MOTIONS = {action.name.lower(): action for action in Action}
