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
    """One line for every variant: means, differences from the unchanged method, failures.

    An unfinished variant has no means: they would be of other episodes.
    """
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(
            [
                *("variant", "changes", "quality", "done", "episodes"),
                *(name + part for name in _MEANS for part in _PARTS),
                "paired_episodes",
                *(f"{name}_difference{part}" for name in _MEANS for part in (*_PARTS, "_p")),
                *(f"{name}_difference_corrected_p" for name in ("success", "spl")),
                *(failure.value for failure in Failure),
            ]
        )
        for result in results.all:
            variant, summary, pair = result.variant, result.summary, result.pair
            counts = failure_counts(result.run.records)
            means = (summary.success, summary.spl, summary.steps)
            corrected = result.corrected
            gaps = () if pair is None else (pair.success, pair.spl, pair.steps)
            writer.writerow(
                [
                    *(variant.name, variant.changes),
                    "" if variant.quality is None else variant.quality,
                    f"{len(result.run.records)} of {result.run.wanted} episodes",
                    summary.success.count,
                    *(_estimates(*means) if result.is_whole else [""] * 9),
                    "" if pair is None else pair.count,
                    *([""] * 12 if pair is None else _comparisons(*gaps)),
                    "" if corrected is None else f"{corrected.success:.4f}",
                    "" if corrected is None else f"{corrected.spl:.4f}",
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
        summary, pair, corrected = result.summary, result.pair, result.corrected
        cells = [
            tex(result.label),
            with_interval(summary.success, 100.0, 1) if result.is_whole else "--",
            with_interval(summary.spl, 1.0, 3) if result.is_whole else "--",
        ]
        if pair is not None and corrected is not None:
            for gap, p_value, factor, digits in (
                (pair.success, corrected.success, 100.0, 1),
                (pair.spl, corrected.spl, 1.0, 3),
            ):
                told = report_text.p_value(p_value).removeprefix("= ")
                cells += [f"${factor * gap.difference.mean:+.{digits}f}$", f"${told}$"]
        cells += ["--"] * (7 - len(cells))
        lines.append(" & ".join(cells) + r" \\")
    drawn = report_text.drawn(results.baseline.run)
    protocol = results.baseline.run.configuration["protocol"]
    lines += [
        r"\bottomrule",
        r"\end{tabular}",
        f"% {results.baseline.run.dataset}; STOP within {protocol['success_distance_m']:g} m "
        f"(geodesic) of a view point, at most {protocol['max_steps']} steps; brackets: 95% "
        f"bootstrap over {drawn}; differences: paired, on the episodes that both have; p by "
        f"flipping {drawn}, "
        f"corrected for the {results.comparisons} comparisons of this table (Holm)",
    ]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _estimates(*estimates: Estimate) -> list[str]:
    return [f"{x:.4f}" for one in estimates for x in (one.mean, one.low, one.high)]


def _comparisons(*gaps: Comparison) -> list[str]:
    return [x for gap in gaps for x in (*_estimates(gap.difference), f"{gap.p_value:.4f}")]
