"""Measure a table of the docs anew, or check by a part of its searches that it still holds.

    python scripts/measure_results.py exploring            # make results TABLE=exploring
    python scripts/measure_results.py --check              # make results-check

Each row's command runs in a folder of its own below ``runs/results/COMMIT``, where an interrupted
run goes on. Measuring writes values, commit, day and number of searches into the data file. A check
runs the episodes of `Row.check` anew and changes nothing. A value holds if the interval of its
difference includes 0 (`Check.holds`): a part is uncertain itself, and lies outside of the whole's
interval in every second case though nothing has changed.
"""

import argparse
import datetime
import hashlib
import math
import shlex
import shutil
import subprocess
import sys
from bisect import bisect
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import NormalDist

from result_tables import DATA, Cell, Column, Results, ResultsError, Row, Table, shown, to_toml

from hypernav.app.build.data.datasets import load_episodes
from hypernav.app.cli.evaluation.eval import folder_name
from hypernav.core.episode import Episode
from hypernav.core.errors import HyPerNavError
from hypernav.lab.evaluation.failures import Failure
from hypernav.lab.evaluation.record import EpisodeRecord
from hypernav.lab.evaluation.report import tables
from hypernav.lab.evaluation.report.run_data import RunData, load_runs
from hypernav.lab.evaluation.statistics import (
    FEWEST_WITH_INTERVAL,
    Estimate,
    mean_with_interval,
    ratio_with_interval,
)
from hypernav.simulator.houses.building import Building
from hypernav.simulator.houses.house_cache import cached_building

ROOT = Path(__file__).parents[1]
RUNS = ROOT / "runs" / "results"
_PROGRAMS = {"hypernav": (sys.executable, "-m", "hypernav"), "python": (sys.executable,)}
_ABOVE_FLOOR_M = 0.3
"""Height above a floor below which things that stand on it begin, metres."""
_WRONG = (Failure.FALSE_DETECTION, Failure.LANGUAGE)


def main(arguments: Sequence[str] | None = None, *, data: Path = DATA, runs: Path = RUNS) -> int:
    """Run the command.

    Args:
        arguments: Arguments of the command line; by default those of the process.
        data: Folder of the data files.
        runs: Folder of the runs.

    Returns:
        The exit status: 0 if all was measured, or if every checked value holds.
    """
    parser = argparse.ArgumentParser(description="Measure tables of the docs anew, or check them.")
    parser.add_argument(
        "tables", nargs="*", help="names of data files; with --check all by default"
    )
    parser.add_argument("--check", action="store_true", help="run a part, and change nothing")
    options = parser.parse_args(arguments)
    results = Results(data)
    names = options.tables or (results.names() if options.check else [])
    try:
        if options.check:
            checks = [one for name in names for one in checks_of(name, results.table(name), runs)]
            if not checks:
                raise ResultsError(f"{', '.join(names)}: no row has a check of five searches")
            print(*(one.line(len(checks)) for one in checks), sep="\n")
            held = sum(one.holds(len(checks)) for one in checks)
            print(f"{held} of {len(checks)} values hold")
            return 0 if held == len(checks) else 1
        if not names:
            raise ResultsError(f"name the tables to measure: {', '.join(results.names())}")
        for name in names:
            measured = measure(name, results.table(name), runs / commit_of_code())
            (data / f"{name}.toml").write_text(to_toml(measured), "utf-8")
    except HyPerNavError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


def commit_of_code() -> str:
    """The commit that is checked out, for what is measured now.

    Raises:
        ResultsError: Files differ from it, so that it would not say what was measured.
    """
    changed = _git("status", "--porcelain", "--", "src", "benchmarks", "pyproject.toml")
    if changed:
        raise ResultsError(f"a result names its commit; commit or stash first:\n{changed}")
    return _git("rev-parse", "--short=8", "HEAD")


def measure(name: str, table: Table, folder: Path) -> Table:
    """A table with the values of its repeatable rows as they are today.

    Args:
        name: Name of the table.
        table: The table.
        folder: Folder of the runs, named after the commit that is measured.

    Raises:
        ResultsError: A row or column can't be measured, or a command fails.
    """
    if not any(row.is_repeatable for row in table.rows):
        raise ResultsError(f"{name}: its commands give no run folder; its values are typed by hand")
    measures = ("", "n", *ESTIMATES, *COUNTS, *PAIRED)
    if unknown := [one.measure for one in table.columns if one.measure not in measures]:
        raise ResultsError(f"{name}: nothing measures {', '.join(unknown)}, only {measures[1:]}")
    runs = dict(_measured(table, [row for row in table.rows if row.is_repeatable], folder))
    commit = folder.name
    rows = [_with(row, table, runs, commit) if row.name in runs else row for row in table.rows]
    return table.model_copy(update={"rows": tuple(rows)})


