"""An episode: its goal, its outcome and its measures; lives of several; and the truth about one.

Measures are exactly those of habitat-lab, ``habitat/tasks/nav/nav.py`` (``Success``, ``SPL``,
``SoftSPL``, ``DistanceToGoal``), after Anderson et al., "On Evaluation of Embodied Navigation
Agents", 2018.
"""

import hashlib
import json
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float64

from hypernav.core.errors import TruthMissingError
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal

SUCCESS_DISTANCE_M = 0.1
"""Habitat's success distance, geodesic: a STOP within it of a view point is a success."""

MAX_STEPS = 500
"""Habitat's step limit."""

PathLeft = Callable[[float, float], float]
"""True length of the shortest path, metres, from a position ``(x, y)`` in the ``map`` frame to the
goal; infinite if none leads there."""


@dataclass(frozen=True)
class EpisodeMetrics:
    """Measures of one episode.

    Attributes:
        success: Whether the agent stopped within the success distance of a view point.
        spl: Success weighted by path length.
        soft_spl: SPL with progress towards the goal in place of success.
        distance_to_goal_m: Geodesic distance to the nearest view point, metres; infinite if there
            is none.
        shortest_path_m: Geodesic distance to the nearest view point at the start, metres.
        path_length_m: Length of the path driven, summed over all steps, metres.
    """

    success: bool
    spl: float
    soft_spl: float
    distance_to_goal_m: float
    shortest_path_m: float
    path_length_m: float


def measure(
    *,
    stopped: bool,
    distance_to_goal_m: float,
    shortest_path_m: float,
    path_length_m: float,
    success_distance_m: float,
) -> EpisodeMetrics:
    """Compute the measures of an episode from its lengths, all geodesic metres.

    Special cases of the divisions: a start at the goal counts as an efficient path, and a goal
    that no path leads to (infinite distance) can be neither reached nor approached.
    """
    reachable = math.isfinite(shortest_path_m)
    success = stopped and reachable and distance_to_goal_m < success_distance_m
    longest = max(shortest_path_m, path_length_m)
    if not reachable:
        efficiency = 0.0
    elif longest == 0.0:
        efficiency = 1.0
    else:
        efficiency = shortest_path_m / longest
    if not reachable or not math.isfinite(distance_to_goal_m):
        progress = 0.0
    elif shortest_path_m == 0.0:
        progress = 1.0 if distance_to_goal_m == 0.0 else 0.0
    else:
        progress = max(0.0, 1.0 - distance_to_goal_m / shortest_path_m)
    return EpisodeMetrics(
        success=success,
        spl=float(success) * efficiency,
        soft_spl=progress * efficiency,
        distance_to_goal_m=distance_to_goal_m,
        shortest_path_m=shortest_path_m,
        path_length_m=path_length_m,
    )


class ObjectName(NamedTuple):
    """An object of a scene, as a data set names it.

    Attributes:
        name: Name in the scene, such as ``chair_123``; None if it has none.
        number: Number in the scene's annotation; None if it has none.
    """

    name: str | None
    number: int | None


@dataclass(frozen=True)
class Episode:
    """One task: a scene, a start, a goal, and the conditions of success.

    Attributes:
        scene_id: Name of the scene, as ``hypernav find --scene`` understands it.
        episode_id: Name that is unique within the scene.
        goal: Target of the search.
        start: Start pose, scene frame; for the later goals of a life that of a robot
            that made no mistake so far.
        start_z: Height of the floor at the start, metres, which identifies the storey of a
            building; None leaves the storey to the world.
        group: Part of the data set ("unseen"); empty if there is none.
        max_steps: Step limit; STOP counts as a step.
        success_distance_m: Geodesic distance to a view point within which a STOP counts, metres.
        view_points: Points of the data set on the floor where the goal counts as reached, metres,
            scene frame; None computes them from the scene. Equality ignores them.
        objects: Objects that satisfy the goal by the data set, besides those with that name in the
            scene. Equality ignores them.
        object_category: The data set's category of the goal, such as ``tv_monitor``; empty if it
            has none. Equality ignores it.
        category_ids: Numbers of all categories of the data set, for Habitat's sensor
            ``objectgoal``. Equality ignores them.
        life: Name of the life that the goal belongs to, unique within the scene; empty if there is
            none.
        max_life_steps: Step limit of that whole life; None if it has none of its own.
    """

    scene_id: str
    episode_id: str
    goal: Goal
    start: Pose2
    group: str = ""
    start_z: float | None = None
    max_steps: int = MAX_STEPS
    success_distance_m: float = SUCCESS_DISTANCE_M
    view_points: Float64[np.ndarray, "n 3"] | None = field(default=None, compare=False, repr=False)
    objects: tuple[ObjectName, ...] = field(default=(), compare=False, repr=False)
    object_category: str = field(default="", compare=False, repr=False)
    category_ids: Mapping[str, int] = field(default_factory=dict, compare=False, repr=False)
    life: str = ""
    max_life_steps: int | None = None

    @property
    def key(self) -> tuple[str, str]:
        """Identity of the episode: no two episodes of a data set share it."""
        return (self.scene_id, self.episode_id)

    def seed(self, run_seed: int) -> int:
        """Seed of all noise in this episode, independent of the episodes that ran before it.

        It does not depend on the folder of a scene's file.
        """
        text = json.dumps([run_seed, Path(self.scene_id).name, self.episode_id]).encode()
        return int.from_bytes(hashlib.sha256(text).digest()[:8], "big")


