"""Paints the map as an image, layer by layer."""

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float64, UInt8

from hypernav.core.exploring.floors import SeenThing
from hypernav.core.exploring.overview import Block
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.trace import BlockRecord
from hypernav.search.drawing import palette, shapes
from hypernav.search.drawing.label_placement import (
    Disc,
    HiddenWeight,
    Label,
    Square,
    clear_position,
    free_labels,
    moved_by_rows,
    number_position,
    number_size,
    placed_labels,
)
from hypernav.search.drawing.map_view import CellColors, MapView, rasterize_map
from hypernav.search.drawing.shapes import draw_robot
from hypernav.search.drawing.text import draw_text, text_width

_SHADES_OF_TIME = 24
_SCALE_BARS_M = (0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0)

XY = tuple[float, float]
"""A point in the ``map`` frame, metres."""


NumberedSquare = Block | BlockRecord
"""A block, from an overview or from a trace."""


@dataclass(frozen=True)
class StairsMark:
    """An end of stairs on the map of a floor.

    Attributes:
        position: Position ``(x, y)``, ``map`` frame, metres.
        words: Where they lead, in a few words.
    """

    position: tuple[float, float]
    words: str


class MapPainter:
    """Paints one image of a map; every method adds a layer above the former ones.

    Attributes:
        grid: The map.
        image: The image so far, RGB.
        view: Metres to pixels and back.
    """

    def __init__(
        self,
        grid: OccupancyGrid,
        *,
        size: int = 768,
        view: MapView | None = None,
        colors: CellColors | None = None,
    ) -> None:
        """Paint the cells.

        Args:
            grid: The map.
            size: Side of the image, pixels; unused if ``view`` is given.
            view: Window of the map; by default the explored area, fitted and centred.
            colors: Colours of the cells; by default those of all maps.
        """
        self.grid = grid
        self.view = view if view is not None else MapView.fit(grid, size)
        self.image: UInt8[np.ndarray, "_ _ 3"] = rasterize_map(grid, self.view, colors)
        self._unit = self.view.size / 768.0

    def frontier(self, points: Float64[np.ndarray, "_ 2"], side_m: float) -> None:
        """Mark cells that touch the unknown.

        Args:
            points: Middles of the cells, metres.
            side_m: Side of a cell, metres.
        """
        half = max(0.5 * side_m * self.view.pixels_per_m, 2.2 * self._unit)
        for u, v in self._pixels(points):
            shapes.rectangle(
                self.image, (u - half, v - half), (u + half, v + half), palette.FRONTIER
            )

    def goal_area(self, polygons: Iterable[Sequence[XY]]) -> None:
        """Fill the cells that the goal was seen on."""
        outlines = [self._pixels(polygon) for polygon in polygons if len(polygon) >= 3]
        shapes.polygon(self.image, outlines, palette.GOAL, opacity=0.45)
        for outline in outlines:
            shapes.line(self.image, outline, palette.GOAL, 2 * self._unit, closed=True)

    def blocks(
        self,
        blocks: Sequence[NumberedSquare],
        *,
        chosen: int | None = None,
        excluded: Collection[int] = (),
        opacity: float = 1.0,
    ) -> None:
        """Outline blocks; the chosen one stands out, excluded ones are hatched."""
        outline = palette.blend(palette.FREE, palette.BLOCK, opacity)
        for block in blocks:
            low, high = self._corners(block)
            if block.number in excluded:
                spacing = max(round(9 * self._unit), 5)
                shapes.hatch(
                    self.image, low, high, palette.EXCLUDED, spacing=spacing, opacity=opacity
                )
            if block.number == chosen:
                shapes.rectangle(self.image, low, high, palette.CHOSEN, opacity=0.35 * opacity)
            self._frame(low, high, outline, 1.0)
        for block in blocks:
            if block.number == chosen:
                self._frame(*self._corners(block), palette.CHOSEN, max(3.0 * self._unit, 2.0))

    def numbers(
        self,
        blocks: Sequence[NumberedSquare],
        *,
        chosen: int | None = None,
        excluded: Collection[int] = (),
        robot: Pose2 | None = None,
        destination: XY | None = None,
        opacity: float = 1.0,
    ) -> None:
        """Write the numbers of blocks, clear of the robot's arrow and the destination's mark."""
        squares = [self._square(block) for block in blocks]
        size = number_size(squares, self.view.size)
        arrow = self._arrow_disc(robot) if robot is not None else None
        mark = self._mark_disc(*destination) if destination is not None else None
        for block, square in zip(blocks, squares, strict=True):
            text, bold = str(block.number), block.number not in excluded
            width = text_width(text, size, bold=bold) + 4.0
            at = number_position(square, width, size, arrow, mark)
            color = palette.INK if bold else palette.BLOCK
            self._write(text, at, size, bold=bold, color=color, opacity=opacity)

    def clear_numbers(
        self,
        blocks: Sequence[NumberedSquare],
        *,
        excluded: Collection[int] = (),
        robot: Pose2,
    ) -> None:
        """Write larger numbers of blocks, preferably on free floor, never on furniture.

        Args:
            blocks: Numbered blocks.
            excluded: Numbers of the blocks that are not numbered.
            robot: Pose of the robot, whose arrow must not be covered.
        """
        squares = {b.number: self._square(b) for b in blocks if b.number not in excluded}
        size = number_size(list(squares.values()), self.view.size, most=1.0 / 22.0)
        hides = HiddenWeight(self.grid, self.view)
        for number, square in squares.items():
            width = text_width(str(number), size, bold=True) + 4.0
            at = clear_position(
                square,
                width,
                0.8 * size,
                self._arrow_disc(robot),
                lambda u, v, width=width: hides.weight(u, v, width, 0.8 * size),
            )
            self._write(str(number), at, size, bold=True)

    def labels(self, things: Sequence[SeenThing]) -> None:
        """Write the names of things where they are, or beside them if another name is there."""
        size, halo = max(round(15 * self._unit), 9), max(round(2 * self._unit), 1)
        labels = [
            Label(one.label, *self.view.pixel_of(*one.position), text_width(one.label, size) + halo)
            for one in things
        ]
        for label in placed_labels(labels, size + halo):
            self._write(label.text, (label.u, label.v), size)

    def trajectory(self, points: Sequence[XY]) -> None:
        """Draw the trajectory, from pale (long ago) to dark (now)."""
        line = self._pixels(points)
        pieces = min(max(len(line) - 1, 0), _SHADES_OF_TIME)
        for piece in range(pieces):
            start, end = ((len(line) - 1) * k // pieces for k in (piece, piece + 1))
            share = (piece + 1) / pieces
            color = palette.blend(palette.TRAJECTORY_OLD, palette.TRAJECTORY_NEW, share)
            shapes.line(self.image, line[start : end + 1], color, 3.4 * self._unit)

    def start(self, x: float, y: float) -> None:
        """Mark the start position."""
        at, radius = self.view.pixel_of(x, y), max(6.0 * self._unit, 4.0)
        shapes.disc(self.image, at, radius + 1.5, palette.FREE)
        shapes.disc(self.image, at, radius, palette.TRAJECTORY_NEW)
        shapes.disc(self.image, at, 0.45 * radius, palette.FREE)

    def stairs(self, marks: Sequence[StairsMark], paths: Iterable[Sequence[XY]] = ()) -> None:
        """Mark the ends of stairs, each with where they lead beside it.

        Args:
            marks: The ends of stairs.
            paths: Lines of the map of which the words cover as little as they can.
        """
        if not marks:
            return
        size, half = max(round(20 * self._unit), 12), max(12.0 * self._unit, 8.0)
        row, gap = 1.2 * size, half + 5.0
        drawn = self._drawn(paths)
        taken = [Label("", *self.view.pixel_of(*mark.position), 2.0 * half) for mark in marks]
        for mark in marks:
            u, v = self.view.pixel_of(*mark.position)
            for tread in range(3):
                low = (u - half + 0.67 * half * tread, v + half * (0.33 - 0.67 * tread))
                shapes.rectangle(self.image, low, (u + half, low[1] + 0.67 * half), palette.STAIRS)
            width = text_width(mark.words, size, bold=True)
            beside = [Label(mark.words, u + gap + width / 2.0, v, width)]
            beside.append(beside[0]._replace(u=u - gap - width / 2.0))
            inside = [one for one in beside if width <= 2.0 * one.u <= 2.0 * self.view.size - width]
            rows = [moved_by_rows(one, row) for one in inside or beside]
            options = [one for at_row in zip(*rows, strict=True) for one in at_row]
            label = min(
                free_labels(options, taken, row) or options,
                key=lambda one: _covered(drawn, one, row),
            )
            taken.append(label)
            halo_px = max(round(3 * self._unit), 2)
            self._write(
                label.text,
                (label.u, label.v),
                size,
                bold=True,
                color=palette.STAIRS,
                halo_px=halo_px,
            )

    def path(self, points: Sequence[XY]) -> None:
        """Draw the planned path, dashed."""
        line = self._pixels(points)
        dash = max(10.0 * self._unit, 6.0)
        shapes.dashed_line(
            self.image, line, palette.PATH, 3 * self._unit, dash=dash, gap=0.6 * dash
        )

    def destination(self, x: float, y: float) -> None:
        """Mark the destination: a ring with a cross."""
        mark = self._mark_disc(x, y)
        at, radius = (mark.u, mark.v), mark.radius - 3.0 * self._unit
        arm = 0.62 * radius
        for color, width in ((palette.FREE, 6.0), (palette.PATH, 3.0)):
            shapes.ring(self.image, at, radius, color, width * self._unit)
            for slope in (1.0, -1.0):
                cross = np.array(
                    [
                        [at[0] - arm * 0.7, at[1] - slope * arm * 0.7],
                        [at[0] + arm * 0.7, at[1] + slope * arm * 0.7],
                    ]
                )
                shapes.line(self.image, cross, color, width * self._unit)

    def robot(self, pose: Pose2) -> None:
        """Draw the robot as an arrow that points where it looks."""
        disc = self._arrow_disc(pose)
        draw_robot(self.image, (disc.u, disc.v), pose.yaw, disc.radius)

    def title(self, words: str) -> None:
        """Write words into the upper left corner."""
        size = max(round(24 * self._unit), 13)
        draw_text(self.image, words, (0.8 * size, 1.1 * size), size, bold=True, halo=palette.FREE)

    def scale_bar(self) -> None:
        """Draw a bar of a round length into the lower left corner."""
        unit = max(self._unit, 0.7)
        fitting = [m for m in _SCALE_BARS_M if m * self.view.pixels_per_m <= 0.22 * self.view.size]
        metres = fitting[-1] if fitting else _SCALE_BARS_M[0]
        length = metres * self.view.pixels_per_m
        left, bottom = 16.0 * unit, self.view.size - 14.0 * unit
        for color, rim in ((palette.FREE, 1.5), (palette.INK, 0.0)):
            for low, high in (
                ((left, bottom - 3 * unit), (left + length, bottom)),
                ((left, bottom - 8 * unit), (left + 2, bottom)),
                ((left + length - 2, bottom - 8 * unit), (left + length, bottom)),
            ):
                shapes.rectangle(
                    self.image,
                    (low[0] - rim, low[1] - rim),
                    (high[0] + rim, high[1] + rim),
                    color,
                )
        draw_text(
            self.image,
            f"{metres:g} m",
            (left + length + 8 * unit, bottom - 4 * unit),
            max(round(15 * unit), 10),
            color=palette.INK,
            halo=palette.FREE,
        )

    def _write(
        self,
        text: str,
        at: XY,
        size: int,
        *,
        bold: bool = False,
        color: palette.Rgb = palette.INK,
        halo_px: int | None = None,
        opacity: float = 1.0,
    ) -> None:
        """Write centred text with a white rim."""
        rim = max(round(2 * self._unit), 1) if halo_px is None else halo_px
        draw_text(
            self.image,
            text,
            at,
            size,
            color=color,
            bold=bold,
            align=0.5,
            halo=palette.FREE,
            halo_px=rim,
            opacity=opacity,
        )

    def _pixels(
        self, points: Sequence[XY] | Float64[np.ndarray, "_ 2"]
    ) -> Float64[np.ndarray, "_ 2"]:
        return self.view.to_pixels(np.asarray(points, dtype=np.float64).reshape(-1, 2))

    def _drawn(self, paths: Iterable[Sequence[XY]]) -> UInt8[np.ndarray, "_ _"]:
        """The pixels of lines, each 1."""
        drawn = np.zeros(self.image.shape[:2], dtype=np.uint8)
        lines = [np.rint(self._pixels(path)).astype(np.int32) for path in paths if len(path)]
        return cv2.polylines(drawn, lines, False, 1, max(round(3.4 * self._unit), 1))

    def _square(self, block: NumberedSquare) -> Square:
        left, top = self.view.pixel_of(block.x_min, block.y_min + block.size_m)
        return Square(left, top, block.size_m * self.view.pixels_per_m)

    def _corners(self, block: NumberedSquare) -> tuple[XY, XY]:
        left, top, side = self._square(block)
        return (left, top), (left + side, top + side)

    def _frame(self, low: XY, high: XY, color: palette.Rgb, width: float) -> None:
        corners = np.array([low, (high[0], low[1]), high, (low[0], high[1])])
        # Whole pixels keep a thin upright line sharp.
        shapes.line(self.image, np.rint(corners) + 0.5, color, width, closed=True)

    def _arrow_disc(self, pose: Pose2) -> Disc:
        return Disc(*self.view.pixel_of(pose.x, pose.y), max(17.0 * self._unit, 10.0))

    def _mark_disc(self, x: float, y: float) -> Disc:
        return Disc(*self.view.pixel_of(x, y), max(13.0 * self._unit, 8.0))


def _covered(drawn: UInt8[np.ndarray, "_ _"], label: Label, height: float) -> int:
    """Number of drawn pixels under a label."""
    top, bottom = (max(round(label.v + half * height), 0) for half in (-0.5, 0.5))
    left, right = (max(round(label.u + half * label.width), 0) for half in (-0.5, 0.5))
    return int(drawn[top:bottom, left:right].sum())
