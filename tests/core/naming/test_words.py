import unicodedata

import pytest

from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel, same_name
from hypernav.core.naming.words import caseless, words_within


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("床_01", ["床"]),
        ("床01", ["床"]),
        ("Küchentisch", ["küchentisch"]),
        ("Stühle.002", ["stühle"]),
        ("ÜberTisch2", ["über", "tisch"]),
        ("TVCabinet", ["tv", "cabinet"]),
        ("ΚΡΕΒΆΤΙ_1", ["κρεβάτι"]),
        ("कुर्सी-3", ["कुर्सी"]),
        ("می\u200cز", ["می\u200cز"]),
        ("Bed\u200b", ["bed"]),
        ("sofa２", ["sofa"]),
        ("", []),
    ],
)
def test_words_of_any_script(name: str, words: list[str]) -> None:
    assert words_within(name) == words
    assert words_within(unicodedata.normalize("NFD", name)) == words


def test_names_match_whatever_their_case_and_composition() -> None:
    assert caseless("STRASSE") == caseless("Straße")
    decomposed = unicodedata.normalize("NFD", "Küchentisch")
    assert same_name(decomposed, "KÜCHENTISCH")
    assert Goal(decomposed).text == "Küchentisch"
    assert ObjectLabel("küchentisch").satisfies(Goal(decomposed))
    assert ObjectLabel("床").satisfies(Goal("床"))
    assert not ObjectLabel("küchentisch").satisfies(Goal("kuchentisch"))
