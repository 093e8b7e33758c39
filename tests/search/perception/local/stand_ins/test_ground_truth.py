from dataclasses import replace

import numpy as np
import pytest

from certainty import certain
from hypernav.core.errors import LabelsMissingError
from hypernav.core.goal import Goal
from hypernav.core.observation import LabelledPixels
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from images import thing_before_wall, thing_pixels


def test_it_sees_exactly_the_visible_pixels():
    observation = thing_before_wall()
    (detection,) = GroundTruthDetector().detect(observation, Goal("bed"))
    assert detection.label == "bed"
    np.testing.assert_array_equal(certain(detection.mask), thing_pixels(observation))
    assert detection.box.pixels() == (60, 40, 100, 80)


def test_it_knows_synonyms_of_what_it_sees():
    from hypernav.core.naming.labels import ObjectLabel

    observation = thing_before_wall(label=ObjectLabel("sofa"))
    assert GroundTruthDetector().detect(observation, Goal("couch"))


def test_what_is_not_asked_for_is_not_seen():
    assert GroundTruthDetector().detect(thing_before_wall(), Goal("sofa")) == []


def test_what_is_too_small_is_overlooked():
    observation = thing_before_wall(box=(60, 40, 64, 44))
    share = 16 / (160 * 120)
    assert GroundTruthDetector(share * 1.01).detect(observation, Goal("bed")) == []
    assert GroundTruthDetector(share).detect(observation, Goal("bed"))


def test_a_world_without_labels_is_an_error_that_names_the_remedy():
    observation = thing_before_wall(with_truth=False)
    with pytest.raises(LabelsMissingError, match="--detector yolox:"):
        GroundTruthDetector().detect(observation, Goal("bed"))


def test_it_names_what_it_sees_with_its_position_but_once():
    observation = thing_before_wall(thing_m=2.0)
    named = GroundTruthDetector().name_things(observation, besides=())
    assert [thing.label for thing in named.values()] == ["bed"]
    assert next(iter(named.values())).position == pytest.approx((2.0, 0.0), abs=0.1)
    assert GroundTruthDetector().name_things(observation, besides=named) == {}


def test_what_is_beyond_the_range_of_depth_is_not_named():
    assert GroundTruthDetector().name_things(thing_before_wall(thing_m=0.0), besides=()) == {}


def test_a_thing_that_is_seen_in_two_parts_is_one_with_a_box_around_both():
    whole = thing_before_wall(box=(60, 40, 100, 80))
    truth = certain(whole.truth)
    ids = truth.ids.copy()
    ids[:, 76:84] = -1
    observation = replace(whole, truth=LabelledPixels(ids, truth.labels))
    for (seen,) in (
        GroundTruthDetector().detect(observation, Goal("bed")),
        GroundTruthDetector().things_in(observation, []),
    ):
        assert seen.box.pixels() == (60, 40, 100, 80)
        np.testing.assert_array_equal(certain(seen.mask), ids == ids[60, 70])


def test_of_all_things_it_sees_exactly_the_pixels():
    observation = thing_before_wall()
    (thing,) = GroundTruthDetector().things_in(observation, [])
    assert (thing.label, thing.box.pixels()) == ("bed", (60, 40, 100, 80))
    np.testing.assert_array_equal(certain(thing.mask), thing_pixels(observation))
    assert GroundTruthDetector(0.5).things_in(observation, []) == []
