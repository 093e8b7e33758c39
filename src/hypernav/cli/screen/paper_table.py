"""The table of `hypernav report --published`: a run beside the HyPerNav paper's rows."""

from rich.box import SIMPLE
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from hypernav.evaluation.report.published_results import BesidePaper
from hypernav.evaluation.statistics import Estimate


def show_beside_paper(name: str, beside: BesidePaper, console: Console) -> None:
    """Print the table, and below it what differs.

    Args:
        name: Name of the run.
        beside: The run beside the paper.
        console: Where to print it.
    """
    if beside.rows:
        console.print(_table(name, beside))
    else:
        console.print(f"{escape(name)}: the paper has no row that this run can be set beside")
    for difference in beside.differences:
        console.print(f"  {escape(difference)}", soft_wrap=True)


def _table(name: str, beside: BesidePaper) -> Table:
    title = f"{escape(name)} beside the HyPerNav paper; shares in percent, intervals of 95 %"
    table = Table(box=SIMPLE, pad_edge=False, collapse_padding=True, title=title)
    table.add_column("row of the paper", no_wrap=True)
    for title in ("SR", "SPL", "run: SR", "run: SPL", "of"):
        table.add_column(title, justify="right", no_wrap=True)
    for row in beside.rows:
        table.add_row(
            row.name,
            f"{row.paper.success_percent:.1f}",
            f"{row.paper.spl_percent:.1f}",
            _said(row.success),
            _said(row.spl),
            str(row.episodes),
        )
    return table


def _said(estimate: Estimate | None) -> str:
    """A share in percent with its interval, which a few episodes don't have."""
    if estimate is None:
        return "–"
    mean, low, high = (100.0 * value for value in (estimate.mean, estimate.low, estimate.high))
    return f"{mean:.1f}" + (f" ({low:.0f}–{high:.0f})" if estimate.has_interval else "")
