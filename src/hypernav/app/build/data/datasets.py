"""The episodes of a data set, and their selection."""

import difflib
import hashlib
import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, astuple
from math import isfinite
from pathlib import Path
from typing import Any

from hypernav.app.build.data.scenes import is_no_file
from hypernav.app.build.data.sources import DATA_SOURCES, DatasetRequest, Progress
from hypernav.core.components.door import calling
from hypernav.core.embodiment import Embodiment
from hypernav.core.episode import Episode, lives_of
from hypernav.core.errors import ComponentError, EpisodeError
from hypernav.core.naming.words import is_whole_number
from hypernav.lab.datasets.benchmark_files import scene_number
from hypernav.simulator.worlds.config import SimulationConfig

_SHOWN_SCENES = 40
"""Most scenes that a message lists; more than HM3D has for validation."""


def load_episodes(
    dataset: str,
    simulation: SimulationConfig | None = None,
    embodiment: Embodiment | None = None,
    *,
    scenes_dir: Path | None = None,
    as_in_files: bool = False,
    progress: Progress | None = None,
) -> list[Episode]:
    """All episodes of a data set, in its order.

    Args:
        dataset: ``houses-val``, ``houses-ovon``, ``houses-train[#FIRST:END]``, the same
            of ``offices`` and ``shops``, ``houses-life-val`` and the like,
            ``scene:SCENE[#STARTS]``, where SCENE is what ``hypernav find --scene`` understands,
            ``habitat:FILE``, or a published benchmark: ``hm3d:DIR[#SPLIT]``, ``mp3d:…``,
            ``ovon:…``.
        simulation: How the robot is simulated, for data sets that draw starts.
        embodiment: Body, camera and motion of the robot, for data sets that draw starts.
        scenes_dir: Folder of the scenes that an episode file names; by default the file's own.
        as_in_files: Whether goals are named as in the episode files, even if the data set has names
            of its own.
        progress: Function that is called with the progress of loading.

    Raises:
        ComponentError: The function of a data set of a user's own fails.
        ConfigError: There is no such data set.
        EpisodeError: Its name is not understood, or it is broken.
        SceneError: A scene cannot be used.
    """
    name, part = _name_and_part(dataset)
    if part == "":
        raise EpisodeError(f"{dataset}: nothing follows the #; say which part, or leave it out")
    choice = DATA_SOURCES.find(name)
    request = DatasetRequest(
        argument="".join(choice.arguments),
        part=part or "",
        simulation=simulation or SimulationConfig(),
        embodiment=embodiment or Embodiment(),
        scenes_dir=scenes_dir,
        as_in_files=as_in_files,
        progress=progress,
    )
    if not choice.entry.is_foreign:
        return choice.load()(request)
    with calling(dataset, "its function"):
        episodes = list(choice.load()(request))
        if others := [one for one in episodes if not isinstance(one, Episode)]:
            said = f"{others[0]!r:.80} as an Episode"
            raise ComponentError(f"{dataset}: its function returned {said}")
        if lost := [one for one in episodes if not all(map(isfinite, astuple(one.start)))]:
            said = f"{lost[0].episode_id!r:.80} with the start {lost[0].start}"
            raise ComponentError(f"{dataset}: its function returned the episode {said}")
    return episodes


def canonical_name(dataset: str) -> str:
    """A data set's name without trailing slashes: ``hm3d:DIR/#val`` becomes ``hm3d:DIR#val``."""
    name, part = _name_and_part(dataset)
    return name if part is None else f"{name}#{part}"


def _name_and_part(dataset: str) -> tuple[str, str | None]:
    """A data set's name and what follows its ``#``, without trailing slashes; None without one.

    A ``#`` within the path of an existing file or folder is one of its characters.
    """
    source, colon, path = dataset.partition(":")
    if "#" in source:  # a part with a colon, as in houses-val#1000:1004
        source, colon, path = "", "", dataset
    name, part = path, None
    hashes = [k for k, character in enumerate(path) if character == "#"]
    if hashes and not (colon and os.path.exists(path)):
        ends = [k for k in reversed(hashes) if colon and os.path.exists(path[:k])]
        end = ends[0] if ends else hashes[0]
        name, part = path[:end], path[end + 1 :].rstrip("/")
    name = f"{source}{colon}{name}"
    shorter = name.rstrip("/")
    return (name if shorter.endswith(":") else shorter), part


