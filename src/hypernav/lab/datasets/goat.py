"""GOAT-Bench's files: lives whose goals are categories, descriptions and images of objects.

A file ``{split}/content/{scene}.json.gz`` holds ``episodes`` with their ``tasks``, rows of
category, goal type, object and, for an image, its number; and ``goals``, all objects of a category
in the scene. Source: Khanna et al., "GOAT-Bench: A Benchmark for Multi-Modal Lifelong Navigation",
CVPR 2024, and how its released code reads the files.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path, PurePosixPath
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from jaxtyping import Float64
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, StrictInt

from hypernav.core.episode import Episode, ObjectName
from hypernav.core.errors import EpisodeError, GoalError
from hypernav.core.goal import Goal
from hypernav.io.parsing import Items
from hypernav.lab.datasets.habitat_files import episode_files, read_as
from hypernav.lab.datasets.habitat_format import (
    ObjectGoal,
    Position,
    Quaternion,
    pose_from_habitat,
    positions_from_habitat,
)

LONG_DESCRIPTION = "long description"
"""Goal type, here, of a description that the benchmark's code leaves out for its length."""
RUNNABLE = ("object", "description")
"""Goal types whose goals can be asked for in words."""

_WORDS = {
    "object": "category",
    "description": "description",
    "image": "image",
    LONG_DESCRIPTION: "over-long description",
}
_MOST_TASKS = 1_000
"""Most goals of a life; ours, the benchmark's have 5 to 10."""
_MOST_WORDS = 55
"""Greatest number of words of a description, counted by single spaces, as the code does."""


def goal_types_in(text: str) -> tuple[str, ...]:
    """The goal types that an option names, separated by commas; all that can be run if none.

    Raises:
        EpisodeError: There is no such type, or its goals can't be run.
    """
    named = tuple(dict.fromkeys(part.strip() for part in text.split(",") if part.strip()))
    if "image" in named:
        raise EpisodeError(
            "--goal-types: image goals are read and counted, but can't be run yet; use "
            f"{','.join(RUNNABLE)}"
        )
    if unknown := [one for one in named if one not in RUNNABLE]:
        raise EpisodeError(
            f"--goal-types: there is no '{unknown[0]:.40}'; use {','.join(RUNNABLE)}"
        )
    return named or RUNNABLE


def of_types(
    episodes: Sequence[Episode], types: Sequence[str]
) -> tuple[list[Episode], dict[str, int]]:
    """The goals of some types, and the numbers of all others by type.

    Raises:
        EpisodeError: There is none of these types.
    """
    kept = [episode for episode in episodes if episode.group in types]
    if not kept:
        raise EpisodeError(
            f"--goal-types: none of the {len(episodes)} chosen goals is of {' or '.join(types)}"
        )
    others = [episode.group for episode in episodes if episode.group not in types]
    return kept, {kind: others.count(kind) for kind in sorted(set(others))}


def goal_type_words(counts: Mapping[str, int]) -> str:
    """Numbers of goals by type: "12 image goals, 2 description goals"."""
    return ", ".join(
        f"{count:,} {_WORDS.get(kind, kind)} goal{'' if count == 1 else 's'}"
        for kind, count in counts.items()
    )


class GoatObject(ObjectGoal):
    """One object that goals may ask for.

    Attributes:
        lang_desc: Description of this object alone; None or empty if there is none.
        image_goals: Poses and cameras of its images, which are not read further.
        children_object_categories: Categories whose objects count as its category, too.
    """

    lang_desc: str | None = None
    image_goals: list[Any] = Field(default_factory=list)
    children_object_categories: list[str] | None = None


class GoatTask(NamedTuple):
    """The beginning of a row of ``tasks``; the number of an image at its end is not needed.

    Attributes:
        category: Category of the object.
        kind: Goal type.
        object_id: Name of the object; None if any of the category will do.
    """

    category: str
    kind: Literal["object", "description", "image"]
    object_id: StrictInt | str | None


def _first_three(row: Any) -> Any:
    return row[:3] if isinstance(row, list) else row


class GoatEpisode(BaseModel):
    """One life: a start, and goals in their order.

    Attributes:
        scene_id: File of the scene within its data set.
        start_position: Start position, Habitat's frame, metres.
        start_rotation: Start rotation, quaternion ``[x, y, z, w]``.
        tasks: Goals in their order, at most 1,000.
    """

    model_config = ConfigDict(frozen=True, extra="allow")

    scene_id: str
    start_position: Position
    start_rotation: Quaternion
    tasks: Annotated[
        list[Annotated[GoatTask, BeforeValidator(_first_three)]], Field(max_length=_MOST_TASKS)
    ]


