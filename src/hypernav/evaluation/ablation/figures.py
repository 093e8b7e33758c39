"""The figure of a study; matplotlib is imported only to draw it."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hypernav.evaluation.ablation.quality_curves import drawn_axes, quality_curves
from hypernav.evaluation.ablation.results import StudyResults
from hypernav.evaluation.report.report_text import SIGNIFICANT, drawn
from hypernav.evaluation.statistics import Comparison
from hypernav.show.drawing import palette
from hypernav.show.templating import data_uri

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

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
        figure.savefig(folder / PNG, dpi=160)
        figure.savefig(folder / SVG, metadata={"Date": None})
    return data_uri((folder / SVG).read_bytes(), "image/svg+xml")


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
        f"{drawn(results.baseline.run)}; coloured where corrected p < {SIGNIFICANT:g}",
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
        axes.plot([factor * gap.low, factor * gap.high], [place, place], color=color, linewidth=2.2)
        axes.plot([factor * gap.mean], [place], "o", color=color, markersize=5.5)


def _color(gap: float, p_value: float) -> palette.Rgb:
    if not p_value < SIGNIFICANT:
        return palette.EXCLUDED
    return palette.SUCCESS if gap > 0.0 else palette.FAILURE
