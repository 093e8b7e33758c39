"""Contrasts are those of WCAG 2.2, and what must be read has enough."""

from colorsys import rgb_to_hsv

import numpy as np
import pytest

from hypernav.search.drawing import palette
from hypernav.search.drawing.palette import Rgb, blend, contrast, ink_on, luminance

OKABE_ITO = [
    *((0, 114, 178), (230, 159, 0), (0, 158, 115)),
    *((204, 121, 167), (86, 180, 233), (213, 94, 0)),
]
BLACK, WHITE, GREY = (0, 0, 0), (255, 255, 255), (119, 119, 119)


@pytest.mark.parametrize(
    ("a", "b", "ratio"),
    [
        (BLACK, WHITE, 21.0),
        (GREY, WHITE, 4.48),
        (GREY, BLACK, 4.69),
        ((255, 0, 0), WHITE, 4.0),
        ((0, 0, 255), WHITE, 8.59),
        ((0, 255, 0), BLACK, 15.3),
        ((8, 8, 8), BLACK, 1.05),
        (GREY, GREY, 1.0),
    ],
)
def test_contrasts_are_those_of_the_standard_in_either_order(a: Rgb, b: Rgb, ratio: float):
    assert contrast(a, b) == contrast(b, a) == pytest.approx(ratio, abs=0.005)


def test_white_has_the_luminance_1_and_black_0():
    assert (luminance(WHITE), luminance(BLACK)) == (pytest.approx(1.0), 0.0)


def test_ink_is_readable_on_every_colour_that_words_stand_on():
    for color in (*palette.MODES.values(), palette.PAPER, palette.GROUND):
        assert contrast(ink_on(color), color) >= 4.5
    for color in (palette.INK, palette.MUTED, palette.STAIRS, palette.FAILURE, palette.SUCCESS):
        assert contrast(color, palette.PAPER) >= 4.5
    assert contrast(palette.UNKNOWN_STRONG, WHITE) >= 3.0


def test_the_colours_of_series_are_those_of_okabe_and_ito_or_darker_ones_of_their_hues():
    for color, published in zip(palette.SERIES, OKABE_ITO, strict=False):
        assert (np.array(color) <= published).all()
        hue, published_hue = (360.0 * rgb_to_hsv(*rgb)[0] for rgb in (color, published))
        assert hue == pytest.approx(published_hue, abs=7.0)


def test_a_mixture_begins_with_one_colour_and_ends_with_the_other():
    assert blend(BLACK, (10, 200, 255), 0.0) == BLACK
    assert blend(BLACK, (10, 200, 255), 0.25) == (2, 50, 64)
    assert blend(BLACK, (10, 200, 255), 1.0) == (10, 200, 255)


def test_every_colour_is_of_three_bytes():
    for name, color in vars(palette).items():
        if isinstance(color, tuple):
            colors = np.array(color)
            assert colors.shape[-1] == 3, name
            assert ((colors >= 0) & (colors <= 255)).all(), name
