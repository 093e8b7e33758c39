"""Things that are remembered: what is one thing, and what images without it say."""

from dataclasses import replace

import numpy as np
import pytest

from box_views import CAMERA, room, view_of
from certainty import certain
from hypernav.core.embodiment import CameraConfig
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.search.memory.floor import SearchMemory, counted_from
from hypernav.search.memory.thing import Thing
from hypernav.search.memory.things import MOST_THINGS, Things

SENSOR = CameraConfig(width=CAMERA.width, height=CAMERA.height)
HALL = room(8.0, 6.0)
SOFA = ((4.0, 2.4, 0.0), (4.35, 3.6, 0.8))


def looks_at(robot: Pose2, solid=SOFA, label: str = "sofa", score: float = 1.0):
    """An image of a box in the hall, and the detection of all its pixels."""
    seen, without = view_of([*HALL, solid], robot), view_of(HALL, robot)
    mask = seen.depth != without.depth
    rows, columns = np.nonzero(mask)
    if not len(rows):
        return seen, []
    box = Box(float(columns.min()), float(rows.min()), columns.max() + 1.0, rows.max() + 1.0)
    return seen, [Detection(box, score, label, mask)]


def after(things: Things, robot: Pose2, *, search: int = 1, only=None, **what) -> Things:
    image, detections = looks_at(robot, **what)
    return things.after_image(image, detections, SENSOR, search=search, only=only)


def test_a_thing_lies_where_it_was_seen():
    (sofa,) = after(Things(), Pose2(2.0, 3.0, 0.0)).known
    assert sofa.low[0] == pytest.approx(4.0, abs=0.1)
    assert (sofa.low[1], sofa.high[1]) == pytest.approx((2.4, 3.6), abs=0.15)
    assert sofa.seen_from == (2.0, 3.0)


def test_a_mask_that_holds_a_little_of_what_is_behind_makes_a_thing_no_larger():
    image, (detection,) = looks_at(Pose2(2.0, 3.0, 0.0))
    sofa, box = certain(detection.mask), detection.box
    wide = replace(box, x_min=box.x_min - 60.0, x_max=box.x_max + 60.0)
    beside = wide.mask(*sofa.shape[::-1]) & ~sofa & (image.depth > 3.0) & (image.depth < 4.5)
    stray = np.argwhere(beside)[:: int(beside.sum() / (0.01 * sofa.sum()))]
    mask = sofa.copy()
    mask[tuple(stray.T)] = True
    bleeding = [replace(detection, box=wide, mask=mask)]
    (thing,) = Things().after_image(image, bleeding, SENSOR, search=1).known
    assert len(stray) > 20
    assert thing.high[0] < 4.5


def test_views_from_two_sides_are_one_thing_as_large_as_both_show_it():
    things = after(after(Things(), Pose2(2.0, 3.0, 0.0)), Pose2(7.0, 3.0, np.pi))
    (sofa,) = things.known
    assert (sofa.low[0], sofa.high[0]) == pytest.approx((4.0, 4.35), abs=0.1)
    assert (sofa.seen, sofa.number, things.count) == (2, 0, 1)


def test_another_label_or_another_place_is_another_thing():
    things = after(Things(), Pose2(2.0, 3.0, 0.0))
    assert len(after(things, Pose2(2.0, 3.0, 0.0), label="bench").known) == 2
    moved = after(things, Pose2(2.0, 3.0, 0.0), solid=((4.0, 0.2, 0.0), (5.0, 1.4, 0.8)))
    assert len(moved.known) == 2


def test_names_that_mean_the_same_are_one_thing():
    things = after(Things(), Pose2(2.0, 3.0, 0.0), label="couch")
    assert len(after(things, Pose2(2.1, 3.0, 0.0), label="sofa").known) == 1


def test_a_detection_without_depth_is_no_thing():
    image, (detection,) = looks_at(Pose2(2.0, 3.0, 0.0))
    blind = replace(image, depth=np.zeros_like(image.depth))
    assert Things().after_image(blind, [detection], SENSOR, search=1).known == ()


