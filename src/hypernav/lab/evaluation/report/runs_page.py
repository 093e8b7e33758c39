"""One page over all runs in a folder: searches of ``hypernav find`` and of ``hypernav eval``.

The page filters, sorts and compares by itself; nothing is averaged here.
"""

import os
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import chain
from pathlib import Path
from typing import Any
from urllib.parse import quote

from hypernav.app.show.templating import page_environment
from hypernav.core.episode import Outcome
from hypernav.core.errors import RunFolderError
from hypernav.io.foreign_folder import read_own
from hypernav.io.parsing import parse_json
from hypernav.lab.evaluation.failures import Failure
from hypernav.lab.evaluation.record import EpisodeRecord
from hypernav.lab.evaluation.store.run_store import (
    RUN_FILE,
    SAVED_FOLDER,
    UNENDED,
    flat,
    read_configuration,
    read_records,
    read_sessions,
)

PAGE_NAME = "runs.html"
RESULT_FILE = "result.json"
_APART = (Outcome.MODEL_UNAVAILABLE, Outcome.SIMULATOR_ERROR, Outcome.INTERRUPTED)
"""Outcomes that count in no rate."""


@dataclass(frozen=True)
class Overview:
    """What a folder holds.

    Attributes:
        runs: One entry for every folder of a run, as plain data for the page.
        searches: One entry for every search of them, the latest run first.
        left_out: Folders that can't be read, each with the reason.
    """

    runs: list[dict[str, Any]]
    searches: list[dict[str, Any]]
    left_out: list[str]


def overview(root: Path) -> Overview:
    """All runs below a folder.

    Args:
        root: The folder; runs may lie in folders of it, at any depth.
    """
    found = Overview([], [], [])
    folders = sorted(run_folders(root), key=_changed, reverse=True)
    for folder in folders:
        try:
            if (folder / RUN_FILE).exists():
                configuration = read_configuration(folder)
                if "study" in configuration:
                    continue  # an ablation, whose variants are runs of their own
                run, searches = _run(folder, configuration)
            else:
                run, searches = _search(folder)
        except RunFolderError as error:
            found.left_out.append(str(error))
            continue
        name = folder.relative_to(root).as_posix()
        number = len(found.runs)
        found.runs.append({"name": "this folder" if name == "." else name} | run)
        for search in searches:
            page = folder / search.pop("saved") if "saved" in search else None
            found.searches.append({"run": number, **search, **_pages(page, root)})
    _say_what_differs(found.runs)
    return found


def _say_what_differs(runs: Sequence[dict[str, Any]]) -> None:
    """Put the values that are not the commonest of all runs in place of whole configurations."""
    configurations = [flat(run.pop("config")) for run in runs]
    counts = defaultdict[str, Counter[str]](Counter)
    for key, value in chain.from_iterable(one.items() for one in configurations):
        counts[key][str(value)] += 1
    usual = {key: count.most_common(1)[0][0] for key, count in counts.items()}
    for run, one in zip(runs, configurations, strict=True):
        differing = [f"{key} {value}" for key, value in one.items() if str(value) != usual[key]]
        run["differs"] = ", ".join(differing)


def run_folders(root: Path) -> Iterator[Path]:
    """The folders of runs below a folder, each without those of its single episodes."""
    left = [root]
    while left:  # not `os.walk`, which fails in deep folders before Python 3.12
        folder = left.pop()
        try:
            with os.scandir(folder) as found:
                entries = {one.name: one.is_dir(follow_symlinks=False) for one in found}
        except OSError:
            continue
        if is_run := RUN_FILE in entries or RESULT_FILE in entries:
            yield folder
        if RESULT_FILE not in entries:
            left += [
                folder / name
                for name, is_folder in entries.items()
                if is_folder and not (is_run and name == SAVED_FOLDER)
            ]


def changed(root: Path) -> float:
    """Time of the last change of any run below a folder; 0 if there is none."""
    return max((_changed(folder) for folder in run_folders(root)), default=0.0)


def _changed(folder: Path) -> float:
    """When a file of a run was written last; 0 if the folder has just been removed."""
    names = (RUN_FILE, RESULT_FILE, "episodes.jsonl", "sessions.jsonl")
    return max((_time(folder / name) for name in names), default=0.0)


def _time(path: Path) -> float:
    try:
        return path.stat().st_mtime
    except OSError:
        return 0.0


