"""Tables beside the page of a study: a line for every variant, as CSV and as LaTeX."""

import csv
from pathlib import Path

from hypernav.evaluation.ablation.results import StudyResults
from hypernav.evaluation.failures.classification import Failure
from hypernav.evaluation.report import report_text
from hypernav.evaluation.report.table_files import tex, with_interval
from hypernav.evaluation.statistics import Comparison, Estimate
from hypernav.evaluation.summary import failure_counts

_MEANS = ("success", "spl", "steps")
_PARTS = ("", "_low", "_high")


def write_csv(path: Path, results: StudyResults) -> None:
    """One line for every variant: means, differences from the unchanged method, failures."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(
            [
                *("variant", "changes", "quality", "episodes"),
                *(name + part for name in _MEANS for part in _PARTS),
                "paired_episodes",
                *(f"{name}_difference{part}" for name in _MEANS for part in (*_PARTS, "_p")),
                *(failure.value for failure in Failure),
            ]
        )
        for result in results.all:
            variant, summary, pair = result.variant, result.summary, result.pair
            counts = failure_counts(result.run.records)
            gaps = () if pair is None else (pair.success, pair.spl, pair.steps)
            writer.writerow(
                [
                    *(variant.name, variant.changes),
                    *("" if variant.quality is None else variant.quality, summary.success.count),
                    *_estimates(summary.success, summary.spl, summary.steps),
                    "" if pair is None else pair.count,
                    *([""] * 12 if pair is None else _comparisons(*gaps)),
                    *(counts.get(failure, 0) for failure in Failure),
                ]
            )


def write_tex(path: Path, results: StudyResults) -> None:
    """A table for a paper: means with intervals, and differences with p-values."""
    lines = [
        r"\begin{tabular}{lcccccc}",
        r"\toprule",
        r"Variant & SR (\%) & SPL & $\Delta$SR & $p$ & $\Delta$SPL & $p$ \\",
        r"\midrule",
    ]
    for result in results.all:
        summary, pair = result.summary, result.pair
        cells = [
            tex(result.variant.name),
            with_interval(summary.success, 100.0, 1),
            with_interval(summary.spl, 1.0, 3),
        ]
        for gap, factor, digits in (
            () if pair is None else ((pair.success, 100.0, 1), (pair.spl, 1.0, 3))
        ):
            p_value = report_text.p_value(gap.p_value).removeprefix("= ")
            cells += [f"${factor * gap.difference.mean:+.{digits}f}$", f"${p_value}$"]
        cells += ["--"] * (7 - len(cells))
        lines.append(" & ".join(cells) + r" \\")
    told = results.baseline.run.configuration["protocol"]
    lines += [
        r"\bottomrule",
        r"\end{tabular}",
        f"% {results.baseline.run.dataset}; STOP within {told['success_distance_m']:g} m "
        f"(geodesic) of a view point, at most {told['max_steps']} steps; brackets: 95% bootstrap "
        "over scenes; differences: paired, p by flipping scenes",
    ]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _estimates(*estimates: Estimate) -> list[str]:
    return [f"{x:.4f}" for one in estimates for x in (one.mean, one.low, one.high)]


def _comparisons(*gaps: Comparison) -> list[str]:
    return [x for gap in gaps for x in (*_estimates(gap.difference), f"{gap.p_value:.4f}")]
