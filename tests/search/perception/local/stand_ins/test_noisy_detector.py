"""A stand-in for a detector errs as often as told, by distance, and keeps to its errors."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.core.episode import EpisodeTruth
from hypernav.core.errors import ConfigError, LabelsMissingError, TruthMissingError
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel
from hypernav.search.perception.config import DetectorQuality
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from hypernav.search.perception.local.stand_ins.noisy_detector import (
    LEVELS,
    NoisyDetector,
    resembles,
)
from images import thing_before_wall

BED = Goal("bed")
IMAGES = 600
rates = st.floats(0.0, 1.0)


def told(seed=0):
    truth = EpisodeTruth()
    truth.tell(rng=np.random.default_rng(seed))
    return truth


def detector(truth=None, **values):
    return NoisyDetector("custom", truth or told(), DetectorQuality(**values))


def found(noisy, observation, goal=BED, images=IMAGES):
    """In how many images something was found."""
    return sum(bool(noisy.detect(observation, goal)) for _ in range(images))


def is_share(count, share, of=IMAGES):
    """Whether a count is what this probability gives, but for once in 10,000 times."""
    return abs(count - of * share) <= 4.0 * math.sqrt(of * share * (1.0 - share)) + 1e-9


edges = st.integers(0, 119)


@given(edges, edges, st.integers(12, 60), st.integers(12, 60), st.integers(0, 99))
def test_a_perfect_one_gives_the_boxes_of_ground_truth(x, y, width, height, seed):
    view = thing_before_wall(box=(x, y, min(x + width, 160), min(y + height, 120)))
    boxes = [one.box for one in GroundTruthDetector().detect(view, BED)]
    seen = NoisyDetector("perfect", told(seed)).detect(view, BED)
    assert [one.box for one in seen] == boxes
    assert all(one.mask is None and one.is_goal and one.score == 1.0 for one in seen)
    assert NoisyDetector("perfect", told(seed)).detect(view, Goal("sofa")) == []


@pytest.mark.parametrize(
    ("distance_m", "share"), [(0.8, 0.1), (1.5, 0.1), (3.25, 0.4), (5.0, 0.7), (8.0, 0.7)]
)
def test_misses_rise_with_the_distance(distance_m, share):
    noisy = detector(missed_near=0.1, missed_far=0.7)
    view = thing_before_wall(thing_m=distance_m, wall_m=9.0)
    assert is_share(IMAGES - found(noisy, view), share)


def test_without_depth_the_goal_is_far():
    noisy = detector(missed_near=0.0, missed_far=1.0)
    assert found(noisy, thing_before_wall(thing_m=0.0), images=20) == 0


@given(rates, rates, st.floats(0.0, 100.0), st.floats(0.0, 100.0))
def test_the_rate_of_misses_lies_between_near_and_far(near, far, a, b):
    quality = DetectorQuality(missed_near=near, missed_far=far)
    nearer, farther = quality.missed_at(min(a, b)), quality.missed_at(max(a, b))
    assert min(near, far) <= nearer <= max(near, far)
    assert (nearer <= farther + 1e-12) if near <= far else (nearer >= farther - 1e-12)


def test_an_object_never_found_stays_so_in_its_episode_and_not_in_others():
    view, truth = thing_before_wall(), EpisodeTruth()
    noisy = detector(truth, never_found=0.4)
    counts = []
    for episode in range(250):
        truth.tell(rng=np.random.default_rng(episode))
        counts.append(found(noisy, view, images=3))
    assert set(counts) == {0, 3}
    assert is_share(counts.count(0), 0.4, of=250)


@pytest.mark.parametrize(("label", "share"), [("armchair", 0.5), ("lamp", 0.2)])
def test_confusion_persists_and_strikes_what_resembles_the_goal_more_often(label, share):
    view, truth = thing_before_wall(label=ObjectLabel(label)), EpisodeTruth()
    noisy = detector(truth, confused_alike=0.5, confused_other=0.2)
    counts = []
    for episode in range(250):
        truth.tell(rng=np.random.default_rng(episode))
        counts.append(found(noisy, view, Goal("sofa"), images=3))
    assert set(counts) == {0, 3}
    assert is_share(counts.count(3), share, of=250)


def test_what_is_taken_for_the_goal_is_missed_as_often_as_the_goal():
    noisy = detector(confused_other=1.0, missed_near=0.3, missed_far=0.3)
    view = thing_before_wall(label=ObjectLabel("lamp"))
    assert is_share(found(noisy, view), 0.7)
    (one,) = detector(confused_other=1.0).detect(view, BED)
    assert (one.label, one.is_goal) == ("bed", True)


@pytest.mark.parametrize(
    ("label", "goal", "is_alike"),
    [
        ("shower curtain", "window curtain", True),
        ("armchair", "the red armchair", True),
        ("sofa", "armchair", True),
        ("coffee table", "dining table", True),
        ("chair", "the chair in the office", True),
        ("lamp", "sofa", False),
        ("tv stand", "tv", False),
    ],
)
def test_what_is_easily_taken_for_a_goal(label, goal, is_alike):
    assert resembles(ObjectLabel(label), Goal(goal)) is is_alike


def test_false_alarms_come_as_often_as_told_and_lie_in_the_image():
    noisy = detector(false_alarms=0.2, wrong_score=0.4)
    view = thing_before_wall(label=ObjectLabel("lamp"))
    alarms = [one for _ in range(IMAGES) for one in noisy.detect(view, BED)]
    assert abs(len(alarms) - 0.2 * IMAGES) < 4.0 * math.sqrt(0.2 * IMAGES)
    for one in alarms:
        assert one.box == one.box.clipped(160, 120)
        assert one.box.area > 0.0
        assert one.score == 0.4
    assert len({one.box for one in alarms}) == len(alarms)


def test_scores_tell_right_from_wrong_as_well_as_told():
    quality = {"right_score": 0.8, "wrong_score": 0.5, "score_sd": 0.2}
    right = detector(**quality)
    wrong = detector(confused_other=1.0, **quality)
    lamp = thing_before_wall(label=ObjectLabel("lamp"))
    for noisy, view, mean in ((right, thing_before_wall(), 0.75), (wrong, lamp, 0.5)):
        scores = [noisy.detect(view, BED)[0].score for _ in range(IMAGES)]
        assert 0.05 <= min(scores) <= max(scores) <= 1.0
        assert np.mean(scores) == pytest.approx(mean, abs=0.08)


@given(st.integers(0, 2**32), st.floats(0.0, 300.0))
def test_jittered_boxes_stay_in_the_image(seed, jitter_px):
    (one,) = detector(told(seed), jitter_px=jitter_px).detect(thing_before_wall(), BED)
    assert one.box == one.box.clipped(160, 120)
    assert one.box.x_max - one.box.x_min >= 1.0 - 1e-9  # rounding
    assert one.box.y_max - one.box.y_min >= 1.0 - 1e-9


def test_edges_move_by_as_many_pixels_as_told():
    noisy = detector(jitter_px=3.0)
    lows = [noisy.detect(thing_before_wall(), BED)[0].box.x_min for _ in range(IMAGES)]
    assert np.mean(lows) == pytest.approx(60.0, abs=0.6)
    assert np.std(lows) == pytest.approx(3.0, abs=0.5)


def test_the_best_comes_first():
    noisy = detector(false_alarms=5.0, score_sd=0.3, right_score=0.6, wrong_score=0.4)
    scores = [one.score for one in noisy.detect(thing_before_wall(), BED)]
    assert scores == sorted(scores, reverse=True)


def test_the_same_episode_gives_the_same_detections():
    def seen(seed):
        noisy = NoisyDetector("poor", told(seed))
        return [noisy.detect(thing_before_wall(), BED) for _ in range(30)]

    def values(images):
        return [[(one.box, one.score) for one in image] for image in images]

    assert values(seen(1)) == values(seen(1)) != values(seen(2))


def test_each_named_level_is_worse_than_the_one_before():
    assert list(LEVELS) == ["perfect", "good", "fair", "poor"]
    for better, worse in pairwise(LEVELS.values()):
        for name in DetectorQuality.model_fields:
            a, b = getattr(better, name), getattr(worse, name)
            assert a > b if name == "right_score" else a < b or name == "wrong_score"


def test_what_is_wrong_is_said():
    with pytest.raises(ConfigError, match=r"noisy:great: expected one of perfect, good, fair"):
        NoisyDetector("great", told())
    with pytest.raises(TruthMissingError, match="only in a simulated world"):
        NoisyDetector("fair", EpisodeTruth()).detect(thing_before_wall(), BED)
    unlabelled = replace(thing_before_wall(), truth=None)
    with pytest.raises(LabelsMissingError, match="--detector yolox:"):
        NoisyDetector("fair", told()).detect(unlabelled, BED)
