"""The page of the study of goal refinement, and its files."""

import csv
from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import TYPE_CHECKING

from hypernav.app.show.templating import page_environment
from hypernav.core.errors import OutputError
from hypernav.core.naming.words import number_of
from hypernav.io.writing import csv_file, write_whole
from hypernav.lab.datasets.paper_results import REFINEMENT_DROPS_PERCENT
from hypernav.lab.evaluation.ablation.ablation_page import PAGE
from hypernav.lab.evaluation.ablation.figures import write_figure
from hypernav.lab.evaluation.refinement.area_record import AreaRecord, MaskSource
from hypernav.lab.evaluation.refinement.boxes import JITTER_SHARE, MATCHING_IOU
from hypernav.lab.evaluation.refinement.goal_position import GoalPosition
from hypernav.lab.evaluation.refinement.summary import MEASURES, Measure, Row, drawn_in, table
from hypernav.lab.evaluation.report import report_text
from hypernav.lab.evaluation.statistics import FEWEST_WITH_INTERVAL
from hypernav.search.drawing import palette

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CSV = "refinement.csv"


def write_refinement(folder: Path, records: Sequence[AreaRecord], *, lead: str) -> Path:
    """Write the page, the figure and ``refinement.csv``.

    Returns:
        Path of the page, which is one file and needs no network.

    Raises:
        OutputError: The folder can't be written.
    """
    rows = table(records)
    page = page_environment("hypernav.lab.evaluation").get_template("refinement.html.j2")
    try:
        text = page.render(
            title="Goal refinement",
            lead=lead,
            verdicts=(),
            warnings=(),
            rows=rows,
            report_text=report_text,
            measures=MEASURES,
            drawn=drawn_in(rows),
            figure=write_figure(folder, lambda: shares_figure(rows)) if rows else "",
            figure_title="What becomes of a box",
            jitter=JITTER_SHARE,
            iou=MATCHING_IOU,
            paper=REFINEMENT_DROPS_PERCENT,
        )
        write_whole(folder / PAGE, text)
        _write_csv(folder / CSV, records)
    except OSError as error:
        raise OutputError(f"{folder} cannot be written ({error.strerror or error})") from error
    return folder / PAGE


def result_lines(records: Sequence[AreaRecord]) -> list[str]:
    """The table in lines of text, for the terminal, or a line that says that it is empty."""
    lines = [_line(row) for row in table(records)]
    return lines or ["nothing was measured: no episode showed its goal within the range of depth"]


def _line(row: Row) -> str:
    told = ", ".join(f"{name} {_said(measure)}" for name, measure in row.measures.items())
    return f"{row.box.value} box, {row.mask.value}: {told} ({number_of(row.episodes, 'episode')})"


def _said(measure: Measure) -> str:
    drop = "" if measure.drop is None else f" (drop {100 * measure.drop.mean:.0f} %)"
    return f"{100 * measure.share.mean:.1f} %{drop}"


def _write_csv(path: Path, records: Sequence[AreaRecord]) -> None:
    with csv_file(path) as file:
        positions = [field.name for field in fields(GoalPosition)]
        own = [field.name for field in fields(AreaRecord) if field.name != "position"]
        writer = csv.DictWriter(file, [*own, *positions])
        writer.writeheader()
        for record in records:
            row = asdict(record)
            writer.writerow(row | (row.pop("position") or dict.fromkeys(positions, "")))


def shares_figure(rows: Sequence[Row]) -> "Figure":
    """A panel for each measure, with the shares of every kind of box and area."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12.0, 1.2 + 0.27 * len(rows)), layout="constrained")
    panels = figure.subplots(1, len(MEASURES), sharey=True)
    for axes, name in zip(panels, MEASURES, strict=True):
        axes.grid(color=palette.css(palette.FAINT), linewidth=0.6)
        axes.set_axisbelow(True)
        axes.tick_params(axis="y", length=0)
        axes.set_title(name, fontsize=10)
        axes.set_xlim(-3.0, 103.0)
        axes.set_xlabel("%")
        for place, row in enumerate(rows):
            share = row.measures[name].share
            is_raw = row.mask is MaskSource.RAW
            color = palette.css(palette.FAILURE if is_raw else palette.EXCLUDED)
            ends = [100.0 * end for end in share.drawn_ends]
            axes.plot(ends, [place, place], color=color, linewidth=2.2)
            axes.plot([100.0 * share.mean], [place], "o", color=color, markersize=5.5)
    panels[0].set_yticks(
        range(len(rows)), [f"{row.box.value} box: {row.mask.value}" for row in rows]
    )
    panels[0].set_ylim(len(rows) - 0.5, -0.5)
    figure.suptitle(
        f"Shares with 95 % intervals over {drawn_in(rows)} "
        f"from {FEWEST_WITH_INTERVAL} on; less is better",
        fontsize=10,
    )
    return figure
