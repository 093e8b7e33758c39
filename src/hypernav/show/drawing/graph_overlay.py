"""Draws what an explorer remembers on the map: things, and which of them are near each other."""

import numpy as np

from hypernav.core.exploring.insight import ThingGraph
from hypernav.core.exploring.sightings import SeenThing
from hypernav.show.drawing import palette, shapes
from hypernav.show.drawing.map_painter import MapPainter


def draw_graph(painter: MapPainter, graph: ThingGraph) -> None:
    """Draw dots for things, lines between near ones, and names of those that the reasoner is told.

    Args:
        painter: Painter of the map.
        graph: The things.
    """
    at = [painter.view.pixel_of(*thing.position) for thing in graph.things]
    unit = painter.view.size / 768.0
    for a, b in graph.near:
        shapes.line(painter.image, np.array([at[a], at[b]]), palette.BLOCK, 1.2 * unit)
    for middle in at:
        shapes.disc(painter.image, middle, max(4.0 * unit, 2.5), palette.BLOCK)
    painter.labels([SeenThing(one.label, one.position) for one in graph.things if one.told])
