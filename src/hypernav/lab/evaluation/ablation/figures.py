"""The figures of studies: differences, or curves over a quality; matplotlib is imported to draw."""

import io
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hypernav.app.show.templating import data_uri
from hypernav.io.writing import write_whole
from hypernav.lab.evaluation.ablation.study import Axis, StudyResults, VariantResult
from hypernav.lab.evaluation.report import report_text
from hypernav.lab.evaluation.report.report_text import SIGNIFICANT, drawn
from hypernav.lab.evaluation.statistics import FEWEST_WITH_INTERVAL, Comparison, Estimate
from hypernav.search.drawing import palette

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_STYLES = ("--", ":", "-.")


def drawn_axes(results: StudyResults) -> tuple[Axis, ...]:
    """The axes with data: at least one variant on one of their curves is done."""
    curves = {result.variant.curve for result in results.all if result.is_whole}
    return tuple(axis for axis in results.study.axes if curves & set(axis.curves))


def quality_curves(results: StudyResults) -> "Figure":
    """A row for every axis with a curve, at least one: success on the left, SPL on the right.

    Unfinished variants are left out: their means are of other episodes.
    """
    from matplotlib.figure import Figure

    rows = drawn_axes(results)
    figure = Figure(figsize=(10.0, 0.4 + 3.7 * len(rows)), layout="constrained")
    panels = figure.subplots(len(rows), 2, squeeze=False)
    for axis, (left, right) in zip(rows, panels, strict=True):
        _panel(left, axis, results, is_success=True)
        _panel(right, axis, results, is_success=False)
        left.legend(fontsize=9, loc="lower right", edgecolor="none")
    figure.suptitle(
        "Goals found (SR) and how direct the paths to them were (SPL; 1 is the shortest path): "
        f"means with 95 % intervals over {report_text.drawn(results.baseline.run)}, "
        f"from {FEWEST_WITH_INTERVAL} on",
        fontsize=10,
    )
    return figure


def _panel(axes: "Axes", axis: Axis, results: StudyResults, *, is_success: bool) -> None:
    """One measure over one axis; always 0 to 1, so that no difference looks larger than it is."""
    factor = 100.0 if is_success else 1.0
    axes.grid(color=palette.css(palette.FAINT), linewidth=0.6)
    axes.set_axisbelow(True)
    axes.set_xlabel(axis.words)
    axes.set_ylabel("SR, %" if is_success else "SPL")
    axes.set_ylim(0.0, 1.03 * factor)
    if axis.ticks:
        axes.set_xticks(range(len(axis.ticks)), axis.ticks)
        axes.set_xlim(-0.3, len(axis.ticks) - 0.7)
    for place, name in enumerate(axis.lines):
        for result in results.all:
            if result.variant.name == name and result.is_whole:
                _line(axes, _measure(result, factor, is_success=is_success), name, place)
    curves = [curve for one in results.study.axes for curve in one.curves]
    for curve in axis.curves:
        points = [
            (result.variant.quality, _measure(result, factor, is_success=is_success))
            for result in results.all
            if result.is_whole
            and result.variant.curve == curve
            and result.variant.quality is not None
        ]
        if points:
            color = palette.SERIES[curves.index(curve) % len(palette.SERIES)]
            _curve(axes, sorted(points, key=lambda point: point[0]), color, curve)


def _measure(result: VariantResult, factor: float, *, is_success: bool) -> Estimate:
    estimate = result.summary.success if is_success else result.summary.spl
    low, high = estimate.drawn_ends
    return replace(estimate, mean=factor * estimate.mean, low=factor * low, high=factor * high)


def _line(axes: "Axes", estimate: Estimate, name: str, place: int) -> None:
    """A line across the panel, with its interval as a band."""
    color = palette.css(palette.SERIES[-1 - place])
    axes.axhspan(estimate.low, estimate.high, color=color, alpha=0.1, linewidth=0.0)
    style = _STYLES[place % len(_STYLES)]
    axes.axhline(estimate.mean, color=color, linestyle=style, linewidth=1.6, label=name)


