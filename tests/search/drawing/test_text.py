import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.search.drawing import palette
from hypernav.search.drawing.text import draw_text, shortened, text_width, wrapped

texts = st.text(st.characters(codec="utf-8"), max_size=200)


@given(texts, st.floats(60.0, 400.0), st.integers(1, 4))
def test_wrapped_lines_fit(text: str, width: float, lines: int) -> None:
    broken = wrapped(text, 13, width, lines=lines)
    assert len(broken) <= lines
    assert all(text_width(line, 13) <= width for line in broken)


@given(st.lists(st.text("abcdefg", min_size=1, max_size=8), max_size=25))
def test_wrapping_loses_no_word_where_there_is_room(words: list[str]) -> None:
    broken = wrapped(" ".join(words), 13, 120.0, lines=100)
    assert " ".join(broken).split() == words


@given(texts, st.floats(20.0, 300.0))
def test_a_shortened_text_fits_and_says_that_it_was_cut(text: str, width: float) -> None:
    short = shortened(text, 14, width, bold=True)
    assert text_width(short, 14, bold=True) <= width
    whole = shortened(text, 14, 1e9, bold=True)
    assert short == whole or short.endswith("…")


def test_a_prompt_of_any_length_is_cut_to_its_lines() -> None:
    broken = wrapped("word " * 100_000, 13, 300.0, lines=2)
    assert len(broken) == 2
    assert broken[-1].endswith("…")


def test_a_word_wider_than_the_line_is_broken() -> None:
    broken = wrapped("x" * 100, 13, 100.0, lines=50)
    assert "".join(broken) == "x" * 100


@pytest.mark.parametrize("at", [(-30.0, -5.0), (95.0, 45.0), (50.0, 1000.0), (-1e5, 20.0)])
def test_text_outside_the_image_is_cut_off(at: tuple[float, float]) -> None:
    image = np.zeros((50, 100, 3), dtype=np.uint8)
    draw_text(image, "hello", at, 16, color=palette.PAPER, halo=palette.ROBOT)
    assert image.shape == (50, 100, 3)


@pytest.mark.parametrize("align", [0.0, 0.5, 1.0])
def test_text_stands_where_it_is_aligned(align: float) -> None:
    image = np.zeros((60, 300, 3), dtype=np.uint8)
    draw_text(image, "HHHH", (150.0, 30.0), 20, color=palette.PAPER, align=align)
    inked = np.argwhere(image.any(axis=2))
    left, right = inked[:, 1].min(), inked[:, 1].max() + 1
    assert left + align * (right - left) == pytest.approx(150.0, abs=3.0)
    assert (inked[:, 0].min() + inked[:, 0].max() + 1) / 2 == pytest.approx(30.0, abs=1.5)


def test_a_halo_surrounds_the_letters_on_all_sides() -> None:
    image = np.zeros((60, 100, 3), dtype=np.uint8)
    draw_text(image, "8", (50.0, 30.0), 24, color=(255, 0, 0), halo=(0, 0, 255), halo_px=3)
    letters = np.argwhere(image[..., 0] > 128)
    halo = np.argwhere(image[..., 2] > 128)
    assert (letters.min(axis=0) - halo.min(axis=0) >= 2).all()
    assert (halo.max(axis=0) - letters.max(axis=0) >= 2).all()


def test_letters_of_many_scripts_and_control_characters_can_be_drawn() -> None:
    image = np.zeros((40, 400, 3), dtype=np.uint8)
    for text in ("", "żółw", "диван", "椅子", "كرسي", "🛋️", "\u200b", "a\nb\tc", "\x00"):
        draw_text(image, shortened(text, 16, 300.0), (5.0, 20.0), 16, color=palette.PAPER)
    assert image.any()
