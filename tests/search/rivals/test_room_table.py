"""The table of what stands in which kind of room."""

import numpy as np
import pytest

from hypernav.search.rivals.room_table import room_table

TABLE = room_table()


def test_a_chance_is_one_and_no_thing_is_impossible():
    for name, chances in TABLE.chances.items():
        assert chances.shape == (len(TABLE.kinds),), name
        assert (chances > 0.0).all(), name
        assert (chances < 1.0).all(), name


@pytest.mark.parametrize(
    ("name", "room"),
    [
        ("toilet", "bathroom"),
        ("bed", "bedroom"),
        ("oven", "kitchen"),
        ("server rack", "server room"),
    ],
)
def test_a_thing_is_likeliest_in_its_room(name, room):
    assert TABLE.kinds[TABLE.chances[name].argmax()] == room


@pytest.mark.parametrize("text", ["fridge", "the big refrigerator", "Refrigerators"])
def test_other_words_for_a_thing_say_the_same(text):
    assert TABLE.of_thing(text) == "refrigerator"


def test_of_an_unknown_thing_nothing_is_known():
    assert TABLE.of_thing("gramophone") is None


def test_what_stands_everywhere_tells_less_than_what_names_a_room():
    def spread(name):
        chances = TABLE.chances[name]
        return float(np.log(chances / chances.mean()).max())

    assert spread("chair") < spread("toilet")