@pytest.mark.parametrize("ground_m", [2.6, -3.2])
def test_what_is_seen_of_another_floor_is_no_thing_of_this_one(ground_m: float):
    image, detections = looks_at(Pose2(2.0, 3.0, 0.0))
    seen = counted_from(ground_m, image)
    told = Things().after_image(seen, detections, SENSOR, search=1, tells_floors=True)
    assert told.known == ()
    assert len(Things().after_image(seen, detections, SENSOR, search=1).known) == 1


@pytest.mark.parametrize(("ground_m", "known"), [(0.9, 1), (0.0, 0)])
def test_from_a_raised_level_what_stands_on_the_floor_is_a_thing_of_it(ground_m: float, known: int):
    image, detections = looks_at(Pose2(2.0, 3.0, 0.0))
    seen = counted_from(1.0 - ground_m, image)  # it stands 1 m below the robot's ground
    after_it = Things().after_image(
        seen, detections, SENSOR, search=1, tells_floors=True, ground_m=ground_m
    )
    assert len(after_it.known) == known


def test_without_a_mask_what_stands_far_behind_the_middle_does_not_count():
    image, (detection,) = looks_at(Pose2(2.0, 3.0, 0.0), solid=((4.0, 2.9, 0.0), (4.3, 3.1, 1.2)))
    wide = Box(detection.box.x_min - 60, detection.box.y_min, detection.box.x_max + 60, 200.0)
    (pole,) = Things().after_image(image, [Detection(wide, 0.8, "pole")], SENSOR, search=1).known
    assert pole.high[0] < 4.7


def test_images_without_a_thing_that_should_show_it_make_it_gone_and_a_new_one_brings_it_back():
    things = Things()
    for x in (1.0, 1.5, 2.0):
        things = after(things, Pose2(x, 3.0, 0.0))
    chances = [things.known[0].chance]
    for x in (1.2, 1.6, 2.0):
        image = view_of(HALL, Pose2(x, 3.0, 0.0))
        things = things.after_image(image, [], SENSOR, search=2)
        chances.append(things.known[0].chance)
    assert chances == sorted(chances, reverse=True)
    assert things.known[0].is_gone
    assert things.fitting(Goal("sofa")) == []
    (back,) = after(things, Pose2(2.0, 3.0, 0.0), search=2).known
    assert (back.missed, back.overlooked, back.is_gone) == (0, 3, False)


def test_the_best_score_tells_the_chance_and_further_images_of_it_do_not():
    weak = Thing(0, "cup", 0.45, (0, 0, 0), (1, 1, 1), ((0, 0, 1),), 1.0, 1, 1)
    assert weak.chance == replace(weak, seen=20).chance < 0.25
    assert replace(weak, score=0.8).chance > 0.5
    assert 0.85 < replace(weak, score=1.0).chance < 0.9


def test_a_miss_says_less_of_a_thing_that_was_often_overlooked():
    often = Thing(0, "cup", 0.9, (0, 0, 0), (1, 1, 1), ((0, 0, 1),), 1.0, 1, 1, seen=5, missed=2)
    assert replace(often, overlooked=5).chance > often.chance


@pytest.mark.parametrize(
    ("robot", "why"),
    [
        (Pose2(2.0, 3.0, np.pi), "it is behind the robot"),
        (Pose2(0.3, 0.3, 0.6), "it is too far away"),
        (Pose2(7.0, 3.0, np.pi), "it was seen from the other side alone, and may be behind a wall"),
    ],
)
def test_an_image_that_need_not_show_a_thing_is_no_miss(robot, why):
    things = after(Things(), Pose2(2.0, 3.0, 0.0))
    image = view_of(HALL, robot)
    assert things.after_image(image, [], SENSOR, search=1).known[0].missed == 0, why


def test_what_stands_before_it_hides_it():
    things = after(Things(), Pose2(2.0, 3.0, 0.0))
    screen = ((3.0, 1.5, 0.0), (3.1, 4.5, 2.0))
    image = view_of([*HALL, SOFA, screen], Pose2(2.0, 3.0, 0.0))
    assert things.after_image(image, [], SENSOR, search=1).known[0].missed == 0


def test_a_detector_that_looks_for_beds_alone_misses_no_sofa():
    things = after(Things(), Pose2(2.0, 3.0, 0.0))
    image = view_of(HALL, Pose2(2.0, 3.0, 0.0))
    one = things.after_image(image, [], SENSOR, search=1, only=Goal("bed"))
    assert one.known[0].missed == 0
    one = things.after_image(image, [], SENSOR, search=1, only=Goal("couch"))
    assert one.known[0].missed == 1