def _run(
    folder: Path, configuration: Mapping[str, Any]
) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """A run of ``hypernav eval``, or of a variant of ``hypernav ablate``."""
    records, sessions = read_records(folder), read_sessions(folder)
    who = configuration.get("who")
    if not isinstance(who, Mapping):
        raise RunFolderError(f"{folder} is the folder of another kind of study, without a table")
    commits = dict.fromkeys(one.commit for one in sessions if one.commit)
    wanted = configuration.get("episodes")
    run = {
        "agent": _agent(who),
        "of": configuration.get("dataset", ""),
        "commit": ", ".join(commits),
        "wanted": wanted.get("count") if isinstance(wanted, Mapping) else None,
        "ended": sessions[-1].ended if sessions else UNENDED,
        "when": _when(_changed(folder)),
        "config": _mapping(configuration.get("config")),
    }
    return run, [_episode(record) for record in records]


def _episode(record: EpisodeRecord) -> dict[str, Any]:
    return {
        "key": "/".join(record.key),
        "goal": record.goal,
        "building": record.scene_id,
        "outcome": _outcome(record.outcome, record.failure),
        "counts": record.counts,
        "success": record.success,
        "spl": record.spl,
        "steps": record.steps,
        "path": round(record.path_length_m, 2),
        "why": record.why,
        **({"saved": record.saved} if record.saved else {}),
    }


def _search(folder: Path) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """A search of ``hypernav find``.

    Raises:
        RunFolderError: Its result can't be read, or isn't one.
    """
    path = folder / RESULT_FILE
    try:
        result = parse_json(read_own(path))
        outcome = Outcome(result["outcome"])
        search = {
            "key": "/".join(str(result.get(name)) for name in ("scene", "goal", "start", "seed")),
            "goal": str(result["goal"]),
            "building": str(result["scene"]),
            "outcome": _outcome(outcome, None),
            "counts": outcome not in _APART,
            "success": bool(result["success"]),
            "spl": result["spl"],
            "steps": result["steps"],
            "path": result["path_length_m"],
            "why": str(result.get("detail") or ""),
            "saved": "",
        }
        run = {
            "agent": _agent(result),
            "of": ", ".join(str(result[name]) for name in ("goal", "scene")),
            "commit": str(result.get("commit") or ""),
            "wanted": 1,
            "ended": outcome.value if outcome is Outcome.INTERRUPTED else "finished",
            "when": _when(_changed(folder)),
            "config": _mapping(result.get("config")),
        }
    except OSError as error:
        raise RunFolderError(f"{path} cannot be read: {error.strerror or error}") from error
    except (ValueError, KeyError, TypeError) as error:
        raise RunFolderError(f"{path} is not the result of a search ({error})") from error
    return run, [search]


def _agent(who: Mapping[str, Any]) -> str:
    """Agent, preset, and what it sees with, in a few words."""
    parts = [str(who.get(name) or "") for name in ("agent", "preset", "detector", "model")]
    return ", ".join(part for part in parts if part and part != "none")


def _mapping(value: Any) -> Mapping[str, Any]:
    return value if isinstance(value, Mapping) else {}


def _outcome(outcome: Outcome, failure: Failure | None) -> str:
    return failure.words if failure is not None else outcome.value.replace("_", " ")


def _when(seconds: float) -> str:
    return datetime.fromtimestamp(seconds, UTC).astimezone().strftime("%Y-%m-%d %H:%M")


def _pages(folder: Path | None, root: Path) -> dict[str, str]:
    """Addresses of the page and of the film of a search, relative to the overview's folder."""
    if folder is None:
        return {}
    files = {"page": folder / "index.html", "film": folder / "episode.mp4"}
    return {
        name: quote(os.fsencode(path.relative_to(root).as_posix()))
        for name, path in files.items()
        if path.is_file()
    }


def runs_page(found: Overview, name: str, *, reload_s: float | None = None) -> str:
    """The page, as HTML; it links to pages and films beside it.

    Args:
        found: What it shows.
        name: Name of the folder.
        reload_s: Time after which the page loads itself again; None if it is not made anew.
    """
    template = page_environment("hypernav.lab.evaluation").get_template("runs.html.j2")
    return template.render(
        name=name,
        runs=found.runs,
        searches=found.searches,
        left_out=found.left_out,
        content={"runs": found.runs, "searches": found.searches, "reload": reload_s},
        made=_when(datetime.now(UTC).timestamp()),
        reload_s=reload_s,
    )
