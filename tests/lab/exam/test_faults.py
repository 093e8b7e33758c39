"""What is systematically wrong is named with the things that it happens with."""

from exam_answers import answered, boxed
from hypernav.lab.exam.faults import faults_of

ELSEWHERE = (100.0, 10.0, 140.0, 40.0)


def told(with_box: int, without: int) -> list[str]:
    answers = [boxed("look-alike", ELSEWHERE)] * with_box + [boxed("absent", None)] * without
    return [f"{one.check}: {one.said}" for one in faults_of(answers, "model", "pixels")]


def test_things_that_are_taken_for_the_goal_are_named():
    (one,) = told(8, 16)
    assert one.startswith("takes other things for the goal: it gives a box in 33% of 24 images")
    assert "sofa for bed (8 of 8)" in one
    assert "oven" not in one


def test_few_of_them_are_chance():
    assert told(1, 16) == told(0, 16) == []


def test_a_box_in_most_images_is_one_fault_not_two():
    (one,) = told(16, 4)
    assert one.startswith("ignores absence")


def names_of(stratum: str, right: list[str], *chosen: str) -> set[str]:
    """Faults of answers to the question in which images the goal is."""
    answers = [answered("images", stratum, right=right, chosen=one) for one in chosen]
    return {one.check for one in faults_of(answers, "model", "pixels")}


def test_who_names_an_image_where_none_shows_the_goal_is_named():
    assert names_of("none", ["none"], *["1", "2, 5"] * 6) == {"names images without the goal"}
    assert not names_of("none", ["none"], *["4"] * 3, *["none"] * 9)


def test_who_always_names_the_first_image_is_named():
    assert names_of("shown", ["3"], *["1"] * 12) == {"prefers image 1"}
    assert not names_of("shown", ["1"], *["1"] * 12)
    assert not names_of("shown", ["3", "4"], *["3", "4, 3", "1, 2", "none"] * 3)
