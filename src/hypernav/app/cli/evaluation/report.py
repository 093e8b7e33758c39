"""The command `hypernav report`: one page about a run, or about several runs side by side."""

from rich.box import SIMPLE
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from hypernav.app.cli.guards.crashes import ExitStatus
from hypernav.app.cli.guards.outputs import check_folder
from hypernav.app.cli.options.commands import ReportOptions
from hypernav.app.cli.screen.terminal import Terminal
from hypernav.core.errors import ConfigError
from hypernav.io.writing import own_folder
from hypernav.lab.evaluation.report import tables
from hypernav.lab.evaluation.report.published_results import BesidePaper, beside_paper
from hypernav.lab.evaluation.report.report_page import REPORT_FILES, write_report
from hypernav.lab.evaluation.report.report_text import interval, lead, verdict
from hypernav.lab.evaluation.report.run_data import load_runs
from hypernav.lab.evaluation.statistics import Estimate


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
    return f"{100.0 * estimate.mean:.1f}{interval(estimate, 100.0, ' ({}–{})', 0)}"


def run(options: ReportOptions) -> int:
    """Run the command.

    Returns:
        The status of success.
    """
    if not options.runs:
        raise ConfigError("name at least one folder of an evaluation")
    if options.compare and len(options.runs) < 2:
        raise ConfigError("--compare needs at least two folders")
    out, several = options.out, len(options.runs) > 1
    if out is not None:
        check_folder(out, REPORT_FILES)
    runs = load_runs(options.runs)
    if out is None:
        out = own_folder(options.runs[0], "compared") if several else options.runs[0]
        check_folder(out, REPORT_FILES)
    pairs = tables.pairs(runs) if options.compare else []
    page = write_report(out, runs, pairs=pairs, published=options.published)
    console = Terminal(quiet=options.quiet)
    for run in runs if options.published else ():
        show_beside_paper(run.name, beside_paper(run), console)
    if several:
        console.print(escape(lead(runs, tables.overall(runs))), soft_wrap=True)
    for pair in pairs:
        console.print(escape(verdict(pair)), soft_wrap=True)
    console.print(f"open {page}", soft_wrap=True)
    return ExitStatus.SUCCESS
