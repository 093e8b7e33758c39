"""The image of several floors for a model that is asked where to go: one panel beside the other."""

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, UInt8

from hypernav.core.exploring.floors import KnownFloor, WayOut
from hypernav.core.exploring.overview import Block
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.trace import Mode
from hypernav.search.drawing import palette, shapes
from hypernav.search.drawing.label_placement import Label, placed_labels
from hypernav.search.drawing.map_painter import MapPainter
from hypernav.search.drawing.map_view import Bounds, MapView, explored_bounds
from hypernav.search.drawing.question_map import QuestionStyle, question_painter
from hypernav.search.drawing.text import draw_text, text_width

LEGEND = (
    ". Each part of the image is one floor of the building; what lies above one another in the "
    "building is at the same place in all parts. Brown bars are the treads of stairs; a number at "
    "them means that the robot can take them to a floor that it has not seen"
)
"""What the marks of this image mean, beside those of the map of one floor."""

_STAIRS: palette.Rgb = palette.MODES[Mode.CLIMB]
_TREADS = 5
_TREAD_M = 0.25
"""Distance between two bars, metres."""
_BAR_M = 0.1
_WIDE_M = 0.9
_BEHIND_M = 0.3
"""Distance from the position before stairs to their first tread, metres."""
_MARGIN = 0.06
_TITLE = 1.0 / 18.0
"""Height of a title, and width of the gap between panels, as shares of a panel's side."""
_GAP = 1.0 / 90.0


@dataclass(frozen=True, eq=False)
class FloorPanel:
    """What the panel of one floor shows.

    Attributes:
        floor: The floor.
        blocks: Its blocks that are drawn, stairs that can be chosen among them.
        frontier: Middles of the cells at the boundary to the unknown, ``map`` frame, metres.
        robot: Pose of the robot, ``map`` frame; None if it is on another floor.
    """

    floor: KnownFloor
    blocks: Sequence[Block]
    frontier: Float64[np.ndarray, "n 2"]
    robot: Pose2 | None = None

    @property
    def title(self) -> str:
        """Which floor it is, and where it lies."""
        here = self.robot is not None
        words = f"floor {self.floor.number + 1}, with the robot" if here else self.floor.words
        return words.capitalize()

    @property
    def bounds(self) -> Bounds:
        """The rectangle around all that it shows."""
        points = [one.xy for one in self.floor.stairs]
        for one in self.blocks:
            points += [(one.x_min, one.y_min), (one.x_min + one.size_m, one.y_min + one.size_m)]
        return explored_bounds(self.floor.grid, [*points, *([self.robot.xy] if self.robot else [])])


def draw_floors(
    panels: Sequence[FloorPanel],
    style: QuestionStyle,
    *,
    size: int,
    excluded: Collection[int] = (),
) -> UInt8[np.ndarray, "_ _ 3"]:
    """Draw floors side by side at one scale, the lowest on the left; what lies above agrees.

    Args:
        panels: The floors.
        style: Style of the maps.
        size: Side of a map, pixels.
        excluded: Numbers of blocks that may not be answered; hatched.

    Returns:
        RGB.
    """
    low, high = zip(*((one.bounds[:2], one.bounds[2:]) for one in panels), strict=True)
    bounds = (*np.min(low, axis=0).tolist(), *np.max(high, axis=0).tolist())
    view = MapView.around(bounds, size, margin=_MARGIN)
    title_px, gap_px = round(_TITLE * size), round(_GAP * size)
    drawn: list[np.ndarray] = []
    for panel in sorted(panels, key=lambda one: one.floor.above_m):
        title = np.full((title_px, size, 3), palette.PAPER, dtype=np.uint8)
        at = (size / 2.0, title_px / 2.0)
        draw_text(title, panel.title, at, round(0.6 * title_px), bold=True, align=0.5)
        gap = np.full((title_px + size, gap_px, 3), palette.INK, dtype=np.uint8)
        drawn += [gap] if drawn else []
        drawn.append(np.vstack([title, _map(panel, view, style, excluded)]))
    return np.hstack(drawn)


