"""The command `hypernav robot report`: the table of a field study."""

import csv
from collections.abc import Sequence
from pathlib import Path

from rich.box import SIMPLE
from rich.table import Table

from hypernav.app.cli.guards.crashes import ExitStatus
from hypernav.app.cli.guards.outputs import check_file
from hypernav.app.cli.robot import Report
from hypernav.app.cli.screen.terminal import Terminal
from hypernav.core.errors import ConfigError, OutputError, RunFolderError
from hypernav.lab.evaluation.field_study import StudyRow, TrialResult, study_rows
from hypernav.lab.evaluation.statistics import ends, interval
from hypernav.robot.field_trial import FieldTrial, read_trial

_COLUMNS = (
    *("goal", "method", "trials", "found", "success", "spl", "spl_low", "spl_high"),
    *("driven_m", "shortest_m"),
)


def run(options: Report) -> int:
    """Run the command.

    Returns:
        The status of success.

    Raises:
        RunFolderError: A folder holds no finished trial.
        OutputError: The CSV file cannot be written.
    """
    if not options.searches:
        raise ConfigError("name at least one folder of a finished search")
    if options.csv is not None:
        check_file(options.csv)
    trials = [read_trial(folder) for folder in options.searches]
    counted = [trial for trial in trials if trial.counts]
    if not counted:
        raise RunFolderError("every trial ended by an outage, so there is nothing to report")
    rows = study_rows([_result(trial) for trial in counted])
    console = Terminal(stderr=False, quiet=options.quiet)
    console.print(_table(rows))
    if len(counted) < len(trials):
        console.print(
            f"{len(trials) - len(counted)} trials ended by an outage and count in no rate",
            markup=False,
        )
    if options.csv is not None:
        _write_csv(options.csv, rows)
    return ExitStatus.SUCCESS


def _result(trial: FieldTrial) -> TrialResult:
    metrics = trial.metrics
    return TrialResult(
        goal=trial.goal,
        method=trial.method,
        success=metrics.success,
        spl=metrics.spl,
        length_m=metrics.path_length_m,
        shortest_m=metrics.shortest_path_m,
    )


def _table(rows: Sequence[StudyRow]) -> Table:
    table = Table(box=SIMPLE, pad_edge=False, collapse_padding=True)
    for name in ("goal", "method"):
        table.add_column(name, overflow="fold")
    for name in ("found", "SR", "SPL", "95 % interval", "driven", "shortest"):
        table.add_column(name, justify="right", no_wrap=True)
    previous = rows[0].goal
    for row in rows:
        if row.goal != previous:
            table.add_section()
        previous = row.goal
        table.add_row(
            row.goal,
            row.method,
            f"{row.found} of {row.count}",
            f"{100 * row.success.mean:.1f} %",
            f"{row.spl.mean:.3f}",
            interval(row.spl, words="{} to {}"),
            f"{row.length_m:.1f} m",
            f"{row.shortest_m:.1f} m",
        )
    return table


def _write_csv(path: Path, rows: Sequence[StudyRow]) -> None:
    try:
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(_COLUMNS)
            for row in rows:
                means = [f"{one.mean:.4f}" for one in (row.success, row.spl)]
                lengths = [f"{one:.4f}" for one in (row.length_m, row.shortest_m)]
                writer.writerow(
                    [row.goal, row.method, row.count, row.found, *means, *ends(row.spl), *lengths]
                )
    except OSError as error:
        raise OutputError(f"{path} cannot be written ({error.strerror})") from error
