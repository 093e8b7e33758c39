import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.core.naming.labels import _ALIKE, _KINDS, normalise
from hypernav.core.naming.words import first_sentence, noun_phrase, without_lead_in
from hypernav.search.models.closed_set import COCO_CLASSES

DESCRIPTIONS = {
    "The couch is located near the window and is surrounded by two plants.": "couch",
    "A white refrigerator in the kitchen, next to the oven": "white refrigerator",
    "The bed has a blue blanket and is positioned against the wall opposite the door.": "bed",
    "This is a grey sofa. It stands under the window.": "grey sofa",
    "It is a grey sofa located to the left of the table lamp": "grey sofa",
    "sofa with cushions next to a side table": "sofa",
    "There is a black and white armchair facing the tv.": "black and white armchair",
    "In the living room, there is a large, brown leather couch with three pillows.": (
        "large brown leather couch"
    ),
    "On the wall hangs a picture of a horse.": "picture",
    "The object is a tall, wooden bookshelf that stands against the wall.": "tall wooden bookshelf",
    "Find the object: a sofa": "sofa",
    "A lamp hanging directly over the dining table.": "lamp",
    "The washing machine is next to the dryer, in the laundry room.": "washing machine",
    "One of the chairs around the table": "chairs",
    "It's the toilet in the bathroom. It is white.": "toilet",
    "The potted plant on the right side of the tv stand": "potted plant",
    "The tv stands in the corner, above a wooden tv stand.": "tv",
    "Next to the bed is a nightstand with a lamp.": "nightstand",
    "Please find the dresser (the white one)": "dresser",
    "The armchair, a red one, sits in front of the bookshelf.": "armchair",
    "The sink is made of stone but has a metal tap.": "sink",
    "Chest of drawers which holds a vase and two candles.": "chest of drawers",
    "the red chair left of the sofa": "red chair",
    "Locate the trash can under the desk": "trash can",
}
"""Descriptions in the style of GOAT-Bench, each with the words that name its object."""
NAMES = [
    *COCO_CLASSES,
    *(name for row in _ALIKE for name in row),
    *(name for wider, kinds in _KINDS.items() for name in (wider, *kinds)),
    *("chest of drawers", "box of tissues", "side table", "tv stands", "trash can"),
    *(
        "hanging lamp",
        "walk in closet",
        "built in oven",
        "television set",
        "floor to ceiling window",
    ),
]


def named(text: str) -> str:
    return noun_phrase(first_sentence(without_lead_in(normalise(text))))


@pytest.mark.parametrize(("description", "words"), DESCRIPTIONS.items())
def test_a_description_is_read_up_to_the_name_of_its_object(description, words):
    assert named(description) == words


@pytest.mark.parametrize("name", NAMES)
def test_a_name_stays_whole(name):
    assert named(name) == normalise(name)


def test_a_thing_is_named_without_what_it_has():
    assert named("stool with wheels") == "stool"
    assert named("chair made of wood") == "chair"


@given(st.text(max_size=60))
def test_the_words_that_name_a_thing_are_words_of_the_text(text):
    text = normalise(text)
    assert set(named(text)) <= set(text)
