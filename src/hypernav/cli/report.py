"""The command `hypernav report`: one page about a run, or about several runs side by side."""

from hypernav.cli.guards.outputs import check_folder
from hypernav.cli.guards.statuses import ExitStatus
from hypernav.cli.options.report import Options
from hypernav.cli.screen.paper_table import show_beside_paper
from hypernav.cli.screen.terminal import Terminal
from hypernav.core.errors import ConfigError
from hypernav.evaluation.report.published_results import beside_paper
from hypernav.evaluation.report.report_page import REPORT_FILES, write_report
from hypernav.evaluation.report.run_data import load_runs


def run(options: Options) -> int:
    """Run the command.

    Returns:
        The status of success.
    """
    if not options.runs:
        raise ConfigError("name at least one folder of an evaluation")
    if options.compare and len(options.runs) < 2:
        raise ConfigError("--compare needs at least two folders")
    several = len(options.runs) > 1
    out = options.out or (options.runs[0] / "compared" if several else options.runs[0])
    check_folder(out, REPORT_FILES)
    runs = load_runs(options.runs)
    page = write_report(out, runs, compare=options.compare, published=options.published)
    console = Terminal(quiet=options.quiet)
    for run in runs if options.published else ():
        show_beside_paper(run.name, beside_paper(run), console)
    console.print(f"open {page}", soft_wrap=True)
    return ExitStatus.SUCCESS
