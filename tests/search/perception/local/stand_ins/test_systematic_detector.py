"""A stand-in whose errors belong to things, sides and sizes, at the rates that were measured."""

import math
from dataclasses import replace

import numpy as np
import pytest

from certainty import certain
from hypernav.core.errors import ConfigError, LabelsMissingError
from hypernav.core.geometry.boxes import Box
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.observation import LabelledPixels
from hypernav.search.perception.local.stand_ins.systematic_detector import (
    _ANY_OTHER,
    _FOUND_CUT_OFF,
    _FOUND_WHOLE,
    _PLACE_M,
    _RIGHT_SCORE,
    _RIGHT_SCORE_SD,
    _STRIDE,
    _TAKEN_FOR,
    _TAKEN_FROM_BUILDING,
    _WRONG_SCORE,
    _WRONG_SCORE_SD,
    LEVELS,
    SystematicDetector,
    touches_edge,
)
from images import thing_before_wall

TV = Goal("tv")
SIDES = [2.0 * math.pi * k / 8 + 0.2 for k in range(8)]
THINGS = 100


def seen(category: str, number: int, yaw: float = 0.2, side_px: int = 40, shift: int = 0):
    """A view of the thing of a number, told apart by an attribute; half the usual image's size."""
    box = (40 + shift, 30, 40 + shift + side_px, 30 + side_px)
    label = ObjectLabel(category, attributes=(str(number),))
    return thing_before_wall(box=box, robot=Pose2(0.0, 0.0, yaw), label=label)


def is_reported(level: str, view, goal: Goal = TV) -> bool:
    assert view.truth is not None
    boxes = [one.box for one in SystematicDetector(level).detect(view, goal)]
    rows, columns = np.nonzero(view.truth.ids == 3)
    return any(
        (box.x_min, box.y_min) == (columns.min(), rows.min())
        and (box.x_max, box.y_max) == (columns.max() + 1, rows.max() + 1)
        for box in boxes
    )


def share(level: str, category: str, **view: float) -> float:
    return float(
        np.mean([is_reported(level, seen(category, k, **view)) for k in range(THINGS)])  # type: ignore[arg-type]
    )


def test_the_same_view_gives_the_same_answer_and_a_small_step_too():
    answered = set()
    for number in range(30):
        answers = {is_reported("poor", seen("tv", number, shift=shift)) for shift in range(3)}
        answers.add(is_reported("poor", seen("tv", number)))
        assert len(answers) == 1
        answered |= answers
    assert answered == {True, False}


@pytest.mark.parametrize(("side_px", "found"), [(10, 0.29), (20, 0.54), (50, 0.70), (70, 1.0)])
def test_things_are_found_at_the_measured_rates_of_their_size(side_px: int, found: float):
    spread = math.sqrt(found * (1.0 - found) / THINGS)
    assert abs(share("poor", "tv", side_px=side_px) - found) <= 4.0 * spread


def test_what_is_found_from_one_side_is_found_from_others_more_often_than_by_chance():
    found = np.array(
        [[is_reported("poor", seen("tv", k, yaw=yaw)) for yaw in SIDES] for k in range(40)]
    )
    assert len({tuple(row) for row in found.tolist()}) > 5
    per_thing = found.mean(axis=1)
    p = per_thing.mean()
    assert per_thing.var() > 3.0 * p * (1.0 - p) / len(SIDES)


def test_a_monitor_is_taken_for_a_tv_as_often_as_measured_and_a_bed_never():
    spread = math.sqrt(0.282 * 0.718 / THINGS)
    assert abs(share("poor", "computer monitor") - 0.282) < 4.0 * spread
    assert share("poor", "bed") < 0.02


def test_better_levels_err_less():
    assert list(LEVELS) == ["good", "fair", "poor"]
    found = [share(level, "tv", side_px=20) for level in LEVELS]
    wrong = [share(level, "computer monitor") for level in LEVELS]
    assert found == sorted(found, reverse=True)
    assert wrong == sorted(wrong)


def test_some_places_of_the_building_are_taken_for_a_chair_from_wherever_they_are_seen():
    chair, detector = Goal("chair"), SystematicDetector("poor")
    views = [
        thing_before_wall(robot=Pose2(x, y, 0.0), wall_m=3.0)
        for x in np.arange(0.0, 30.0, 2.0)
        for y in np.arange(0.0, 20.0, 2.0)
    ]
    taken = [len(detector.detect(view, chair)) for view in views]
    assert 0 < sum(taken) < len(views)
    assert [len(SystematicDetector("poor").detect(view, chair)) for view in views] == taken