def _curve(
    axes: "Axes", points: list[tuple[float, Estimate]], color: palette.Rgb, name: str
) -> None:
    axes.errorbar(
        [quality for quality, _ in points],
        [estimate.mean for _, estimate in points],
        yerr=[
            [estimate.mean - estimate.low for _, estimate in points],
            [estimate.high - estimate.mean for _, estimate in points],
        ],
        color=palette.css(color),
        marker="o",
        capsize=3.0,
        label=name,
    )


PNG, SVG = "figure.png", "figure.svg"

_STYLE: dict[Any, Any] = {
    "svg.hashsalt": "hypernav",  # so that the same results give the same bytes
    "font.family": "DejaVu Sans",
    "axes.edgecolor": palette.css(palette.FAINT),
    "axes.labelcolor": palette.css(palette.INK),
    "axes.spines.top": False,
    "axes.spines.right": False,
    "xtick.color": palette.css(palette.MUTED),
    "ytick.color": palette.css(palette.INK),
    "text.color": palette.css(palette.INK),
}


def write_figure(folder: Path, draw: Callable[[], "Figure"]) -> str:
    """Write ``figure.png`` and ``figure.svg`` of any study.

    Args:
        folder: Folder of the study.
        draw: Function that draws it, called in the style of all studies.

    Returns:
        The figure as a data URI.
    """
    import matplotlib

    with matplotlib.rc_context(_STYLE):
        figure = draw()
        pixels, drawing = io.BytesIO(), io.BytesIO()
        figure.savefig(pixels, format="png", dpi=160)
        figure.savefig(drawing, format="svg", metadata={"Date": None})
    write_whole(folder / PNG, pixels.getvalue())
    write_whole(folder / SVG, drawing.getvalue())
    return data_uri(drawing.getvalue(), "image/svg+xml")


def results_figure(results: StudyResults) -> "Figure":
    """The figure of variants: curves over a quality, or differences; there must be a variant."""
    return quality_curves(results) if drawn_axes(results) else _differences(results)


def _differences(results: StudyResults) -> "Figure":
    """Differences from the unchanged method, the greatest loss on top."""
    from matplotlib.figure import Figure

    rows = results.worst_first
    figure = Figure(figsize=(10.0, 1.5 + 0.27 * len(rows)), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    pairs = [row.pair for row in rows if row.pair is not None]
    p_values = [row.corrected for row in rows if row.corrected is not None]
    _whiskers(left, [pair.success for pair in pairs], [p.success for p in p_values], 100.0)
    _whiskers(right, [pair.spl for pair in pairs], [p.spl for p in p_values], 1.0)
    left.set_title("Success rate", fontsize=10)
    right.set_title("SPL", fontsize=10)
    unchanged = results.baseline.summary
    left.set_xlabel(f"SR, points from {100 * unchanged.success.mean:.1f} %\n← worse   better →")
    right.set_xlabel(f"SPL, from {unchanged.spl.mean:.3f}\n← worse   better →")
    left.set_yticks(range(len(rows)), [row.label for row in rows])
    left.set_ylim(len(rows) - 0.5, -0.5)
    figure.suptitle(
        "Each variant minus the unchanged method, with 95 % intervals over "
        f"{drawn(results.baseline.run)} from {FEWEST_WITH_INTERVAL} on; "
        f"coloured where corrected p < {SIGNIFICANT:g}",
        fontsize=10,
    )
    return figure


def _whiskers(
    axes: "Axes", comparisons: Sequence[Comparison], p_values: Sequence[float], factor: float
) -> None:
    axes.axvline(0.0, color=palette.css(palette.MUTED), linewidth=1.0)
    axes.grid(color=palette.css(palette.FAINT), linewidth=0.6)
    axes.set_axisbelow(True)
    axes.tick_params(axis="y", length=0)
    axes.locator_params(axis="x", nbins=6)
    for place, (comparison, p_value) in enumerate(zip(comparisons, p_values, strict=True)):
        gap = comparison.difference
        color = palette.css(_color(gap.mean, p_value))
        ends = [factor * end for end in gap.drawn_ends]
        axes.plot(ends, [place, place], color=color, linewidth=2.2)
        axes.plot([factor * gap.mean], [place], "o", color=color, markersize=5.5)


def _color(gap: float, p_value: float) -> palette.Rgb:
    if not p_value < SIGNIFICANT:
        return palette.EXCLUDED
    return palette.SUCCESS if gap > 0.0 else palette.FAILURE