def test_one_that_is_not_the_red_sofa_is_not_missed_and_known_as_another():
    things = after(Things(), Pose2(2.0, 3.0, 0.0))
    image, red = view_of([*HALL, SOFA], Pose2(2.0, 3.0, 0.0)), Goal("red sofa")
    things = things.after_image(image, [], SENSOR, search=1, only=red)
    assert things.known[0].missed == 0
    assert things.others_in(image, red) == {0}
    assert things.others_in(image, Goal("sofa")) == set()
    assert after(things, Pose2(2.0, 3.0, 0.0)).others_in(image, red) == set()


def test_what_lies_where_the_goal_was_detected_may_be_it():
    things = after(Things(), Pose2(2.0, 3.0, 0.0))
    image, detections = looks_at(Pose2(2.0, 3.0, 0.0), label="red sofa")
    red = Goal("red sofa")
    things = things.after_image(image, detections, SENSOR, search=2, only=red)
    assert [one.label for one in things.known] == ["sofa", "red sofa"]
    assert things.others_in(image, red) == set()


def test_one_image_alone_rules_out_no_thing_that_was_surely_seen():
    things, red = Things(), Goal("red sofa")
    for x in (1.0, 1.5, 2.0):
        things = after(things, Pose2(x, 3.0, 0.0))
    search = SearchMemory()
    search.note_others({0}, things, red)
    assert search.done == set()
    for _ in range(2):
        search.note_others({0}, things, red)
    assert search.done == {0}


def test_no_image_rules_out_the_one_that_is_meant():
    things = after(Things(), Pose2(2.0, 3.0, 0.0))
    search = SearchMemory(meant=things.known[0])
    for _ in range(5):
        search.note_others({0}, things, Goal("red sofa"))
    assert search.done == set()


def test_where_something_has_the_goal_s_own_name_others_of_its_kind_are_no_candidates():
    things = after(Things(), Pose2(2.0, 3.0, 0.0), label="ceiling lamp")
    assert [one.label for one, _ in things.fitting(Goal("table lamp"))] == ["ceiling lamp"]
    lower = ((4.0, 0.2, 0.0), (5.0, 1.4, 0.8))
    things = after(things, Pose2(2.0, 3.0, 0.0), solid=lower, label="table lamp")
    assert [one.label for one, _ in things.fitting(Goal("table lamp"))] == ["table lamp"]
    assert len(things.fitting(Goal("lamp"))) == 2


@pytest.mark.parametrize(
    ("goal", "among_twelve"),
    [
        ("reception desk", 0.42),
        ("the light gray desk in the hall", 0.42),
        ("desk", 1.0),
        ("the desk beside the sofa", 1.0),
    ],
)
def test_of_many_that_lack_a_word_of_the_goal_each_is_the_less_likely(goal, among_twelve):
    """Of twelve desks hardly any is the reception desk, but each may stand beside a sofa."""
    one = Thing(0, "desk", 1.0, (0, 0, 0), (1, 1, 1), ((0, 0, 1),), 1.0, 1, 1)
    alone, four, twelve = (
        Things(tuple(replace(one, number=k) for k in range(count)), count).fitting(Goal(goal))
        for count in (1, 4, 12)
    )
    ((_, chance),) = alone
    assert [other for _, other in four] == pytest.approx(4 * [chance])
    assert [other for _, other in twelve] == pytest.approx(12 * [among_twelve * chance], rel=0.01)


def test_what_more_words_of_a_description_name_comes_before_others_of_its_kind():
    things = after(Things(), Pose2(2.0, 3.0, 0.0), label="ceiling lamp")
    lower = ((4.0, 0.2, 0.0), (5.0, 1.4, 0.8))
    things = after(things, Pose2(2.0, 3.0, 0.0), solid=lower, label="table lamp")
    assert [one.label for one, _ in things.fitting(Goal("the metal table lamp"))] == ["table lamp"]
    assert len(things.fitting(Goal("the metal lamp"))) == 2
    left = things.fitting(Goal("the metal table lamp"), besides={1})
    assert [one.label for one, _ in left] == ["ceiling lamp"]