@dataclass(frozen=True)
class Check:
    """A value of a row, beside that of some of its searches today.

    Attributes:
        name: Table, row and column.
        column: The column.
        then: Mean with the ends of its interval; all the same where the row has none.
        now: The value of today.
    """

    name: str
    column: Column
    then: Sequence[float]
    now: Estimate

    def holds(self, checks: int) -> bool:
        """Whether the interval of the difference includes 0.

        A share of all or none has an interval of no width; by the rule of three it is 3 in `n`.

        Args:
            checks: Number of values that are checked together. Their intervals are so much wider
                that all of them hold in 95 % of the cases where nothing has changed.
        """
        now, digits = self.now, self.column.digits
        factor, least = (100.0, 3.0 / now.count) if self.column.measure in _SHARES else (1.0, 0.0)
        mean, low, high = self.then
        is_above = factor * now.mean > mean
        then_half = high - mean if is_above else mean - low
        now_half = factor * max(now.mean - now.low if is_above else now.high - now.mean, least)
        wider = NormalDist().inv_cdf(1.0 - 0.025 / checks) / NormalDist().inv_cdf(0.975)
        allowed = wider * math.hypot(then_half, now_half) + 0.5 * 10**-digits
        return abs(factor * now.mean - mean) <= allowed

    def line(self, checks: int) -> str:
        """What the check found."""
        column, count = self.column, self.now.count
        then = shown(self.then[0] if len(set(self.then)) == 1 else [*self.then], column)
        now = shown(_cell(self.now, column), column)
        left = "" if self.holds(checks) else "  LEFT ITS INTERVAL"
        return f"{self.name}: {then}, {count} searches now {now}{left}"


def checks_of(name: str, table: Table, folder: Path) -> Iterator[Check]:
    """Run the searches by which the rows of a table are checked."""
    rows = {row.name: row for row in table.rows if row.check}
    part = [row.model_copy(update={"command": _tenth(row)}) for row in rows.values()]
    now = folder / "check" / name
    shutil.rmtree(now, ignore_errors=True)  # what is left there may be of other code
    for row_name, run in _measured(table, part, now):
        for column in table.columns:
            then = rows[row_name].cells.get(column.name)
            if column.measure in ESTIMATES and then is not None and not isinstance(then, str):
                estimate = ESTIMATES[column.measure](run)
                if estimate.count >= FEWEST_WITH_INTERVAL:
                    whole = then if isinstance(then, list) else [then] * 3
                    yield Check(f"{name}.{row_name}.{column.name}", column, whole, estimate)


def _git(*words: str) -> str:
    done = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True)
    if done.returncode:
        raise ResultsError(f"a result names its commit, but git says: {done.stderr.strip()}")
    return done.stdout.strip()


def _measured(table: Table, rows: Sequence[Row], folder: Path) -> Iterator[tuple[str, RunData]]:
    """The run of each row, or the part of it that the row is about; each command runs once."""
    done = dict[str, Path]()
    for row in rows:
        out = done.get(row.command) or _run(row.command, folder)
        done[row.command] = out
        (run,) = load_runs([out / row.variant])
        yield row.name, replace(run, records=_part_of(run, row.part))


def _run(command: str, folder: Path) -> Path:
    words = shlex.split(command.replace("\\\n", " "))
    digest = hashlib.sha256(" ".join(words).encode()).hexdigest()[:8]
    out = folder / f"{folder_name(' '.join(words[1:3]))}-{digest}"
    print(f"{command}\n  in {out}", flush=True)
    if subprocess.run([*_PROGRAMS[words[0]], *words[1:], "--out", str(out)], cwd=ROOT).returncode:
        raise ResultsError(f"this command failed, see above: {command}")
    return out


def _tenth(row: Row) -> str:
    """The command of a row for the episodes of its check."""
    words = shlex.split(row.command.replace("\\\n", " "))
    if "--episodes" in words:
        del words[(at := words.index("--episodes")) : at + 2]
    return shlex.join([*words, "--episodes", row.check])


