"""The page of a study: what each part of the method is worth, as a figure and in tables.

Beside the page there are tables with a line for every variant, as CSV and as LaTeX.
"""

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from hypernav.app.show.templating import page_environment
from hypernav.core.errors import OutputError
from hypernav.core.naming.words import number_of
from hypernav.io.writing import csv_file, write_whole
from hypernav.lab.evaluation.ablation.figures import drawn_axes, results_figure, write_figure
from hypernav.lab.evaluation.ablation.study import (
    LeftOut,
    Study,
    StudyResults,
    VariantResult,
    read_results,
)
from hypernav.lab.evaluation.failures import Failure
from hypernav.lab.evaluation.report import report_text, tables
from hypernav.lab.evaluation.report.report_page import tex, with_interval
from hypernav.lab.evaluation.statistics import Comparison, Estimate, ends, failure_counts

_MEANS = ("success", "spl", "steps")
_PARTS = ("", "_low", "_high")


def write_csv(path: Path, results: StudyResults) -> None:
    """One line for every variant: means, differences from the unchanged method, failures.

    An unfinished variant has no means: they would be of other episodes.
    """
    with csv_file(path) as file:
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
    write_whole(path, "\n".join(lines) + "\n")


def _estimates(*estimates: Estimate) -> list[str]:
    return [x for one in estimates for x in (f"{one.mean:.4f}", *ends(one))]


def _comparisons(*gaps: Comparison) -> list[str]:
    return [x for gap in gaps for x in (*_estimates(gap.difference), f"{gap.p_value:.4f}")]


PAGE = "index.html"

_MOST_NAMED = 5


def write_ablation(folder: Path, study: Study) -> Path | None:
    """Write the page, the figure, ``ablation.csv`` and ``ablation.tex`` of the results so far.

    Returns:
        Path of the page, which is one file and needs no network; None as long as no episode of the
        unchanged method is done.

    Raises:
        OutputError: The folder can't be written.
        RunFolderError: A folder is damaged.
    """
    results = read_results(folder, study)
    if results is None:
        return None
    page = page_environment("hypernav.lab.evaluation").get_template("ablation.html.j2")
    try:
        write_csv(folder / "ablation.csv", results)
        write_tex(folder / "ablation.tex", results)
        text = page.render(**_content(results), figure=_figure(folder, results))
        write_whole(folder / PAGE, text)
    except OSError as error:
        raise OutputError(f"{folder} cannot be written ({error.strerror or error})") from error
    return folder / PAGE


def _figure(folder: Path, results: StudyResults) -> str:
    """The figure, written and as a data URI; empty as long as there is nothing to draw."""
    return write_figure(folder, lambda: results_figure(results)) if results.variants else ""


def _content(results: StudyResults) -> dict[str, Any]:
    shown = results.all if results.study.axes else (results.baseline, *results.worst_first)
    return {
        "title": results.study.title,
        "study": results.study,
        "baseline": results.baseline,
        "results": shown,
        "lead": _lead(results),
        "verdicts": _verdicts(results),
        "figure_title": (
            "Over the quality" if drawn_axes(results) else "What each variant changes, worst first"
        ),
        "drawn": report_text.drawn(results.baseline.run),
        "warnings": _warnings(results),
        "failures": tables.failures([result.run for result in shown]),
        "left_out": _by_reason(results.study.left_out),
        "protocol": report_text.protocol_lines(results.baseline.run),
        "report_text": report_text,
    }


def _lead(results: StudyResults) -> str:
    run, summary = results.baseline.run, results.baseline.summary
    done = "" if results.baseline.is_whole else f" in the {len(run.records):,} that are done,"
    return (
        f"{number_of(len(results.variants), 'variant')} of the preset "
        f"{run.who['preset']} searched for the same goals as the unchanged method, in "
        f"{number_of(run.wanted, 'episode')} of {run.dataset}. Unchanged,{done} it "
        f"finds {report_text.percent(summary.success)}"
        f"{report_text.interval(summary.success, 100.0, ' ({} to {} %)')} of its goals with an "
        f"SPL of {summary.spl.mean:.3f}{report_text.interval(summary.spl)}."
    )


def _verdicts(results: StudyResults) -> list[str]:
    """Sentences about SPL: which variants lose, which gain, and which show no difference."""
    lost, gained, others = [], [], 0
    for result in results.worst_first:
        assert result.pair is not None
        assert result.corrected is not None
        gap = result.pair.spl
        if not result.corrected.spl < report_text.SIGNIFICANT:
            others += 1
            continue
        told = f"“{result.variant.name}” ({gap.difference.mean:+.3f})"
        (gained if gap.difference.mean > 0.0 else lost).append(told)
    sentences = []
    if lost:
        sentences.append(f"SPL falls with {_first_of(lost)}.")
    if gained:
        sentences.append(f"SPL rises with {_first_of(gained[::-1])}.")
    if others and (lost or gained):
        sentences.append(
            f"For the other{f' {others}' if others > 1 else ''} no difference in SPL is shown."
        )
    elif others:
        sentences.append("No difference in SPL is shown for any variant.")
    if results.variants:
        sentences.append(
            f"All p-values are corrected for the {results.comparisons} comparisons of this page "
            "(Holm's method)."
        )
    return sentences


def _warnings(results: StudyResults) -> list[str]:
    found = report_text.warnings([results.baseline.run])
    run = results.baseline.run
    unit = report_text.drawn(run).removesuffix("s")
    scenes = len({record.scene_id for record in run.counted})
    count = scenes if unit == "scene" else len(run.counted)
    least = min(results.comparisons * 2.0 ** (1 - count), 1.0)
    if least >= report_text.SIGNIFICANT:
        found.append(
            f"With {number_of(count, unit)} and {results.comparisons} comparisons no "
            f"corrected p-value can be below {least:g}: more {unit}s, or fewer variants (--only), "
            "are needed to show a difference."
        )
    short = [one.label for one in results.variants if not one.is_whole]
    if short:
        found.append(f"Not finished: {_listed(short)}. Only episodes that both have are compared.")
    if results.waiting:
        names = [variant.name for variant in results.waiting]
        found.append(f"Without results so far: {_listed(names)}.")
    apart = [one for one in results.variants if len(one.run.counted) < len(one.run.records)]
    if apart:
        found.append(f"Outages, which are in no rates, ended episodes of {_listed(_names(apart))}.")
    return found


def _names(results: Sequence[VariantResult]) -> list[str]:
    return [result.variant.name for result in results]


def _by_reason(left_out: Sequence[LeftOut]) -> dict[str, list[str]]:
    reasons: dict[str, list[str]] = {}
    for one in left_out:
        reasons.setdefault(one.why, []).append(one.variant.name)
    return reasons


def _first_of(names: Sequence[str]) -> str:
    rest = len(names) - _MOST_NAMED
    return _listed([*names[:_MOST_NAMED], f"{rest} more"] if rest > 1 else names)


def _listed(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
