"""Shapes have their size, lie where they are drawn, and move with their coordinates."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from hypernav.search.drawing import shapes
from hypernav.search.drawing.shapes import Image

WHITE = (255, 255, 255)
SIDE = 80
CORNERS = np.array([[-12.0, 8.0], [12.0, 8.0], [0.0, -16.0]])  # around their centre of gravity
TURN = np.linspace(0.0, 2.0 * math.pi, 80)
WAVE = np.stack([10.0 * np.cos(TURN), 10.0 * np.sin(TURN)], axis=1)

Draw = Callable[[Image, float, float], None]
# How a shape is drawn around a point; its area and the length of its edges, pixels.
SHAPES: dict[str, tuple[Draw, float, float]] = {
    "disc": (
        lambda image, u, v: shapes.disc(image, (u, v), 11.3, WHITE),
        math.pi * 11.3**2,
        2.0 * math.pi * 11.3,
    ),
    "ring": (
        lambda image, u, v: shapes.ring(image, (u, v), 10.0, WHITE, 4.0),
        2.0 * math.pi * 10.0 * 4.0,
        4.0 * math.pi * 10.0,
    ),
    "polygon": (
        lambda image, u, v: shapes.polygon(image, [CORNERS + np.array([u, v])], WHITE),
        0.5 * 24.0 * 24.0,
        24.0 * (1.0 + math.sqrt(5.0)),
    ),
    "see-through polygon": (
        lambda image, u, v: shapes.polygon(image, [CORNERS + np.array([u, v])], WHITE, opacity=0.5),
        0.25 * 24.0 * 24.0,
        12.0 * (1.0 + math.sqrt(5.0)),
    ),
    "closed line": (
        lambda image, u, v: shapes.line(image, WAVE + np.array([u, v]), WHITE, 3.0, closed=True),
        2.0 * math.pi * 10.0 * 3.0,
        4.0 * math.pi * 10.0,
    ),
    "rectangle": (
        lambda image, u, v: shapes.rectangle(image, (u - 9, v + 6), (u + 9, v - 6), WHITE),
        18.0 * 12.0,
        0.0,
    ),
    "see-through rectangle": (
        lambda image, u, v: shapes.rectangle(
            image, (u - 9, v - 6), (u + 9, v + 6), WHITE, opacity=0.5
        ),
        0.5 * 18.0 * 12.0,
        1.0,
    ),
    "rounded box": (
        lambda image, u, v: shapes.rounded_box(image, u - 12, v - 8, 24, 16, WHITE, radius=5.0),
        24.0 * 16.0 - (4.0 - math.pi) * 5.0**2,
        80.0,
    ),
}


def cover(draw: Draw, u: float, v: float) -> np.ndarray:
    """How much of each pixel a white shape covers, 0 to 1."""
    image = np.zeros((SIDE, SIDE, 3), np.uint8)
    draw(image, u, v)
    assert (image[..., 0] == image[..., 1]).all()
    return image[..., 0] / 255.0


@pytest.mark.parametrize("name", SHAPES)
def test_a_shape_has_its_area_around_its_middle(name: str):
    draw, area, edges = SHAPES[name]
    covered = cover(draw, 33.0, 42.0)
    assert 0.98 * area <= covered.sum() <= area + 1.5 * edges  # OpenCV's soft edges are wide
    v, u = np.indices(covered.shape) + 0.5
    middle = ((u * covered).sum() / covered.sum(), (v * covered).sum() / covered.sum())
    assert middle == pytest.approx((33.0, 42.0), abs=0.5)


@pytest.mark.parametrize("name", SHAPES)
def test_a_shape_moves_with_its_coordinates_and_is_cut_off_at_the_edge(name: str):
    draw = SHAPES[name][0]
    middle = cover(draw, 40.0, 40.0)
    for right, down in ((7, 0), (0, -9), (-35, 20), (38, 38)):
        rows, columns = np.indices(middle.shape)
        was = rows - down, columns - right
        inside = (was[0] >= 0) & (was[0] < SIDE) & (was[1] >= 0) & (was[1] < SIDE)
        expected = np.where(inside, middle[was[0] % SIDE, was[1] % SIDE], 0.0)
        moved, inner = cover(draw, 40.0 + right, 40.0 + down), np.s_[3:-3, 3:-3]
        np.testing.assert_allclose(moved[inner], expected[inner], atol=0.02)


@pytest.mark.parametrize("far", [1e6, -1e9, 1e300])
def test_what_is_far_outside_is_not_seen(far: float):
    for name in ("polygon", "ring", "see-through polygon"):
        assert not cover(SHAPES[name][0], far, 40.0).any()


def test_areas_that_two_outlines_cover_stay_empty():
    square = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    outlines = [square * half + 40.0 for half in (20.0, 8.0)]
    covered = cover(lambda image, u, v: shapes.polygon(image, outlines, WHITE), 0.0, 0.0)
    assert covered[40, 40] == 0.0
    assert covered[40, 25] == covered[25, 40] == 1.0


@pytest.mark.parametrize(("dash", "gap"), [(4.0, 2.0), (3.0, 3.0), (50.0, 1.0)])
def test_dashes_and_gaps_follow_a_line_around_its_corners(dash: float, gap: float):
    corners = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]])
    pieces = shapes.dashes(corners, dash, gap)
    assert len(pieces) == math.ceil(20.0 / (dash + gap))
    for k, piece in enumerate(pieces):
        start, length = k * (dash + gap), np.hypot(*np.diff(piece, axis=0).T).sum()
        assert length == pytest.approx(min(dash, 20.0 - start))
        assert piece[0] == pytest.approx((min(start, 10.0), max(start - 10.0, 0.0)))
