import numpy as np

from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.world import Instance
from hypernav.simulator.houses.episodes.queries import near_misses
from hypernav.simulator.worlds.scenes.scene import Scene

LABELS = (
    ObjectLabel("armchair", ("arm chair",), ("red",), "office"),
    ObjectLabel("armchair", ("arm chair",), ("blue",), "office"),
    ObjectLabel("armchair", ("arm chair",), ("red",), "living room"),
    ObjectLabel("sofa", ("L-shaped sofa",), ("L-shaped", "gray"), "living room"),
    ObjectLabel("sofa", (), ("gray",), "living room"),
    ObjectLabel("curtain", ("window curtain",), ("white",), "bedroom"),
    ObjectLabel("shower curtain", (), ("white",), "bathroom"),
    ObjectLabel("washing machine", (), ("white",), "laundry"),
    ObjectLabel("clothes dryer", (), ("white",), "laundry"),
    ObjectLabel("toilet", (), ("white",), "bathroom"),
    None,
)


def scene() -> Scene:
    n = len(LABELS)
    origin = (0.0, 0.0, 0.0)
    return Scene(
        "labels only",
        np.zeros((3, 3), np.float32),
        np.zeros((1, 3), np.int32),
        np.zeros((1, 3, 2), np.float32),
        np.zeros((1, 3, 3), np.uint8),
        None,
        np.zeros(1, np.int32),
        np.zeros(1, np.int32),
        (),
        tuple(Instance(k, f"object {k}", LABELS[k], origin, origin) for k in range(n)),
    )


def missed(text: str) -> set[int]:
    return {i.id for i in near_misses(scene().instances, Goal(text))}


def test_the_wrong_colour_and_the_wrong_room_are_near():
    assert missed("the red armchair in the office") >= {1, 2}
    assert 0 not in missed("the red armchair in the office")


def test_a_plain_sofa_is_near_an_l_shaped_one():
    assert 4 in missed("L-shaped sofa")
    assert 3 not in missed("L-shaped sofa")


def test_the_last_word_makes_objects_confusable():
    assert 6 in missed("window curtain")
    assert 5 in missed("shower curtain")


def test_kinds_that_look_alike_are_near():
    assert missed("washing machine") == {8}


def test_other_objects_are_far():
    assert missed("toilet") == set()
    assert 9 not in missed("armchair")


def test_a_goal_that_nothing_satisfies_has_near_misses_too():
    assert missed("green armchair") == {0, 1, 2, 3, 4}
