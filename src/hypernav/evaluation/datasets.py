"""What is evaluated: data sets by name, and the episodes that they hold.

A data set is named on the command line as ``NAME[#IDS]`` or ``scene:SCENE[#STARTS]``. Each kind is
one `Source` in `SOURCES`; a benchmark on scans (HM3D, OVON) is one more.
"""

import difflib
import hashlib
import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from hypernav.build.scenes import build_scene
from hypernav.core.embodiment import Embodiment
from hypernav.core.episode import Episode
from hypernav.core.errors import EpisodeError
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.datasets.habitat_frames import pose_from_habitat
from hypernav.houses.episodes.splits import SPLITS, load_split
from hypernav.worlds.simulation import SimulatedWorld, SimulationConfig
from hypernav.worlds.surface.starts import random_start

STARTS_PER_GOAL = 5
"""Of ``scene:`` data sets that don't say how many."""

Progress = Callable[[int, int], None]
"""Is told how much of how much is done."""


@dataclass(frozen=True)
class Source:
    """One kind of data set.

    Attributes:
        form: How it is named, for people.
        load: Reads the part of the name after ``#`` (empty if there is none); gives all episodes in
            the data set's order.
    """

    form: str
    load: Callable[[str, SimulationConfig, Embodiment, Progress | None], list[Episode]]


def load_episodes(
    dataset: str,
    simulation: SimulationConfig | None = None,
    embodiment: Embodiment | None = None,
    *,
    progress: Progress | None = None,
) -> list[Episode]:
    """All episodes of a data set, in its order.

    Args:
        dataset: ``houses-val``, ``houses-ovon``, ``houses-train[#FIRST:END]`` or
            ``scene:SCENE[#STARTS]``, where SCENE is what ``hypernav find --scene`` understands.
        simulation: How the robot is simulated, for data sets that look for starts.
        embodiment: What the robot is, likewise.
        progress: Is told how far it is.

    Raises:
        EpisodeError: There is no such data set, or its name is not understood.
        SceneError: A scene cannot be used.
    """
    simulation, embodiment = simulation or SimulationConfig(), embodiment or Embodiment()
    name, _, ids = dataset.partition("#")
    if name.startswith("scene:"):
        return _scene_episodes(name.removeprefix("scene:"), ids, simulation, embodiment, progress)
    if name not in SOURCES:
        close = difflib.get_close_matches(name, SOURCES, n=1)
        hint = f"did you mean '{close[0]}'? " if close else ""
        forms = [source.form for source in SOURCES.values()]
        raise EpisodeError(
            f"unknown data set '{name}'; {hint}there are {', '.join(forms)} and "
            "scene:SCENE[#STARTS], for example scene:house.glb#5"
        )
    return SOURCES[name].load(ids, simulation, embodiment, progress)


def select(
    episodes: Sequence[Episode],
    *,
    part: str | None = None,
    scenes: str | None = None,
    goals: str | None = None,
) -> list[Episode]:
    """Some of the episodes of a data set.

    Args:
        episodes: All of them.
        part: Places in the data set's order, ``FIRST:END`` (END is not included).
        scenes: Scenes with commas between them: the name (``houses:1003``), its last part
            (``1003``), or the scene's place in the data set (``3``, from 0).
        goals: Goals with commas between them.

    Raises:
        EpisodeError: The text is not understood, a scene doesn't exist, or nothing is left.
    """
    chosen = list(episodes)
    if part is not None:
        chosen = chosen[_slice(part, len(chosen))]
    if scenes is not None:
        names = list(dict.fromkeys(episode.scene_id for episode in episodes))
        wanted = {_scene_named(text.strip(), names) for text in scenes.split(",")}
        chosen = [episode for episode in chosen if episode.scene_id in wanted]
    if goals is not None:
        names = {text.strip() for text in goals.split(",")}
        if unknown := sorted(names - {episode.goal.text for episode in episodes}):
            raise EpisodeError(f"--goals: no episode asks for '{unknown[0]}'")
        chosen = [episode for episode in chosen if episode.goal.text in names]
    if not chosen:
        raise EpisodeError(f"none of the {len(episodes)} episodes is left by what was chosen")
    return chosen


