"""Strips of rooms side by side, the elements of the plans of public buildings."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate

from hypernav.houses.plan.shapes import Rect
from hypernav.houses.random_stream import RandomStream

STEP_M = 0.05
"""Raster of all walls, metres."""

Cell = tuple[str, Rect]
"""Kind of a room, and its floor up to the centre lines of its walls."""


@dataclass(frozen=True)
class Width:
    """Width of a kind of room along its strip, metres."""

    least: float
    usual: float
    most: float


@dataclass(frozen=True)
class StripProgram:
    """The rooms of a strip.

    Attributes:
        wanted: Kinds of the rooms that it should hold; those that find no space are left out.
        fillers: Kinds that fill the rest, with their weights.
        widths: Width of every kind.
    """

    wanted: Sequence[str]
    fillers: Sequence[tuple[str, float]]
    widths: Mapping[str, Width]


def snapped(value: float) -> float:
    """Length on the raster of walls."""
    return round(round(value / STEP_M) * STEP_M, 4)


def fill_strip(rng: RandomStream, strip: Rect, along: str, program: StripProgram) -> list[Cell]:
    """Rooms side by side that fill a strip, in random order.

    Args:
        rng: Source of randomness.
        strip: Floor of the strip.
        along: Axis that the rooms follow each other on, "x" or "y".
        program: What it holds.

    Returns:
        The rooms; empty if none of the program's rooms fits.
    """
    length = strip.width if along == "x" else strip.depth
    widths = program.widths
    kinds: list[str] = []
    for kind in program.wanted:
        if sum(widths[k].least for k in (*kinds, kind)) <= length:
            kinds.append(kind)
    for _ in range(60):
        if kinds and sum(widths[k].usual for k in kinds) > 0.9 * length:
            break
        kind = rng.weighted(program.fillers)
        if sum(widths[k].least for k in (*kinds, kind)) <= length:
            kinds.append(kind)
    if sum(widths[k].most for k in kinds) < length:
        return []
    kinds = rng.shuffled(kinds)
    edges = [snapped(e) for e in accumulate(_fitted([widths[k] for k in kinds], length))]
    edges[-1] = length
    cells = []
    start = 0.0
    for kind, end in zip(kinds, edges, strict=True):
        cells.append((kind, _slice(strip, along, start, end)))
        start = end
    return cells


def _fitted(widths: Sequence[Width], length: float) -> list[float]:
    """Widths within their limits that add up to a length, in proportion to the usual ones."""
    low, high = 0.0, length / min(w.least for w in widths)
    for _ in range(40):
        factor = (low + high) / 2.0
        if sum(_limited(w, factor) for w in widths) < length:
            low = factor
        else:
            high = factor
    return [_limited(w, high) for w in widths]


def _limited(width: Width, factor: float) -> float:
    return min(max(width.usual * factor, width.least), width.most)


def _slice(strip: Rect, along: str, start: float, end: float) -> Rect:
    if along == "x":
        return Rect(round(strip.x0 + start, 4), strip.y0, round(strip.x0 + end, 4), strip.y1)
    return Rect(strip.x0, round(strip.y0 + start, 4), strip.x1, round(strip.y0 + end, 4))