class GoatFile(BaseModel):
    """The content of one file.

    Attributes:
        episodes: The lives.
        goals: All objects of a category in a scene, under a key of both.
    """

    model_config = ConfigDict(frozen=True, extra="allow")

    episodes: list[GoatEpisode]
    goals: dict[str, Items[GoatObject]] = Field(default_factory=dict)

    def objects_of(self, scene_id: str, category: str) -> tuple[GoatObject, ...]:
        """All objects that count as a category in a scene, those of its child categories last.

        Raises:
            EpisodeError: The file holds none, or holds the category twice.
        """
        scene = PurePosixPath(scene_id).name
        stem = scene.removesuffix(".glb").removesuffix(".basis")
        groups = [
            group
            for key, group in self.goals.items()
            if key.startswith(stem) and group and group[0].object_category == category
        ]
        if len(groups) != 1:
            raise EpisodeError(
                f"expected one entry of '{category}' in {scene} among the goals, found "
                f"{len(groups)}"
            )
        children = groups[0][0].children_object_categories or []
        further = (self.goals.get(f"{scene}_{child}", []) for child in children)
        return (*groups[0], *(one for group in further for one in group))


def goat_parts(
    path: Path,
    scene_of: Callable[[str], str] = lambda scene_id: scene_id,
    progress: Callable[[int, int], None] | None = None,
) -> Iterator[list[Episode]]:
    """The goals of a split as episodes of lives, one file after the other.

    Every task is there, whether it can be run or not: `Episode.group` is its goal type, "object",
    "description", "image" or `LONG_DESCRIPTION`. A life has the number of its episode in the file,
    as in the benchmark's code, and its goals have the numbers of their tasks, from 1.

    Args:
        path: Folder of the split, or one file.
        scene_of: Finds the scene that a ``scene_id`` of the files means.
        progress: Function that is called with the numbers of files read so far and of all.

    Raises:
        EpisodeError: A file is missing or broken, names an object that it doesn't hold, or there
            are no episodes.
    """
    files = episode_files(path)
    known: set[tuple[str, str]] = set()
    for done, file in enumerate(files):
        if progress is not None:
            progress(done, len(files))
        content = read_as(GoatFile, file)
        try:
            episodes = _episodes_of(content, scene_of)
        except EpisodeError as error:
            raise EpisodeError(f"{file}: {error}") from error
        if twice := known.intersection(episode.key for episode in episodes):
            raise EpisodeError(f"{file}: another file holds episodes of {min(twice)[0]}, too")
        known.update(episode.key for episode in episodes)
        yield episodes
    if not known:
        raise EpisodeError(f"{path}: no file holds an episode; unpack the archive again")


def _episodes_of(content: GoatFile, scene_of: Callable[[str], str]) -> list[Episode]:
    """All goals of all lives of a file."""
    known: dict[tuple[str, GoatTask], _Asked] = {}  # thousands of goals share a few hundred
    episodes = []
    for number, entry in enumerate(content.episodes):
        start, start_z = pose_from_habitat(entry.start_position, entry.start_rotation)
        for place, task in enumerate(entry.tasks, start=1):
            key = (entry.scene_id, task)
            if key not in known:
                try:
                    known[key] = _Asked.of(content, *key)
                except (EpisodeError, GoalError) as error:
                    raise EpisodeError(f"episode {number}, task {place}: {error}") from error
            asked = known[key]
            episodes.append(
                Episode(
                    scene_id=scene_of(entry.scene_id),
                    episode_id=f"{number}.{place}",
                    goal=asked.goal,
                    start=start,
                    start_z=start_z,
                    group=asked.kind,
                    view_points=asked.view_points,
                    objects=asked.objects,
                    object_category=task.category,
                    life=str(number),
                )
            )
    return episodes


class _Asked(NamedTuple):
    """What a task asks for, and where it counts as reached."""

    goal: Goal
    kind: str
    view_points: Float64[np.ndarray, "n 3"]
    objects: tuple[ObjectName, ...]

    @staticmethod
    def of(content: GoatFile, scene_id: str, task: GoatTask) -> "_Asked":
        objects = content.objects_of(scene_id, task.category)
        text, kind = task.category, task.kind
        if kind != "object":
            objects = tuple(one for one in objects if one.object_id == task.object_id)
            if not objects:
                raise EpisodeError(f"'{task.category}' has no object {task.object_id!r}")
        if kind == "description":
            words = objects[0].lang_desc or ""
            text = " ".join(words.split())
            kind = kind if len(words.split(" ")) <= _MOST_WORDS else LONG_DESCRIPTION
        if kind == LONG_DESCRIPTION:
            text = task.category  # nobody is asked for it
        points = [view.agent_state.position for one in objects for view in one.view_points]
        view_points = positions_from_habitat(np.array(points, dtype=np.float64).reshape(-1, 3))
        return _Asked(Goal(text), kind, view_points, tuple(one.in_scene for one in objects))