def _map(
    panel: FloorPanel, view: MapView, style: QuestionStyle, excluded: Collection[int]
) -> UInt8[np.ndarray, "_ _ 3"]:
    floor = panel.floor
    painter = question_painter(floor.grid, view, style, panel.frontier)
    squares = [one for one in panel.blocks if one.connector is None]
    painter.blocks(squares, excluded=excluded)
    for one in floor.stairs:
        _treads(painter, one)
    if style.labels:
        painter.labels(floor.things)
    painter.trajectory(floor.trajectory)
    painter.numbers(squares, excluded=excluded, robot=panel.robot)
    painter.scale_bar()
    _names(painter, panel, squares)
    if panel.robot is not None:
        painter.robot(panel.robot)
    return painter.image


def _treads(painter: MapPainter, stairs: WayOut) -> None:
    ahead, beside = _axes(stairs)
    for k in range(_TREADS):
        middle = np.array(stairs.xy) + ahead * (_BEHIND_M + k * _TREAD_M)
        bar = painter.view.to_pixels(np.stack([middle - beside, middle + beside]))
        width = _BAR_M * painter.view.pixels_per_m
        shapes.line(painter.image, bar, palette.FREE, width + 2.0)
        shapes.line(painter.image, bar, _STAIRS, width)


def _axes(stairs: WayOut) -> tuple[Float64[np.ndarray, "2"], Float64[np.ndarray, "2"]]:
    """A metre along stairs, and half their width across."""
    ahead = np.array([math.cos(stairs.axis), math.sin(stairs.axis)])
    return ahead, np.array([-ahead[1], ahead[0]]) * _WIDE_M / 2.0


def _names(painter: MapPainter, panel: FloorPanel, squares: Sequence[Block]) -> None:
    """Write where stairs lead, and their number where they can be chosen, clear of all numbers.

    Names without a number are left out where there is no room.
    """
    size = max(round(painter.view.size / 40.0), 11)
    height = 1.5 * size
    numbers = {one.connector: one.number for one in panel.blocks if one.connector is not None}
    taken = [
        Label(str(one.number), *painter.view.pixel_of(*_middle(one)), 2.0 * size) for one in squares
    ]
    texts: dict[str, str] = {}
    names: list[Label] = []
    for one in sorted(panel.floor.stairs, key=lambda stairs: stairs.connector not in numbers):
        on_it = np.array(one.xy) + _axes(one)[0] * (_BEHIND_M + _TREADS * _TREAD_M / 2.0)
        u, v = painter.view.pixel_of(*on_it.tolist())
        text = one.words if one.to is None else f"{one.words} to floor {one.to + 1}"
        if one.connector in numbers:
            text = f"{numbers[one.connector]}: {text}"
        half = text_width(text, size, bold=True) / 2.0 + size
        u = min(max(u, half), painter.view.size - half)
        # Stairs may have the same words, so a label is known by its stairs.
        key = f"stairs {one.connector}"
        texts[key] = text
        names.append(Label(key, u, v + 0.5 * _WIDE_M * painter.view.pixels_per_m, 2.0 * half))
    placed = {one.text: one for one in placed_labels([*taken, *names], height)}
    for name in names:
        text = texts[name.text]
        can_be_chosen = ":" in text
        if name.text not in placed and not can_be_chosen:
            continue
        at = placed.get(name.text, name)
        if can_be_chosen:
            left, top = at.u - name.width / 2.0 + 4.0, at.v - height / 2.0
            width = name.width - 8.0
            shapes.rounded_box(painter.image, left, top, width, height, _STAIRS, radius=5.0)
        color, halo = (palette.PAPER, None) if can_be_chosen else (_STAIRS, palette.FREE)
        place = (at.u, at.v)
        draw_text(painter.image, text, place, size, bold=True, align=0.5, color=color, halo=halo)


def _middle(block: Block) -> tuple[float, float]:
    return block.x_min + block.size_m / 2.0, block.y_min + block.size_m / 2.0
