"""The table of what stands in which kind of room."""

import numpy as np
import pytest

from hypernav.core.goal import Goal
from hypernav.perception.rooms.room_table import room_table

TABLE = room_table()


def kind(name):
    return TABLE.numbers[name]


def test_every_row_of_neighbours_is_a_distribution():
    assert TABLE.beside.sum(axis=1) == pytest.approx(np.ones(len(TABLE.kinds)))
    assert (TABLE.beside >= 0.0).all()


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
def test_a_goal_is_densest_in_its_room(name, room):
    densities = TABLE.densities(Goal(name))
    assert densities is not None
    assert densities.argmax() == kind(room)
    assert densities.mean() == pytest.approx(1.0)


@pytest.mark.parametrize("text", ["fridge", "the big refrigerator", "Refrigerators"])
def test_other_words_for_a_thing_say_the_same(text):
    assert TABLE.of_thing(text) == "refrigerator"


def test_a_room_in_the_goal_counts_where_the_thing_is_not_the_last_word():
    densities = TABLE.densities(Goal("the umbrella in the home office"))
    assert densities is not None
    assert densities.argmax() == kind("study")


def test_of_an_unknown_goal_nothing_is_known():
    assert TABLE.densities(Goal("gramophone")) is None


def test_what_stands_everywhere_tells_less_than_what_names_a_room():
    def spread(name):
        chances = TABLE.chances[name]
        return float(np.log(chances / chances.mean()).max())

    assert spread("chair") < spread("toilet")