def test_the_box_of_such_a_place_holds_all_that_shows_of_one_cube_and_nothing_else():
    found = 0
    for x, y in np.mgrid[6.0:10.0:2.0, 0.0:20.0:2.0].reshape(2, -1).T:
        view = thing_before_wall(robot=Pose2(float(x), float(y), 0.1), wall_m=3.0, thing_m=3.0)
        view = replace(view, truth=LabelledPixels(np.full_like(certain(view.truth).ids, -1), {}))
        rows, columns = (axis.ravel() for axis in np.indices(view.depth.shape))
        cubes = np.floor(view.points_at(rows, columns) / _PLACE_M).reshape(*view.depth.shape, 3)
        for one in SystematicDetector("poor").detect(view, Goal("chair")):
            x0, y0, x1, y1 = one.box.pixels()
            cube = cubes[y1 - _STRIDE, x1 - _STRIDE]
            shown = np.argwhere((cubes == cube).all(axis=2)[::_STRIDE, ::_STRIDE]) * _STRIDE
            assert [y0, x0] == shown.min(axis=0).tolist()
            assert [y1, x1] == (shown.max(axis=0) + _STRIDE).tolist()
            found += 1
    assert found > 1


def test_what_is_right_scores_as_much_more_than_what_is_wrong_as_measured():
    detector, couch = SystematicDetector("poor"), Goal("couch")
    for category, mean, sd in (
        ("couch", _RIGHT_SCORE, _RIGHT_SCORE_SD),
        ("armchair", _WRONG_SCORE, _WRONG_SCORE_SD),
    ):
        views = [seen(category, number, side_px=70) for number in range(THINGS // 2)]
        scores = [one.score for view in views for one in detector.detect(view, couch)]
        assert abs(np.mean(scores) - mean) < 4.0 * sd / math.sqrt(len(scores))
        assert abs(np.std(scores) - sd) < 0.05


@pytest.mark.parametrize("is_upright", [False, True])
@pytest.mark.parametrize("is_far_end", [False, True])
@pytest.mark.parametrize(("gap_px", "is_cut_off"), [(0.0, True), (0.9, True), (1.0, False)])
def test_a_box_less_than_a_pixel_from_any_edge_is_cut_off(
    is_upright: bool, is_far_end: bool, gap_px: float, is_cut_off: bool
):
    near, far = (50.0, 100.0 - gap_px) if is_far_end else (gap_px, 50.0)
    box = Box(20.0, near, 30.0, far) if is_upright else Box(near, 20.0, far, 30.0)
    width, height = (200, 100) if is_upright else (100, 200)
    assert touches_edge(box, width, height) == is_cut_off


def test_it_needs_a_level_that_exists_and_labels():
    with pytest.raises(ConfigError, match="good, fair, poor"):
        SystematicDetector("perfect")
    with pytest.raises(LabelsMissingError):
        SystematicDetector("poor").detect(thing_before_wall(with_truth=False), TV)


def test_the_rates_of_errors_are_shares():
    """Of a thing that is taken for several kinds, each view takes it for one of them at most."""
    shares = dict.fromkeys((thing for thing, _ in _TAKEN_FOR), 0.0)
    for (thing, _), share in _TAKEN_FOR.items():
        assert 0.0 < share < 1.0
        shares[thing] += share
    assert max(shares.values()) < 1.0
    assert all(0.0 <= share < 1.0 for share in _TAKEN_FROM_BUILDING.values())
    for found in (_FOUND_WHOLE, _FOUND_CUT_OFF):
        assert len(found) == 5
        assert all(0.0 <= share <= 1.0 for share in found)
    assert all(
        cut_off <= whole for cut_off, whole in zip(_FOUND_CUT_OFF, _FOUND_WHOLE, strict=True)
    )


def test_a_kind_that_the_tables_name_is_mistaken_more_often_than_any_other():
    for named, other in (
        (_TAKEN_FOR, _ANY_OTHER),
        (_TAKEN_FROM_BUILDING, _ANY_OTHER),
    ):
        assert 0.0 < other < min(named.values()) <= max(named.values()) <= 1.0
