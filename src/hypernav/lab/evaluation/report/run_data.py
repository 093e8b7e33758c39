"""The results of a run, read back from its folder, and the cost of its episodes."""

import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from hypernav.app.show.captions import ITS_OWN
from hypernav.app.show.templating import html_table
from hypernav.core.components.registry import require
from hypernav.core.embodiment import Embodiment
from hypernav.core.errors import RunFolderError
from hypernav.lab.datasets.benchmarks import Benchmark, benchmark_of
from hypernav.lab.evaluation.protocol import StopRule
from hypernav.lab.evaluation.record import Count, EpisodeKey, EpisodeRecord
from hypernav.lab.evaluation.statistics import counted
from hypernav.lab.evaluation.store.run_store import (
    Session,
    read_configuration,
    read_records,
    read_sessions,
)
from hypernav.simulator.worlds.config import NoiseConfig

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True)
class RunData:
    """Results of one run.

    Attributes:
        folder: Folder of the run.
        name: Short name, unique among the runs of a report.
        configuration: Content of ``run.json``.
        records: Records of all finished episodes, in the order of scenes and episodes.
        sessions: Entries of ``sessions.jsonl``.
    """

    folder: Path
    name: str
    configuration: dict[str, Any] = field(repr=False)
    records: list[EpisodeRecord] = field(repr=False)
    sessions: list[Session] = field(repr=False)

    @property
    def counted(self) -> list[EpisodeRecord]:
        """Episodes that count in the rates; outages do not."""
        return counted(self.records)

    @property
    def by_key(self) -> dict[EpisodeKey, EpisodeRecord]:
        """The counted episodes by scene and id."""
        return {record.key: record for record in self.counted}

    @property
    def who(self) -> dict[str, Any]:
        """Agent, preset and components, by name."""
        return self.configuration["who"]

    @property
    def dataset(self) -> str:
        """Name of the data set."""
        return self.configuration["dataset"]

    @property
    def wanted(self) -> int:
        """Number of episodes of the complete run."""
        return self.configuration["episodes"]["count"]

    @property
    def is_told_truth(self) -> bool:
        """Whether the simulator told the robot what it sees."""
        parts = self.who.get("parts", {})
        asks_to_stop = self.is_native and parts.get("detector") == "none"
        told = asks_to_stop and parts.get("vlm") is None
        return told or str(parts.get("detector", "")) == "ground-truth"

    @property
    def is_native(self) -> bool:
        """Whether the method used its own camera, step and stop, not the common ones."""
        return is_native(self.configuration)

    @property
    def benchmark(self) -> Benchmark | None:
        """The published benchmark that the run follows, if any."""
        return benchmark_of(self.dataset, self.configuration.get("benchmark"))

    @property
    def errs_as_released(self) -> bool:
        """Whether the method made the mistakes of its released code."""
        return str(self.who["preset"]).endswith("-as-released")


class _Part(BaseModel):
    """What reports read of a part of a run's configuration; the rest may be anything."""

    model_config = ConfigDict(frozen=True, allow_inf_nan=False, extra="allow")


class _Episodes(_Part):
    count: Count
    scenes: Count
    fingerprint: str


class _Who(_Part):
    agent: str
    preset: str
    detector: str
    reasoner: str
    parts: dict[str, Any] = Field(default_factory=dict)


class _Protocol(_Part):
    max_steps: Count
    success_distance_m: float
    stop_rule: StopRule
    seed: int


class _Lives(_Part):
    count: Count
    memory: str
    max_steps: Count | None


class _GoalTypes(_Part):
    left_out: dict[str, Count] = Field(default_factory=dict)


class _World(_Part):
    sliding: bool
    noise: NoiseConfig


class _Config(_Part):
    embodiment: Embodiment
    world: _World


class _Configuration(_Part):
    hypernav: str
    dataset: str
    selection: dict[str, Any]
    episodes: _Episodes
    who: _Who
    protocol: _Protocol
    config: _Config
    benchmark: str | None = None
    lives: _Lives | None = None
    goal_types: _GoalTypes = _GoalTypes()


def is_native(configuration: dict[str, Any]) -> bool:
    """Whether the configuration of a run is of native mode."""
    return configuration["who"].get("parts", {}).get("mode") == "native"


class Runs(list[RunData]):
    """Runs of a report. In a notebook they show themselves as a table."""

    def save(self, folder: str | Path) -> Path:
        """Write a report like ``hypernav report``; it compares the runs if there are several.

        Returns:
            Its page.

        Raises:
            RunFolderError: The runs share no episode, or the folder can't be written.
        """
        from hypernav.lab.evaluation.report import report_page, tables  # they import this

        return report_page.write_report(folder, self, pairs=tables.pairs(self))

    def to_pandas(self) -> "pandas.DataFrame":
        """A row for every episode of every run, with the fields of `EpisodeRecord`.

        The first column is the run; infinite lengths are ``inf``.

        Raises:
            MissingExtraError: pandas is not installed.
        """
        rows = [{"run": run.name, **one.as_row()} for run in self for one in run.records]
        return require("pandas", extra="notebook").DataFrame(rows)

    def _repr_html_(self) -> str:
        return html_table([{"run": run.name, **_rates(run.counted)} for run in self])


