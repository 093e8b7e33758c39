"""GOAT-Bench's files, as another writer makes them."""

import gzip
import json
import math

import numpy as np
import pytest

from certainty import certain
from hypernav.core.errors import EpisodeError
from hypernav.lab.datasets.goat import (
    LONG_DESCRIPTION,
    goal_type_words,
    goal_types_in,
    goat_parts,
    of_types,
)
from scan_writers.episodes import write_json
from scan_writers.goat import goat_life, goat_object, write_goat

SCENE = "hm3d/val/00802-wcojb4TFT35/wcojb4TFT35.basis.glb"
START = (1.0, 2.0, 0.5)
CHAIRS = [
    goat_object("chair_1", "chair", (3.0, 1.0, 0.4), [(2.5, 1.0, 0.5)], "a red chair"),
    goat_object("chair_2", "chair", (6.0, 1.0, 0.4), [(5.5, 1.0, 0.5)], "word " * 55 + "more"),
]
FURNITURE = [
    *CHAIRS,
    goat_object("sofa_3", "sofa", (9.0, 1.0, 0.4), [(8.5, 1.0, 0.5)], "", children=["chair"]),
]
TASKS = [
    ("chair", "object", None, None, None),
    ("chair", "description", "chair_1", None, None),
    ("chair", "image", "chair_2", "x", 1),
    ("chair", "description", "chair_2", None, None),
    ("sofa", "object", None),
]


def written(folder, tasks=TASKS, objects=FURNITURE):
    return write_goat(folder / "val_unseen", [goat_life(7, SCENE, START, tasks)], objects)


def goals(folder, **values):
    path = written(folder, **values)
    (part,) = goat_parts(path.parents[1])
    return part


def test_every_task_is_a_goal_of_a_life_with_its_type(tmp_path):
    found = goals(tmp_path)
    assert [e.group for e in found] == [
        *("object", "description", "image", LONG_DESCRIPTION, "object")
    ]
    assert [e.goal.text for e in found[:2]] == ["chair", "a red chair"]
    assert {e.life for e in found} == {"0"}  # the number in the file, not its own name
    assert [e.episode_id for e in found] == [f"0.{k}" for k in range(1, 6)]
    assert {e.scene_id for e in found} == {SCENE}


def test_the_start_is_in_our_frame(tmp_path):
    first = goals(tmp_path)[0]
    assert (first.start.x, first.start.y, first.start_z) == START
    assert math.isclose(first.start.yaw, 0.0, abs_tol=1e-9)


def test_a_category_is_reached_at_any_of_its_objects_and_a_description_at_one(tmp_path):
    any_chair, red_chair, *_, sofa = goals(tmp_path)
    assert np.allclose(certain(any_chair.view_points), [(2.5, 1.0, 0.5), (5.5, 1.0, 0.5)])
    assert np.allclose(certain(red_chair.view_points), [(2.5, 1.0, 0.5)])
    assert [one.name for one in red_chair.objects] == ["chair_1"]
    assert [one.name for one in sofa.objects] == ["sofa_3", "chair_1", "chair_2"]  # its child


def test_a_description_of_55_words_is_kept(tmp_path):
    chair = goat_object("chair_1", "chair", (3.0, 1.0, 0.4), [(2.5, 1.0, 0.5)], " ".join("w" * 55))
    (found,) = goals(tmp_path, tasks=[("chair", "description", "chair_1")], objects=[chair])
    assert found.group == "description"


@pytest.mark.parametrize(
    ("task", "message"),
    [
        (("bed", "object", None), "episode 0, task 1: expected one entry of 'bed'.*found 0"),
        (("chair", "image", "chair_9"), "episode 0, task 1: 'chair' has no object 'chair_9'"),
        (("sofa", "description", "sofa_3"), "episode 0, task 1: the goal is empty"),
        (("chair", "sound", None), r"episode file-7, field 'tasks\[0\]"),
        (("chair",), r"episode file-7, field 'tasks\[0\]"),
    ],
)
def test_what_a_file_lacks_is_named_with_file_and_episode(tmp_path, task, message):
    path = written(tmp_path, tasks=[task])
    with pytest.raises(EpisodeError, match=f"{path.name}: {message}"):
        list(goat_parts(path.parents[1]))


def test_files_without_episodes_and_scenes_in_two_files_are_refused(tmp_path):
    path = written(tmp_path)
    write_json(path.with_name("again.json.gz"), json.loads(_text(path)))
    with pytest.raises(EpisodeError, match="another file holds episodes of hm3d/val/00802"):
        list(goat_parts(path.parents[1]))
    for file in path.parent.iterdir():
        write_json(file, {"episodes": []})
    with pytest.raises(EpisodeError, match="no file holds an episode"):
        list(goat_parts(path.parents[1]))


def _text(path):
    return gzip.decompress(path.read_bytes())


def test_goals_of_other_types_are_counted(tmp_path):
    kept, left_out = of_types(goals(tmp_path), goal_types_in(""))
    assert [e.episode_id for e in kept] == ["0.1", "0.2", "0.5"]
    assert left_out == {"image": 1, LONG_DESCRIPTION: 1}
    assert goal_type_words({"image": 1, "object": 1200}) == "1 image goal, 1,200 category goals"
    with pytest.raises(EpisodeError, match="none of the 1 chosen goals is of description"):
        of_types(kept[:1], ["description"])


@pytest.mark.parametrize(
    ("text", "message"), [("image", "can't be run yet"), ("objekt", "there is no 'objekt'")]
)
def test_goal_types_that_cannot_be_run_are_refused(text, message):
    with pytest.raises(EpisodeError, match=message):
        goal_types_in(text)


def test_goal_types_are_named_with_commas():
    assert goal_types_in("description, object") == ("description", "object")
    assert goal_types_in("object") == ("object",)


def test_a_life_of_three_hundred_thousand_goals_is_refused(tmp_path):
    """A bound that real lives are far from: else a file of 50 kB takes a minute to read."""
    with pytest.raises(EpisodeError, match="field 'tasks': list should have at most 1000 items"):
        goals(tmp_path, tasks=[("chair", "object", None)] * 300_000)