def fingerprint(episodes: Sequence[Episode]) -> str:
    """Tells two sets of episodes apart, their order included."""
    text = json.dumps([_identity(episode) for episode in episodes], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _identity(episode: Episode) -> dict[str, Any]:
    """All that a data set says about an episode."""
    identity = {
        "scene_id": episode.scene_id,
        "episode_id": episode.episode_id,
        "goal": episode.goal.text,
        "start": asdict(episode.start),
        "group": episode.group,
    }
    if episode.view_points is not None:
        identity["view_points"] = hashlib.sha256(episode.view_points.tobytes()).hexdigest()
    return identity


def _house_episodes(
    split: str,
    ids: str,
    simulation: SimulationConfig,
    embodiment: Embodiment,
    progress: Progress | None,
) -> list[Episode]:
    houses = None if not ids else _id_range(split, ids)
    dataset = load_split(split, houses=houses, progress=progress)
    return [
        Episode(
            scene_id=episode.scene_id,
            episode_id=str(episode.episode_id),
            goal=episode.goal,
            start=pose_from_habitat(episode.start_position, episode.start_rotation)[0],
            group=str((episode.info or {}).get("vocabulary", "")),
        )
        for episode in dataset.episodes
    ]


def _scene_episodes(
    scene: str,
    starts: str,
    simulation: SimulationConfig,
    embodiment: Embodiment,
    progress: Progress | None,
) -> list[Episode]:
    """All goals of one scene, each from several drawn starts."""
    if starts and not (starts.isdecimal() and int(starts) > 0):
        raise EpisodeError(f"scene:{scene}#{starts}: expected the number of starts per goal")
    world = SimulatedWorld(build_scene(scene), simulation, embodiment)
    count = int(starts) if starts else STARTS_PER_GOAL
    goals = world.regions.categories()
    if not goals:
        raise EpisodeError(f"scene:{scene}: no labelled object in it can be reached")
    episodes = []
    for done, goal in enumerate(goals):
        if progress is not None:
            progress(done, len(goals))
        region = world.regions.of(Goal(goal))
        for number in range(count):
            spec = Episode(scene, f"{goal}-{number}", Goal(goal), Pose2(0.0, 0.0, 0.0))
            rng = np.random.default_rng(spec.seed(0))
            start = random_start(world.walkable, rng, region)
            episodes.append(replace(spec, start=start))
    return episodes


def _id_range(split: str, ids: str) -> range:
    first, colon, end = ids.partition(":")
    if not first.isdecimal() or (colon and not end.isdecimal()):
        raise EpisodeError(
            f"{split}#{ids}: expected house numbers, for example {split}#3000:3004 (END is not "
            f"included) or {split}#3000"
        )
    return range(int(first), int(end) if colon else int(first) + 1)


def _slice(text: str, count: int) -> slice:
    first, colon, end = text.partition(":")
    if not colon or not all(part == "" or part.isdecimal() for part in (first, end)):
        raise EpisodeError(f"--episodes {text}: expected FIRST:END, for example 0:100")
    chosen = slice(int(first or 0), int(end) if end else count)
    if chosen.start >= min(chosen.stop, count):
        raise EpisodeError(f"--episodes {text}: holds none of the {count} episodes")
    return chosen


def _scene_named(text: str, names: list[str]) -> str:
    for name in names:
        if text in (name, name.rpartition(":")[2], Path(name).stem):
            return name
    if text.isdecimal() and int(text) < len(names):
        return names[int(text)]
    raise EpisodeError(
        f"--scenes: there is no scene '{text}'; there are {len(names)}, from {names[0]} to "
        f"{names[-1]}, or say a place from 0 to {len(names) - 1}"
    )


SOURCES: dict[str, Source] = {
    name: Source(f"{name}[#FIRST:END]" if split.is_open else name, partial(_house_episodes, name))
    for name, split in SPLITS.items()
}
"""The data sets that have a name."""
