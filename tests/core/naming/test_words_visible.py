import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.core.naming.words import visible


@pytest.mark.parametrize(
    ("hidden", "shown"),
    [
        ("\x1b[31mred", r"\x1b[31mred"),
        ("\x9b31m", r"\x9b31m"),
        ("a\tb\rc", r"a\tb\rc"),
        ("\u202egnp.exe", r"\u202egnp.exe"),
        ("\u2066a\u2069", r"\u2066a\u2069"),
        ("half \udc80", r"half \udc80"),
        ("two\nlines", "two\nlines"),
        ("L-förmiges Sofa, 沙发, أريكة, 🛋️", "L-förmiges Sofa, 沙发, أريكة, 🛋️"),
    ],
)
def test_what_a_terminal_obeys_is_shown(hidden: str, shown: str):
    assert visible(hidden) == shown


@given(st.text(st.characters(codec=None)))
def test_nothing_is_obeyed_and_showing_twice_changes_nothing(text: str):
    shown = visible(text)
    assert visible(shown) == shown
    assert not any(unicodedata.category(one) in {"Cc", "Cs"} for one in shown if one != "\n")
    assert not any(unicodedata.bidirectional(one) in {"RLO", "LRO", "RLE"} for one in shown)
    shown.encode("utf-8")