class Outcome(StrEnum):
    """Outcomes of an episode.

    A model outage or a simulator error is never counted as a failure of navigation.
    """

    FOUND = "found"
    """Stopped, and the goal is there."""
    WRONG_PLACE = "wrong_place"
    """Stopped where the goal is not."""
    NOT_FOUND = "not_found"
    """Gave up, or ran out of steps."""
    UNREACHABLE = "unreachable"
    """The scene holds the goal, but no path leads there from the start."""
    MODEL_UNAVAILABLE = "model_unavailable"
    """A model did not answer within the configured patience."""
    SIMULATOR_ERROR = "simulator_error"
    """The world failed, or the process that ran it was lost repeatedly."""
    INTERRUPTED = "interrupted"
    """Somebody stopped the program."""


@dataclass(frozen=True)
class Life:
    """Several goals, one after the other, in one building with one memory.

    The first search begins at the start of its episode, each other one where the robot stands. An
    episode that belongs to no life is a life of one.

    Attributes:
        episodes: One episode for each goal, in their order.
    """

    episodes: tuple[Episode, ...]

    @property
    def scene_id(self) -> str:
        """Name of the building."""
        return self.episodes[0].scene_id

    @property
    def key(self) -> tuple[str, str]:
        """Scene and name: no two lives of a data set share them."""
        first = self.episodes[0]
        return (first.scene_id, first.life or first.episode_id)

    @property
    def max_steps(self) -> int:
        """Greatest number of steps of all searches together."""
        return self.episodes[0].max_life_steps or sum(one.max_steps for one in self.episodes)


def lives_of(episodes: Iterable[Episode]) -> list[Life]:
    """The lives that episodes belong to, in the order of their first episodes."""
    found: dict[tuple[str, str, str], list[Episode]] = {}
    for episode in episodes:
        alone = "" if episode.life else episode.episode_id
        found.setdefault((episode.scene_id, episode.life, alone), []).append(episode)
    return [Life(tuple(group)) for group in found.values()]


class EpisodeTruth:
    """The truth about the running episode for stand-ins, which no real model ever gets.

    A component asks for it by a constructor parameter ``truth``; what runs an episode sets it
    (`hypernav.lab.episodes.episode_run.EpisodeRun`). On a robot nothing does, so a stand-in can't
    work there.
    """

    def __init__(self) -> None:
        """Create it without any truth."""
        self.tell()

    def tell(
        self, *, rng: np.random.Generator | None = None, path_left_m: PathLeft | None = None
    ) -> None:
        """Replace everything by the truth about the next episode.

        Args:
            rng: Generator of this episode, not shared; None if there is none.
            path_left_m: Lengths of true paths to the goal; None if they are unknown.
        """
        self._rng = rng
        self._path_left_m = path_left_m

    @property
    def rng(self) -> np.random.Generator:
        """Generator for all random numbers of this episode.

        Raises:
            TruthMissingError: None was set.
        """
        if self._rng is None:
            raise TruthMissingError(_missing("a generator of random numbers"))
        return self._rng

    def path_left_m(self, x: float, y: float) -> float:
        """True length of the shortest path to the goal, metres; infinite if none leads there.

        Args:
            x: x of the position where the path begins, ``map`` frame, metres.
            y: y of the same position.

        Raises:
            TruthMissingError: It was not set.
        """
        if self._path_left_m is None:
            raise TruthMissingError(_missing("true paths to the goal"))
        return self._path_left_m(x, y)


def _missing(what: str) -> str:
    return (
        "a stand-in for a model (noisy, random) works only in a simulated world with ground truth: "
        f"it expected {what} for the episode and got none; choose a real model, or run the "
        "episode with `hypernav find`, `hypernav eval` or EpisodeRun(…, told=parts.truth, rng=…)"
    )