def _with(row: Row, table: Table, runs: dict[str, RunData], commit: str) -> Row:
    """A row with the values of its run."""
    run, other = runs[row.name], runs.get(row.against)
    cells = dict(row.cells)
    for column in table.columns:
        if column.measure in ESTIMATES:
            cells[column.name] = _cell(ESTIMATES[column.measure](run), column)
        elif column.measure in COUNTS:
            cells[column.name] = COUNTS[column.measure](run)
        elif column.measure in PAIRED and other is not None:
            cells[column.name] = _cell(PAIRED[column.measure](other, run), column)
    told = {"cells": cells, "n": len(run.counted), "commit": commit}
    return row.model_copy(update={**told, "date": datetime.date.today()})


def _cell(estimate: Estimate, column: Column) -> Cell:
    """An estimate in the units and with the digits of its column."""
    factor = 100.0 if column.measure in _SHARES else 1.0
    ends = (estimate.mean, estimate.low, estimate.high)
    mean, *interval = (round(factor * end, column.digits) for end in ends)
    return [mean, *interval] if column.interval and estimate.has_interval else mean


def _part_of(run: RunData, part: str) -> list[EpisodeRecord]:
    if part == "":
        return run.records
    if part == "later":
        return [record for record in run.records if record.goal_number > 1]
    where = {(one.scene_id, one.episode_id): direction(one) for one in load_episodes(run.dataset)}
    wanted = ("above", "below") if part == "other" else (part,)
    return [record for record in run.records if where[record.key] in wanted]


def direction(episode: Episode) -> str:
    """Where the goal of a search in a generated building is, seen from its start."""
    scene = cached_building(Building("storeys", int(episode.scene_id.split(":")[1])))
    goal_z = next(
        one.box_min[2]
        for one in scene.instances
        if one.label is not None and one.label.satisfies(episode.goal)
    )
    start, goal = (
        bisect(scene.storeys, z + _ABOVE_FLOOR_M) for z in (episode.start_z or 0.0, goal_z)
    )
    return "same" if goal == start else "above" if goal > start else "below"


def _mean_of(value: Callable[[EpisodeRecord], float]) -> Callable[[RunData], Estimate]:
    def estimate(run: RunData) -> Estimate:
        return mean_with_interval(
            [value(record) for record in run.counted],
            [record.scene_id for record in run.counted],
        )

    return estimate


_SHARES = ("success", "unseen", "success_difference")
"""Measures that are shares, and are shown in per cent."""

ESTIMATES: dict[str, Callable[[RunData], Estimate]] = {
    "success": _mean_of(lambda record: record.success),
    "spl": _mean_of(lambda record: record.spl),
    "soft_spl": _mean_of(lambda record: record.soft_spl),
    "steps": _mean_of(lambda record: record.steps),
    "calls": _mean_of(lambda record: record.model_calls),
    "calls_with_boxes": _mean_of(lambda record: record.model_calls + record.steps),
    "explored": lambda run: tables.metres([run])[0].explored,
    "approached": lambda run: tables.metres([run])[0].approached,
    "unseen": lambda run: tables.metres([run])[0].unseen,
}
"""What a run's records give, as mean and interval over the buildings."""

COUNTS: dict[str, Callable[[RunData], Cell]] = {
    "found": lambda run: float(sum(record.success for record in run.counted)),
    "wrong_stops": lambda run: (
        f"{sum(record.failure in _WRONG for record in run.counted)} of "
        f"{sum(record.stopped for record in run.counted)}"
    ),
}
"""What is counted in a run's records."""

PAIRED: dict[str, Callable[[RunData, RunData], Estimate]] = {
    "success_difference": lambda first, second: tables.pair(first, second).success.difference,
    "spl_difference": lambda first, second: tables.pair(first, second).spl.difference,
    "steps_difference": lambda first, second: tables.pair(first, second).steps.difference,
    "spl_times": lambda first, second: _spl_times(first, second),
}
"""What a run's records give beside those of another run of the same episodes."""


def _spl_times(first: RunData, second: RunData) -> Estimate:
    """SPL of the second run over that of the first, on the episodes that count in both."""
    keys = [key for key in first.by_key if key in second.by_key]
    before, after = ([run.by_key[key].spl for key in keys] for run in (first, second))
    return ratio_with_interval(after, before, [scene for scene, _ in keys])


if __name__ == "__main__":
    sys.exit(main())
