"""What an explorer looked at in the camera image: its numbered marks, or the part it chose."""

import numpy as np
from jaxtyping import UInt8

from hypernav.core.exploring.insight import Insight
from hypernav.show.drawing import palette, shapes
from hypernav.show.drawing.arrows import ArrowStyle, draw_arrows
from hypernav.show.drawing.text import draw_text, text_width

_TEXT = 16


def draw_insight(image: UInt8[np.ndarray, "_ _ 3"], insight: Insight) -> UInt8[np.ndarray, "_ _ 3"]:
    """Draw marks and window into a copy of the camera image; what was chosen is orange."""
    drawn = image.copy()
    if insight.marks:
        style = ArrowStyle(shafts=insight.foot is not None)
        chosen = [mark.number for mark in insight.marks if mark.chosen]
        marks = {mark.number: mark.pixel for mark in insight.marks}
        foot = insight.foot or (0.0, 0.0)
        drawn = draw_arrows(drawn, marks, foot, style, chosen=chosen)
    if insight.window is not None:
        left, top, right, bottom = insight.window.box
        corners = np.array([[left, top], [right, top], [right, bottom], [left, bottom]])
        shapes.polygon(drawn, [corners], palette.CHOSEN, opacity=0.25)
        shapes.line(drawn, corners, palette.CHOSEN, 3.0, closed=True)
        label = insight.window.label
        wide = text_width(label, _TEXT, bold=True) + 12.0
        shapes.rectangle(drawn, (left, top), (left + wide, top + 24.0), palette.CHOSEN)
        ink = palette.ink_on(palette.CHOSEN)
        draw_text(drawn, label, (left + 6.0, top + 12.0), _TEXT, bold=True, color=ink)
    return drawn
