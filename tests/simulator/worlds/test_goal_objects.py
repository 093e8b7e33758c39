"""The objects that an episode's file names are goals, whatever the annotators called them."""

import pytest

from hypernav.core.episode import Episode, ObjectName
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.world import Instance
from hypernav.simulator.worlds.goal_objects import named_as_goals

BOX = ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
SCENE = (
    Instance(0, "building", None, *BOX),
    Instance(1, "flat screen_7", ObjectLabel("flat screen"), *BOX),
    Instance(2, "tv_12", ObjectLabel("tv"), *BOX),
    Instance(3, "curtain_30", ObjectLabel("curtain", ("drape",)), *BOX),
    Instance(4, "wall_31", None, *BOX),
)


def goals(*objects, text="tv"):
    """Numbers of the instances that are the goal, and whether the others stay as they were."""
    episode = Episode("x", "0", Goal(text), Pose2(0.0, 0.0, 0.0), objects=objects)
    found = named_as_goals(SCENE, episode)
    assert [instance.id for instance in found] == list(range(len(SCENE)))
    are = [i.id for i in found if i.label is not None and i.label.satisfies(episode.goal)]
    assert all(found[n] == SCENE[n] for n in range(len(SCENE)) if n not in are)
    return are


@pytest.mark.parametrize(
    ("objects", "expected"),
    [
        ([], [2]),
        ([ObjectName("flat screen_7", 7)], [1, 2]),
        ([ObjectName("television_7", 7)], [1, 2]),
        ([ObjectName(None, 7)], [1, 2]),
        ([ObjectName("flat screen_7", None)], [1, 2]),
        ([ObjectName("tv_12", 12)], [2]),
        ([ObjectName("wall_31", 31)], [2, 4]),
        ([ObjectName("nothing_99", 99), ObjectName(None, None)], [2]),
    ],
)
def test_a_goal_is_what_is_called_so_and_what_the_file_names(objects, expected):
    assert goals(*objects) == expected


def test_the_name_comes_before_the_number():
    assert goals(ObjectName("curtain_30", 7)) == [2, 3]


def test_the_annotators_words_stay():
    episode = Episode(
        "x", "0", Goal("tv"), Pose2(0.0, 0.0, 0.0), objects=(ObjectName("curtain_30", 30),)
    )
    label = named_as_goals(SCENE, episode)[3].label
    assert label is not None
    assert label.category == "curtain"
    assert label.synonyms == ("drape", "tv")
