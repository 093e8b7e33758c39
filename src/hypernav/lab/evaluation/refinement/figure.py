"""The figure of the study of goal refinement; matplotlib is imported only to draw it."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from hypernav.lab.evaluation.refinement.area_record import MaskSource
from hypernav.lab.evaluation.refinement.summary import MEASURES, Row, drawn_in
from hypernav.lab.evaluation.statistics import FEWEST_WITH_INTERVAL
from hypernav.search.drawing import palette

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def shares_figure(rows: Sequence[Row]) -> "Figure":
    """A panel for each measure, with the shares of every kind of box and area."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12.0, 1.2 + 0.27 * len(rows)), layout="constrained")
    panels = figure.subplots(1, len(MEASURES), sharey=True)
    for axes, name in zip(panels, MEASURES, strict=True):
        axes.grid(color=palette.css(palette.FAINT), linewidth=0.6)
        axes.set_axisbelow(True)
        axes.tick_params(axis="y", length=0)
        axes.set_title(name, fontsize=10)
        axes.set_xlim(-3.0, 103.0)
        axes.set_xlabel("%")
        for place, row in enumerate(rows):
            share = row.measures[name].share
            is_raw = row.mask is MaskSource.RAW
            color = palette.css(palette.FAILURE if is_raw else palette.EXCLUDED)
            ends = [100.0 * end for end in share.drawn_ends]
            axes.plot(ends, [place, place], color=color, linewidth=2.2)
            axes.plot([100.0 * share.mean], [place], "o", color=color, markersize=5.5)
    panels[0].set_yticks(
        range(len(rows)), [f"{row.box.value} box: {row.mask.value}" for row in rows]
    )
    panels[0].set_ylim(len(rows) - 0.5, -0.5)
    figure.suptitle(
        f"Shares with 95 % intervals over {drawn_in(rows)} "
        f"from {FEWEST_WITH_INTERVAL} episodes on; less is better",
        fontsize=10,
    )
    return figure
