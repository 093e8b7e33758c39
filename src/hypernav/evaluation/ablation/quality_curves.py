"""The figure of a study of quality: success and SPL as curves; matplotlib is imported to draw."""

from typing import TYPE_CHECKING

from hypernav.evaluation.ablation.results import StudyResults, VariantResult
from hypernav.evaluation.ablation.study import Axis
from hypernav.evaluation.report import report_text
from hypernav.evaluation.statistics import Estimate
from hypernav.show.drawing import palette

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
        f"means with 95 % intervals over {report_text.drawn(results.baseline.run)}",
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
    values = (factor * estimate.mean, factor * estimate.low, factor * estimate.high)
    return Estimate(*values, estimate.count)


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