def test_what_people_also_call_so_comes_only_where_nothing_has_the_name_itself():
    plant = Goal("the green potted plant in the kitchen")
    things = after(Things(), Pose2(2.0, 3.0, 0.0), label="cactus")
    assert [one.label for one, _ in things.fitting(plant)] == ["cactus"]
    lower = ((4.0, 0.2, 0.0), (5.0, 1.4, 0.8))
    things = after(things, Pose2(2.0, 3.0, 0.0), solid=lower, label="potted plant")
    assert [one.label for one, _ in things.fitting(plant)] == ["potted plant"]


@pytest.mark.parametrize(
    ("change", "labels"),
    [({"missed": 5}, ["ceiling lamp"]), ({"score": 0.31}, ["ceiling lamp", "table lamp"])],
)
def test_others_of_its_kind_are_candidates_where_what_has_its_name_is_gone_or_hardly_likely(
    change, labels
):
    things = after(Things(), Pose2(2.0, 3.0, 0.0), label="ceiling lamp")
    lower = ((4.0, 0.2, 0.0), (5.0, 1.4, 0.8))
    things = after(things, Pose2(2.0, 3.0, 0.0), solid=lower, label="table lamp")
    ceiling, table = things.known
    things = replace(things, known=(ceiling, replace(table, **change)))
    assert [one.label for one, _ in things.fitting(Goal("table lamp"))] == labels


def test_a_later_search_that_sees_it_as_large_moves_it():
    things = after(Things(), Pose2(2.0, 3.0, 0.0))
    nearer = ((3.8, 2.3, 0.0), (4.8, 3.5, 0.8))
    (sofa,) = after(things, Pose2(2.0, 3.0, 0.0), solid=nearer, search=2).known
    assert sofa.high[1] == pytest.approx(3.5, abs=0.15)
    assert (sofa.first_search, sofa.last_search) == (1, 2)


@pytest.mark.parametrize(
    ("goal", "fits"),
    [("couch", 1.0), ("the sofa", 1.0), ("red sofa", 0.5), ("sofa in the hall", 0.5), ("bed", 0.0)],
)
def test_a_label_fits_a_goal_as_far_as_it_tells(goal, fits):
    (sofa,) = after(Things(), Pose2(2.0, 3.0, 0.0)).known
    assert sofa.fits(Goal(goal)) == fits


def test_the_least_certain_of_too_many_things_are_forgotten():
    many = tuple(
        Thing(n, "cup", 0.2 if n == 3 else 0.9, (n, 50, 0), (n, 50, 0), ((0, 0, 1),), 1.0, 1, 1)
        for n in range(MOST_THINGS)
    )
    things = after(Things(many, MOST_THINGS), Pose2(2.0, 3.0, 0.0))
    assert len(things.known) == MOST_THINGS
    assert things.find(3) is None
    assert things.find(MOST_THINGS) is not None


def test_an_image_is_wanted_of_a_thing_that_no_key_image_shows_nearly_as_large():
    things = after(Things(), Pose2(1.0, 3.0, 0.0))
    assert things.wants_image
    things = things.with_image(7)
    assert things.known[0].image == 7
    assert not after(things, Pose2(1.2, 3.0, 0.0)).wants_image
    assert after(things, Pose2(3.2, 3.0, 0.0)).wants_image
    assert things.without_images([7]).known[0].image is None


def test_views_from_one_place_are_one_and_the_surest_of_it_counts():
    things = after(Things(), Pose2(2.0, 3.0, 0.0), score=0.5)
    things = after(things, Pose2(2.3, 3.0, 0.0), score=0.8)
    things = after(things, Pose2(0.8, 3.0, 0.0), score=0.4)
    (sofa,) = things.known
    assert sofa.seen_from == (2.3, 3.0)
    assert sorted(score for _, _, score in sofa.views) == [0.4, 0.8]


def test_what_a_search_rejected_is_less_likely_in_the_next_one():
    things = after(Things(), Pose2(2.0, 3.0, 0.0))
    refuted = things.refuted_at([(4.1, 3.0)], Goal("sofa"), 1)
    assert 0.0 < refuted.known[0].chance < things.known[0].chance
    for elsewhere, goal in (((1.0, 1.0), "sofa"), ((4.1, 3.0), "bed")):
        assert things.refuted_at([elsewhere], Goal(goal), 1).known == things.known
