"""`hypernav report`: one page about a run, or about several side by side."""

from dataclasses import dataclass
from pathlib import Path

import tyro
from rich.console import Console

from hypernav.core.errors import ConfigError
from hypernav.evaluation.report.page import write_report
from hypernav.evaluation.report.run_data import load_runs


@dataclass(frozen=True)
class Report:
    """Write a page, a CSV file and LaTeX tables about one or more evaluations."""

    runs: tyro.conf.Positional[tuple[Path, ...]]
    """Folders that hypernav eval wrote; the first is what others are compared with."""
    compare: bool = False
    """Compare every run with the first one, episode by episode."""
    out: Path | None = None
    """Folder for the report; by default that of the only run, or the first run's compared/."""
    quiet: bool = False
    """Say nothing but errors."""

    def run(self) -> int:
        """Run the command.

        Returns:
            0.
        """
        if not self.runs:
            raise ConfigError("name at least one folder of an evaluation")
        if self.compare and len(self.runs) < 2:
            raise ConfigError("--compare needs at least two folders")
        several = len(self.runs) > 1
        out = self.out or (self.runs[0] / "compared" if several else self.runs[0])
        page = write_report(out, load_runs(self.runs), compare=self.compare)
        console = Console(stderr=True, quiet=self.quiet, highlight=False)
        console.print(f"open {page}", soft_wrap=True)
        return 0
