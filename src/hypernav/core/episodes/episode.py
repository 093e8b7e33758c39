"""An episode, and the outcomes that it can have."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float64

from hypernav.core.episodes.metrics import SUCCESS_DISTANCE_M
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal

MAX_STEPS = 500
"""Habitat's step limit."""


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