def _rates(counted: Sequence[EpisodeRecord]) -> dict[str, Any]:
    """Figures of episodes that count, of which there is at least one."""
    cost = _cost(counted)
    return {
        "episodes": len(counted),
        "success": cost.success,
        "SPL": cost.spl,
        "steps": cost.steps,
        "metres": cost.metres,
    }


def load_runs(folders: str | Path | Iterable[str | Path]) -> Runs:
    """Read runs.

    Args:
        folders: Folders that ``hypernav eval`` or `hypernav.evaluate` wrote, or a single one.

    Raises:
        RunFolderError: A folder is not that of a run, is damaged, of an older version, or holds
            no episode yet; or runs in native and in common mode are mixed.
    """
    single = isinstance(folders, str | Path)
    folders = [Path(folder) for folder in ([folders] if single else folders)]
    configurations = [_configuration(folder) for folder in folders]
    _check_modes(folders, configurations)
    runs = Runs()
    for folder, name, configuration in zip(
        folders, _names(folders, configurations), configurations, strict=True
    ):
        # Intervals depend on the order, so it must not depend on which worker was done first.
        records = sorted(read_records(folder), key=lambda record: record.key)
        if not any(record.counts for record in records):
            raise RunFolderError(f"{folder} holds no episode that counts yet; run it first")
        runs.append(RunData(folder, name, configuration, records, read_sessions(folder)))
    return runs


def _check_modes(folders: Sequence[Path], configurations: Sequence[dict[str, Any]]) -> None:
    """Refuse to compare robots of different kinds."""
    by_mode = {is_native(one): folder for folder, one in zip(folders, configurations, strict=True)}
    if len(by_mode) > 1:
        raise RunFolderError(
            f"{by_mode[True]} is of native mode and {by_mode[False]} of common mode: their robots, "
            "steps and stops differ, so a difference between them would mean nothing; "
            "make a report of each mode"
        )


def _configuration(folder: Path) -> dict[str, Any]:
    """The configuration of a run; one of an older version, or that somebody edited, is refused."""
    text = json.dumps(read_configuration(folder))
    try:
        return _Configuration.model_validate_json(text, strict=True).model_dump(mode="json")
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = ".".join(map(str, first["loc"]))
        raise RunFolderError(
            f"{folder} is of an older version of hypernav, or was edited: '{where}' of its "
            f"configuration cannot be read ({first['msg']}); make its report with that version, or "
            "run it again"
        ) from error


def _names(folders: Sequence[Path], configurations: Sequence[dict[str, Any]]) -> list[str]:
    """Shortest unique names of runs: agent with unusual preset, agent with preset, or folder."""
    agents = [str(c["who"]["agent"]) for c in configurations]
    presets = [f"{c['who']['agent']} ({c['who']['preset']})" for c in configurations]
    short = [
        agent if c["who"]["preset"] in ("default", ITS_OWN) else full
        for agent, full, c in zip(agents, presets, configurations, strict=True)
    ]
    for names in (short, presets, [folder.name for folder in folders]):
        if len(set(names)) == len(names):
            return names
    return [str(folder) for folder in folders]


_TICKS = (0, 1, 3, 10, 30, 100, 300, 1000, 3000, 10_000)


@dataclass(frozen=True)
class CostRow:
    """Cost of an episode of a run, on average over its counted episodes.

    Attributes:
        metres: Path that the robot drove, metres.
        steps: Number of actions.
        seconds: Wall-clock time, simulation included, seconds.
        calls: Number of questions that a chat model answered.
        tokens: Number of tokens that it read and wrote.
        success: Success rate, 0 to 1.
        spl: Mean SPL, 0 to 1.
    """

    metres: float
    steps: float
    seconds: float
    calls: float
    tokens: float
    success: float
    spl: float


@dataclass(frozen=True)
class CallAxis:
    """An axis for the number of calls per episode, from 0 to thousands.

    Attributes:
        ticks: Numbers of calls with their positions on the axis, 0 to 1.
        places: Positions of the runs on the axis, in the order of the runs.
    """

    ticks: tuple[tuple[int, float], ...]
    places: tuple[float, ...]


def costs(runs: Sequence[RunData]) -> list[CostRow]:
    """Cost of an episode in every run."""
    return [_cost(run.counted) for run in runs]


def call_axis(rows: Sequence[CostRow]) -> CallAxis | None:
    """The axis on which the runs are drawn; None if no model was asked in any of them."""
    most = max(row.calls for row in rows)
    if most == 0.0:
        return None
    end = next((tick for tick in _TICKS if tick >= most), math.ceil(most))

    def place(calls: float) -> float:
        return math.log1p(calls) / math.log1p(end)

    ticks = tuple((tick, place(tick)) for tick in _TICKS if tick <= end)
    return CallAxis(ticks, tuple(place(row.calls) for row in rows))


def _cost(records: Sequence[EpisodeRecord]) -> CostRow:
    def mean(values: Sequence[float]) -> float:
        return sum(values) / len(values)

    return CostRow(
        metres=mean([one.path_length_m for one in records]),
        steps=mean([one.steps for one in records]),
        seconds=mean([one.seconds.get("total", 0.0) for one in records]),
        calls=mean([one.model_calls for one in records]),
        tokens=mean([one.tokens_in + one.tokens_out for one in records]),
        success=mean([float(one.success) for one in records]),
        spl=mean([one.spl for one in records]),
    )
