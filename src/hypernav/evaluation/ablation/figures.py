"""The figure of a study; matplotlib is imported only to draw it."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hypernav.evaluation.ablation.results import StudyResults, VariantResult
from hypernav.evaluation.report.report_text import SIGNIFICANT
from hypernav.evaluation.statistics import Comparison, Estimate
from hypernav.show.drawing import palette

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PNG, SVG = "figure.png", "figure.svg"

_STYLE: dict[Any, Any] = {
    "svg.hashsalt": "hypernav",  # the same results give the same bytes
    "font.family": "DejaVu Sans",
    "axes.edgecolor": palette.css(palette.FAINT),
    "axes.labelcolor": palette.css(palette.INK),
    "axes.spines.top": False,
    "axes.spines.right": False,
    "xtick.color": palette.css(palette.MUTED),
    "ytick.color": palette.css(palette.INK),
    "text.color": palette.css(palette.INK),
}


def write_figure(folder: Path, results: StudyResults) -> None:
    """Write ``figure.png`` and ``figure.svg``; there must be a variant to draw."""
    import matplotlib

    with matplotlib.rc_context(_STYLE):
        figure = _curves(results) if results.study.axis else _differences(results)
        figure.savefig(folder / PNG, dpi=160)
        figure.savefig(folder / SVG, metadata={"Date": None})


def _differences(results: StudyResults) -> "Figure":
    """Differences from the unchanged method, the greatest loss on top."""
    from matplotlib.figure import Figure

    rows = results.worst_first
    figure = Figure(figsize=(10.0, 1.5 + 0.27 * len(rows)), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    pairs = [row.pair for row in rows if row.pair is not None]
    _whiskers(left, [pair.success for pair in pairs], 100.0)
    _whiskers(right, [pair.spl for pair in pairs], 1.0)
    left.set_title("Success rate", fontsize=10)
    right.set_title("SPL", fontsize=10)
    unchanged = results.baseline.summary
    left.set_xlabel(f"SR, points from {100 * unchanged.success.mean:.1f} %\n← worse   better →")
    right.set_xlabel(f"SPL, from {unchanged.spl.mean:.3f}\n← worse   better →")
    left.set_yticks(range(len(rows)), [row.variant.name for row in rows])
    left.set_ylim(len(rows) - 0.5, -0.5)
    figure.suptitle(
        "Each variant minus the unchanged method, with 95 % intervals; coloured where "
        f"p < {SIGNIFICANT:g}",
        fontsize=10,
    )
    return figure


def _whiskers(axes: "Axes", comparisons: Sequence[Comparison], factor: float) -> None:
    axes.axvline(0.0, color=palette.css(palette.MUTED), linewidth=1.0)
    axes.grid(color=palette.css(palette.FAINT), linewidth=0.6)
    axes.set_axisbelow(True)
    axes.tick_params(axis="y", length=0)
    axes.locator_params(axis="x", nbins=6)
    for place, comparison in enumerate(comparisons):
        gap, color = comparison.difference, palette.css(_color(comparison))
        axes.plot([factor * gap.low, factor * gap.high], [place, place], color=color, linewidth=2.2)
        axes.plot([factor * gap.mean], [place], "o", color=color, markersize=5.5)


def _color(comparison: Comparison) -> palette.Rgb:
    if not comparison.p_value < SIGNIFICANT:
        return palette.EXCLUDED
    return palette.SUCCESS if comparison.difference.mean > 0.0 else palette.FAILURE


def _curves(results: StudyResults) -> "Figure":
    """Success and SPL over the quality of the variants, a curve for each family of them."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.0, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    unchanged = results.baseline
    for axes, words in ((left, "SR, %"), (right, "SPL")):
        axes.grid(color=palette.css(palette.FAINT), linewidth=0.6)
        axes.set_xlabel(results.study.axis)
        axes.set_ylabel(words)
    if unchanged.variant.quality is None:
        for axes, estimate, factor in (
            (left, unchanged.summary.success, 100.0),
            (right, unchanged.summary.spl, 1.0),
        ):
            axes.axhline(
                factor * estimate.mean,
                color=palette.css(palette.MUTED),
                linestyle="--",
                label=unchanged.variant.name,
            )
    curves: dict[str, list[VariantResult]] = {}
    for result in results.all:
        if result.variant.quality is not None:
            curves.setdefault(result.variant.curve, []).append(result)
    for (name, points), color in zip(curves.items(), palette.SERIES * len(curves), strict=False):
        shown = (palette.css(color), name)
        _curve(left, [(p.variant.quality or 0.0, p.summary.success) for p in points], 100.0, *shown)
        _curve(right, [(p.variant.quality or 0.0, p.summary.spl) for p in points], 1.0, *shown)
    left.legend(frameon=False, fontsize=9)
    figure.suptitle("Means over episodes, with 95 % intervals over scenes", fontsize=10)
    return figure


def _curve(
    axes: "Axes",
    points: Sequence[tuple[float, Estimate]],
    factor: float,
    color: str,
    name: str,
) -> None:
    points = sorted(points, key=lambda point: point[0])
    axes.errorbar(
        [quality for quality, _ in points],
        [factor * estimate.mean for _, estimate in points],
        yerr=[
            [factor * (estimate.mean - estimate.low) for _, estimate in points],
            [factor * (estimate.high - estimate.mean) for _, estimate in points],
        ],
        color=color,
        marker="o",
        capsize=3.0,
        label=name,
    )
