"""The report of one or more runs: a page, a CSV file and LaTeX tables."""

from hypernav.evaluation.report.page import write_report
from hypernav.evaluation.report.run_data import RunData, load_runs

__all__ = ["RunData", "load_runs", "write_report"]