def select(
    episodes: Sequence[Episode],
    *,
    part: str | None = None,
    scenes: str | None = None,
    goals: str | None = None,
    words: Mapping[str, str] | None = None,
) -> list[Episode]:
    """Some of the episodes of a data set.

    Args:
        episodes: All episodes of the data set.
        part: Positions in the data set's order, ``FIRST:END`` (END is not included); those of
            lives, where it has lives.
        scenes: Scenes with commas between them: the name (``houses:1003``), its last part
            (``1003``), the number or name of an HM3D scene (``802``, ``00802-wcojb4TFT35``), or,
            where scenes have no such numbers, their position in the data set (``3``, from 0).
        goals: Goals with commas between them, by the names of the episodes or of the benchmark's
            files.
        words: Names of the goals by category of the files, where the two differ.

    Raises:
        EpisodeError: The text is not understood, a scene doesn't exist, or nothing is left.
    """
    chosen = list(episodes)
    if part is not None:
        lives = lives_of(episodes)
        chosen = [one for life in lives[_slice(part, len(lives))] for one in life.episodes]
    if scenes is not None:
        names = list(dict.fromkeys(episode.scene_id for episode in episodes))
        wanted = {_scene_named(text, names) for text in _listed("--scenes", scenes)}
        chosen = [episode for episode in chosen if episode.scene_id in wanted]
    if goals is not None:
        known = {episode.goal.text for episode in episodes}
        names = {
            text if text in known else (words or {}).get(text, text.replace("_", " "))
            for text in _listed("--goals", goals)
        }
        if unknown := sorted(names - known):
            close = difflib.get_close_matches(unknown[0], known, n=1)
            hint = f"did you mean '{close[0]}'? " if close else ""
            some = ", ".join(sorted(known)[:8])
            raise EpisodeError(
                f"--goals: no episode asks for '{unknown[0]}'; {hint}there are {len(known)} goals: "
                f"{some}{', …' if len(known) > 8 else ''}"
            )
        chosen = [episode for episode in chosen if episode.goal.text in names]
    if not chosen:
        raise EpisodeError(f"the selection leaves none of the {len(episodes)} episodes")
    return chosen


def _listed(option: str, text: str) -> list[str]:
    """The parts of a list with commas, without empty ones."""
    parts = [part.strip() for part in text.split(",") if part.strip()]
    if not parts:
        raise EpisodeError(f"{option} '{text:.40}': names nothing")
    return parts


def check_scenes(episodes: Sequence[Episode]) -> None:
    """Make sure that the scenes of the selected episodes exist, before a long run begins.

    Raises:
        EpisodeError: A scene's file is missing.
    """
    scenes = dict.fromkeys(episode.scene_id for episode in episodes)
    missing = [scene for scene in scenes if not is_no_file(scene) and not Path(scene).is_file()]
    if missing:
        told = f"{len(missing)} of {len(scenes)} scenes are missing, the first is {missing[0]}"
        raise EpisodeError(
            f"{told if len(missing) > 1 else f'the scene {missing[0]} is missing'}; "
            "hypernav doctor --data DIR says what there is; choose scenes with --scenes, or their "
            "folder with --scenes-dir"
        )


def fingerprint(episodes: Sequence[Episode]) -> str:
    """Hash of a sequence of episodes."""
    text = json.dumps([_identity(episode) for episode in episodes], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _identity(episode: Episode) -> dict[str, Any]:
    """Everything that a data set says about an episode."""
    identity: dict[str, Any] = {
        "scene_id": episode.scene_id,
        "episode_id": episode.episode_id,
        "goal": episode.goal.text,
        "start": asdict(episode.start),
        "group": episode.group,
    }
    if episode.view_points is not None:
        identity["view_points"] = hashlib.sha256(episode.view_points.tobytes()).hexdigest()
    if episode.life:
        identity["life"] = episode.life
    return identity


def _slice(text: str, count: int) -> slice:
    first, colon, end = text.partition(":")
    if not colon or not all(part == "" or is_whole_number(part) for part in (first, end)):
        raise EpisodeError(f"--episodes {text:.40}: expected FIRST:END, for example 0:100")
    chosen = slice(int(first or 0), int(end) if end else count)
    if chosen.start >= min(chosen.stop, count):
        raise EpisodeError(f"--episodes {text}: holds none of the {count} episodes")
    return chosen


def _short_names(scene: str) -> set[str]:
    """Shorter names of a scene: ``802`` for a file in the folder ``00802-wcojb4TFT35``."""
    path = Path(scene)
    folder = path.parent.name
    names = {scene.rpartition(":")[2], path.stem, path.stem.removesuffix(".basis")}
    if number := scene_number(scene):
        names |= {folder, folder.partition("-")[0], number}
    return names


def _scene_named(text: str, names: list[str]) -> str:
    """The scene of a name, the last part of a name, or a position.

    Raises:
        EpisodeError: There is no such scene, or more than one.
    """
    if text in names:
        return text
    found = [name for name in names if text in _short_names(name)]
    if len(found) > 1:
        raise EpisodeError(
            f"--scenes: '{text}' names {len(found)} scenes: {', '.join(found[:5])}; write the "
            "whole name of one"
        )
    if found:
        return found[0]
    # HM3D's scenes have numbers: there a number that none of them has is a mistake, no position.
    if numbers := [number for name in names if (number := scene_number(name))]:
        shown = ", ".join(numbers[:_SHOWN_SCENES])
        there = f"there are {len(names)}: {shown}{', …' if len(names) > _SHOWN_SCENES else ''}"
    elif is_whole_number(text) and int(text) < len(names):
        return names[int(text)]
    else:
        there = (
            f"there are {len(names)}, from {names[0]} to {names[-1]}, or give a position from 0 to "
            f"{len(names) - 1}"
        )
    raise EpisodeError(f"--scenes: there is no scene '{text}'; {there}")
