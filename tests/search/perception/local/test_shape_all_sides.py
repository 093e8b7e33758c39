"""Several images of a thing say more of its form than one: its sides, and whether it has a top."""

import math

import pytest

from certainty import certain
from hypernav.core.naming.kind_shapes import kind_shape
from hypernav.search.memory.candidate import Measure
from hypernav.search.perception.local.shape import Form, form_evidence, measure_of
from images import thing_before_wall

SOFA, TV, TOILET = (certain(kind_shape(name)) for name in ("sofa", "tv", "toilet"))


def measure(side_deg=0.0, *, width_m=None, face=False, level=0.3, below_eye=True):
    return Measure(math.radians(side_deg), width_m, face, level, below_eye)


def test_nothing_measured_says_nothing():
    evidence = form_evidence([], SOFA)
    assert evidence.log_odds == 0.0
    assert not evidence.is_doubtful


def test_a_narrow_thing_may_be_a_sofa_seen_from_its_end():
    evidence = form_evidence([measure(0.0, width_m=0.9)], SOFA)
    assert evidence.log_odds == 0.0
    assert evidence.is_doubtful


def test_what_is_narrow_from_two_sides_is_no_sofa():
    sides = [measure(0.0, width_m=0.9), measure(70.0, width_m=0.95)]
    evidence = form_evidence(sides, SOFA)
    assert evidence.log_odds < -2.0
    assert not evidence.is_doubtful


@pytest.mark.parametrize("first_deg", range(-180, 180, 45))
@pytest.mark.parametrize(("turn_deg", "is_doubtful"), [(20, True), (70, False), (180, False)])
def test_two_sides_are_told_by_the_angle_between_them(first_deg, turn_deg, is_doubtful):
    for other_deg in (first_deg + turn_deg, first_deg - turn_deg):
        sides = [measure(one, width_m=0.9) for one in (first_deg, other_deg)]
        assert form_evidence(sides, SOFA).is_doubtful is is_doubtful


def test_one_image_of_its_long_side_makes_a_sofa_of_it():
    sides = [measure(0.0, width_m=0.9), measure(70.0, width_m=1.7)]
    assert form_evidence(sides, SOFA).log_odds == 0.0


def test_the_narrower_the_less_it_is_one():
    shifts = [
        form_evidence([measure(0.0, width_m=w), measure(90.0, width_m=w)], SOFA).log_odds
        for w in (1.1, 0.9, 0.6, 0.3)
    ]
    assert shifts == sorted(shifts, reverse=True)


def test_a_flat_face_shows_its_width_from_one_side():
    assert form_evidence([measure(width_m=0.55, face=True)], TV).log_odds < -2.0
    assert form_evidence([measure(width_m=1.1, face=True)], TV).log_odds == 0.0


def test_a_face_is_measured_more_surely_than_a_mask_that_bleeds():
    sides = [measure(width_m=0.55, face=True), measure(width_m=1.3)]
    assert form_evidence(sides, TV).log_odds < -2.0


def test_the_flat_end_of_a_sofa_is_not_its_width():
    end = measure(width_m=0.9, face=True)
    assert form_evidence([end], SOFA).is_doubtful
    assert form_evidence([end, measure(20.0, width_m=2.1)], SOFA).log_odds == 0.0


@pytest.mark.parametrize(("below_eye", "side_deg"), [(True, 0.0), (False, 80.0)])
def test_a_thing_without_a_seat_is_no_toilet(below_eye, side_deg):
    sides = [measure(one, level=0.02, below_eye=below_eye) for one in (0.0, side_deg)]
    evidence = form_evidence(sides, TOILET)
    assert evidence.log_odds < -2.0
    assert not evidence.is_doubtful


def test_a_seat_that_a_back_may_hide_is_looked_for_from_another_side():
    hidden = form_evidence([measure(level=0.02, below_eye=False)], TOILET)
    assert -2.0 < hidden.log_odds < 0.0
    assert hidden.is_doubtful


@pytest.mark.parametrize(
    ("with_seat", "without", "is_against"), [(1, 1, False), (1, 3, False), (1, 9, True)]
)
def test_a_seat_that_shows_in_some_images_is_there_and_in_hardly_any_is_none(
    with_seat: int, without: int, is_against: bool
):
    sides = [measure(level=0.3)] * with_seat + [measure(level=0.0)] * without
    evidence = form_evidence(sides, TOILET)
    assert (evidence.log_odds < 0.0) == is_against
    assert not evidence.is_doubtful


def test_a_level_surface_speaks_for_no_kind_and_against_none_that_has_none():
    assert form_evidence([measure(level=0.0)], TV).log_odds == 0.0
    assert form_evidence([measure(level=0.5)], TOILET).log_odds == 0.0


def test_from_far_away_a_level_surface_cannot_be_told():
    form = Form(0.1, 0.8, 0.6, True, True, False, 0.0, 0.0, False)
    observation = thing_before_wall()
    near, far = (measure_of(form, (x, 0.0), observation) for x in (2.0, 6.0))
    assert near.level_share == 0.0
    assert far.level_share is None
    assert near.width_m is None  # not seen whole
    assert not near.is_below_eye
    assert near.towards == pytest.approx(math.pi)
