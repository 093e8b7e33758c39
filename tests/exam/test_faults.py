"""What is systematically wrong is named with the things that it happens with."""

from answers import boxed

from hypernav.exam.faults import faults_of

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
