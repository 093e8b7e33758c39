"""A search that was run to its end and recorded: it shows itself, saves itself, becomes a table."""

import shutil
import tempfile
import weakref
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hypernav.app.show.captions import ITS_OWN
from hypernav.app.show.templating import data_uri, html_table
from hypernav.core.components.registry import require
from hypernav.core.errors import ConfigError, OutputError
from hypernav.core.trace import StepTrace, floor_of
from hypernav.lab.episodes.episode_run import EpisodeResult, EpisodeRun
from hypernav.lab.episodes.recorder import EpisodeRecorder

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True, eq=False)
class SearchRecord:
    """A recorded search. In a notebook it shows its film, its map and its figures.

    Attributes:
        goal: What was to be found.
        folder: The files that ``hypernav find`` writes too, ``index.html`` among them.
        result: How the search ended.
        steps: What the robot did in every step, and why.
    """

    goal: str
    folder: Path
    result: EpisodeResult
    steps: Sequence[StepTrace]

    def save(self, folder: str | Path) -> Path:
        """Copy all files to a folder, which is created if missing.

        Returns:
            The page, which needs no network.

        Raises:
            OutputError: They cannot be written.
        """
        try:
            shutil.copytree(self.folder, folder, dirs_exist_ok=True)
        except OSError as error:
            raise OutputError(f"{folder} cannot be written ({error.strerror or error})") from error
        return Path(folder) / "index.html"

    def to_pandas(self) -> "pandas.DataFrame":
        """A row for every step: its number, floor, pose (metres, radians), mode, action, reason.

        Raises:
            MissingExtraError: pandas is not installed.
        """
        return require("pandas", extra="notebook").DataFrame([_row(step) for step in self.steps])

    def __repr__(self) -> str:
        """One line, without the steps."""
        figures = ", ".join(f"{name} {value}" for name, value in _figures(self.result).items())
        return f"SearchRecord({self.goal}: {figures}; {self.folder}/index.html)"

    def _repr_html_(self) -> str:
        film, drawn = self.folder / "episode.mp4", self.folder / "map.png"
        parts = [html_table([{"goal": self.goal, **_figures(self.result)}])]
        if drawn.exists():
            uri = data_uri(drawn.read_bytes(), "image/png")
            parts.insert(0, f'<img src="{uri}" alt="the map" style="max-width: 30em">')
        if film.exists():
            uri = data_uri(film.read_bytes(), "video/mp4")
            parts.insert(0, f'<video controls src="{uri}" style="max-width: 100%"></video>')
        return "".join(parts)


def record(search: EpisodeRun, folder: str | Path | None) -> SearchRecord:
    """Run a search to its end and record it; see `EpisodeRun.record`."""
    if search.trial.steps > 0:
        raise ConfigError(
            f"the search has taken {search.trial.steps} steps that nothing recorded; call record "
            "before its first step, instead of iterating over it"
        )
    home = Path(tempfile.mkdtemp(prefix="hypernav-")) if folder is None else Path(folder)
    goal, told = search.trial.episode.goal.text, search.described
    names = {key: told.get(key, ITS_OWN) for key in ("agent", "detector", "reasoner")}
    limit = search.trial.episode.max_steps
    with EpisodeRecorder(home.absolute(), goal=goal, step_limit=limit, **names) as recorder:
        for step in search:
            recorder.add(step.trace, step.grid, step.observation)
        result = search.result()
        head = {"goal": goal, "scene": search.trial.episode.scene_id}
        recorder.finish(head | told | {"max_steps": limit} | result.as_dict())
        recorded = SearchRecord(goal, home, result, recorder.steps)
    if folder is None:
        weakref.finalize(recorded, shutil.rmtree, home, ignore_errors=True)
    return recorded


def _row(step: StepTrace) -> dict[str, Any]:
    x, y, yaw = step.pose
    return {
        "step": step.step,
        "floor": floor_of(step),
        "x": x,
        "y": y,
        "z": step.z,
        "yaw": yaw,
        "mode": step.mode.value,
        "action": "" if step.action is None else step.action.name,
        "reason": step.reason,
    }


def _figures(result: EpisodeResult) -> dict[str, Any]:
    metrics = result.metrics
    return {
        "outcome": result.outcome.value.replace("_", " "),
        "steps": result.steps,
        "metres driven": metrics.path_length_m,
        "metres at best": metrics.shortest_path_m,
        "SPL": metrics.spl,
    }
