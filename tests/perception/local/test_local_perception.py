from dataclasses import dataclass, field, replace

import numpy as np
import pytest

from certainty import certain
from hypernav.core.embodiment import CameraConfig, Embodiment
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.mapping.config import MappingConfig
from hypernav.mapping.memory.memory import Memory, SearchMemory
from hypernav.perception.local.belief import (
    confirmed,
    is_convincing,
    is_missed,
    needs_second_look,
    reconsidered,
    rejected,
)
from hypernav.perception.local.config import LocalConfig
from hypernav.perception.local.ground_truth import GroundTruthDetector
from hypernav.perception.local.local_perception import LocalPerception
from images import thing_before_wall

BED = Goal("bed")


@dataclass
class ScriptedDetector:
    """Answers from a list, one entry an image."""

    answers: list[list[Detection]] = field(default_factory=list)

    def detect(self, observation, goal):
        return self.answers.pop(0)


class WholeBox:
    """Takes all pixels of the box."""

    def segment(self, observation, box):
        mask = np.zeros(observation.depth.shape, dtype=bool)
        x0, y0, x1, y1 = box.pixels()
        mask[y0:y1, x0:x1] = True
        return mask


class Perception:
    """Local perception, and the floor whose memory it writes into."""

    def __init__(self, detector=None, **config):
        self.config = LocalConfig(**config)
        self.floor = Memory(MappingConfig(), Embodiment()).floor
        self._local = LocalPerception(
            detector or GroundTruthDetector(),
            WholeBox(),
            self.config,
            CameraConfig(),
            cell_size_m=0.05,
        )

    def look(self, observation, *, asks=True):
        return self._local.look(observation, BED, self.floor, asks=asks)

    @property
    def target(self):
        return self._local.target(self.floor)

    @property
    def evidence(self):
        return self.floor.search.evidence

    @evidence.setter
    def evidence(self, evidence):
        self.floor.search.evidence = evidence

    @property
    def far_position(self):
        return self.evidence.far_position

    def forget_far_position(self):
        self.evidence = replace(self.evidence, far_position=None)

    def begin_search(self):
        self.floor.search = SearchMemory()

    def reject(self, *, for_good=False):
        self.evidence = rejected(self.evidence, self.config, for_good=for_good)

    def reconsider(self):
        """Whether a rejected target was taken for the goal once more."""
        evidence = reconsidered(self.evidence)
        self.evidence = evidence or self.evidence
        return evidence is not None

    @property
    def is_convincing(self):
        return is_convincing(self.evidence, self.config)

    @property
    def needs_second_look(self):
        return needs_second_look(self.evidence, self.config)


def seen(box=(60.0, 40.0, 100.0, 80.0)):
    return [Detection(Box(*box), 0.9, "bed")]


def test_a_visible_goal_becomes_a_goal_area_where_it_stands():
    local = Perception()
    (record,) = local.look(thing_before_wall(thing_m=2.0))
    assert record.accepted
    assert record.outlines
    assert certain(local.target).area.centre == pytest.approx((2.0, 0.0), abs=0.06)


def test_nothing_seen_is_no_target():
    local = Perception(ScriptedDetector([[]]))
    assert local.look(thing_before_wall()) == []
    assert local.target is None


def test_a_goal_beyond_the_depth_camera_gives_no_area_and_says_why():
    local = Perception()
    (record,) = local.look(thing_before_wall(thing_m=7.0, wall_m=9.0))
    assert not record.accepted
    assert "depth" in record.reason
    assert local.target is None


def test_a_rejected_area_is_remembered():
    local = Perception()
    local.look(thing_before_wall())
    local.reject()
    (record,) = local.look(thing_before_wall(robot=Pose2(0.3, 0.1, 0.0), thing_m=1.7))
    assert local.target is None
    assert record.reason == "rejected before"
    local.begin_search()
    local.look(thing_before_wall())
    assert local.target is not None


def test_a_rejection_may_be_for_now_only():
    local = Perception(rejected_for_looks=3)
    local.look(thing_before_wall())
    local.reject()
    for _ in range(3):
        (record,) = local.look(thing_before_wall())
        assert record.reason == "rejected before"
    (record,) = local.look(thing_before_wall())
    assert record.accepted


def looks_until_believed(local, step_m, most=40):
    """Number of images after a rejection until the goal is believed in again; None: never."""
    for number in range(1, most + 1):
        shift = step_m * (number % 2)
        local.look(thing_before_wall(robot=Pose2(shift, 0.0, 0.0), thing_m=2.0 - shift))
        if local.target is not None:
            return number
    return None


def test_a_rejected_target_comes_back_after_enough_images_and_later_only_after_more():
    local = Perception(min_verdicts=3)
    local.look(thing_before_wall())
    local.reject()
    assert looks_until_believed(local, 0.5) == 3
    local.reject()
    assert looks_until_believed(local, 0.5) == 6


def test_images_from_one_position_bring_nothing_back():
    local = Perception(min_verdicts=3)
    local.look(thing_before_wall())
    local.reject()
    assert looks_until_believed(local, 0.0) is None


def test_low_scores_bring_nothing_back():
    local = Perception(ScriptedDetector([seen()] + [[replace(seen()[0], score=0.4)]] * 40))
    local.look(thing_before_wall())
    local.reject()
    assert looks_until_believed(local, 0.5) is None


@pytest.mark.parametrize("options", [{"for_good": True}, {}])
def test_what_was_denied_for_good_or_is_not_to_be_believed_again_stays_rejected(options):
    local = Perception(min_verdicts=3, believe_again=bool(options))
    local.look(thing_before_wall())
    local.reject(**options)
    assert looks_until_believed(local, 0.5) is None


@pytest.mark.parametrize(("score", "missed"), [(0.6, True), (0.9, False)])
def test_one_image_that_misses_the_target_outweighs_a_doubtful_sighting_only(score, missed):
    sighting = [replace(seen()[0], score=score)]
    local = Perception(ScriptedDetector([sighting, [], sighting]))
    local.look(thing_before_wall())
    assert not is_missed(local.evidence)
    local.look(thing_before_wall())
    assert is_missed(local.evidence) == missed
    local.look(thing_before_wall())
    assert not is_missed(local.evidence)


def test_every_rejected_target_is_reconsidered_once_the_most_likely_first():
    views = [thing_before_wall(robot=Pose2(0.0, y, 0.0)) for y in (0.0, 6.0)]
    local = Perception(ScriptedDetector([[replace(seen()[0], score=s)] for s in (0.5, 0.7)]))
    for view in views:
        local.look(view)
        local.reject()
    for score in (0.7, 0.5):
        assert local.reconsider()
        assert certain(local.target).mean_score == score
        local.reject()
    assert not local.reconsider()
    assert local.target is None


def test_what_was_denied_for_good_is_not_reconsidered():
    local = Perception()
    local.look(thing_before_wall())
    local.reject(for_good=True)
    assert not local.reconsider()


@pytest.mark.parametrize("keeps", [True, False])
def test_a_thin_mask_is_eroded_away_or_kept(keeps):
    local = Perception(ScriptedDetector([seen((60.0, 40.0, 64.0, 80.0))]), keep_thin_masks=keeps)
    (record,) = local.look(thing_before_wall())
    assert record.accepted == keeps


@pytest.mark.parametrize(("pixels", "depths_m"), [("mask", 1), ("box", 2)])
def test_the_raw_box_takes_the_wall_behind_for_the_goal(pixels, depths_m):
    mask = Box(60.0, 40.0, 100.0, 80.0).mask(160, 120)
    detection = Detection(Box(40.0, 40.0, 120.0, 80.0), 0.9, "bed", mask)
    local = Perception(
        ScriptedDetector([[detection]]), pixels=pixels, largest_cluster_only=False, entry_reach_m=0
    )
    local.look(thing_before_wall())
    points = certain(local.target).area.seen_points
    assert len(set(points[:, 0].round(1))) == depths_m


def test_an_image_that_is_not_asked_about_changes_nothing():
    detector = ScriptedDetector([seen()])
    local = Perception(detector)
    local.look(thing_before_wall())
    before = local.target
    assert local.look(thing_before_wall(), asks=False) == []
    assert local.target is before
    assert local.far_position is None


def test_a_held_target_is_not_left_for_another():
    local = Perception(ScriptedDetector([seen(), seen((5.0, 40.0, 30.0, 80.0))]))
    local.look(thing_before_wall())
    here = certain(local.target).area.centre
    local.look(thing_before_wall())
    assert certain(local.target).area.centre == here


def test_the_latest_detection_wins_in_the_paper_s_way():
    local = Perception(
        ScriptedDetector([seen(), seen((5.0, 40.0, 30.0, 80.0))]), target="latest", pick="first"
    )
    local.look(thing_before_wall())
    here = certain(local.target).area.centre
    local.look(thing_before_wall())
    assert certain(local.target).area.centre != here


def test_several_sightings_can_be_asked_for():
    local = Perception(min_sightings=2)
    local.look(thing_before_wall())
    assert local.target is None
    local.look(thing_before_wall())
    assert local.target is not None


def test_a_target_that_should_be_seen_and_is_not_is_dropped():
    local = Perception(ScriptedDetector([seen(), *[[]] * 6]), min_verdicts=4, max_missed_share=0.7)
    dropped_after = None
    for look in range(7):
        local.look(thing_before_wall())
        if look and local.target is None:
            dropped_after = look
            break
    assert dropped_after == 3  # one sighting, three misses


def test_a_target_out_of_sight_is_not_held_against_it():
    local = Perception(ScriptedDetector([seen(), *[[]] * 9]))
    local.look(thing_before_wall())
    for _ in range(9):
        local.look(thing_before_wall(robot=Pose2(0.0, 0.0, np.pi)))
    assert local.target is not None


def test_the_best_view_is_the_largest():
    local = Perception()
    near = thing_before_wall(robot=Pose2(0.5, 0.0, 0.0), thing_m=1.5, box=(50, 30, 110, 90))
    local.look(thing_before_wall())
    local.look(near)
    local.look(thing_before_wall())
    assert certain(local.target).best_view is near
    assert certain(local.target).sightings == 3


def test_a_goal_beyond_the_depth_camera_lies_at_the_end_of_its_range_or_beyond():
    local = Perception()
    local.look(thing_before_wall(thing_m=7.0, wall_m=9.0, box=(20, 40, 40, 80)))
    left = certain(local.far_position)
    local.forget_far_position()
    local.look(thing_before_wall(thing_m=7.0, wall_m=9.0, box=(120, 40, 140, 80)))
    assert left == pytest.approx(np.array(certain(local.far_position)) * (1.0, -1.0))
    assert left[0] == pytest.approx(CameraConfig().max_depth_m)
    assert left[1] > 1.0


def test_a_far_sighting_is_remembered_until_there_is_a_target():
    far = thing_before_wall(thing_m=7.0, wall_m=9.0)
    local = Perception(ScriptedDetector([seen(), [], seen()]))
    local.look(far)
    position = certain(local.far_position)
    local.look(thing_before_wall(robot=Pose2(0.0, 0.0, np.pi)))
    assert local.far_position == position
    local.look(thing_before_wall(thing_m=2.0))
    assert local.far_position is None
    assert local.target is not None


def test_of_several_far_sightings_the_first_is_kept_until_it_is_forgotten():
    local = Perception()
    local.look(thing_before_wall(thing_m=7.0, wall_m=9.0, box=(20, 40, 40, 80)))
    first = certain(local.far_position)
    right = thing_before_wall(thing_m=7.0, wall_m=9.0, box=(120, 40, 140, 80))
    local.look(right)
    assert local.far_position == first
    local.forget_far_position()
    assert local.far_position is None
    local.look(right)
    assert local.far_position != first


def test_a_new_search_knows_of_no_far_sighting():
    local = Perception()
    local.look(thing_before_wall(thing_m=7.0, wall_m=9.0))
    local.begin_search()
    assert local.far_position is None


def test_a_far_sighting_behind_a_rejected_area_is_not_followed():
    local = Perception()
    local.look(thing_before_wall(thing_m=2.0))
    local.reject()
    local.look(thing_before_wall(thing_m=7.0, wall_m=9.0, robot=Pose2(-5.0, 0.0, 0.0)))
    assert local.far_position is None


def test_uncertain_detections_do_not_convince():
    faint = [Detection(Box(60.0, 40.0, 100.0, 80.0), 0.31, "bed")]
    local = Perception(ScriptedDetector([faint, faint, seen()]), min_mean_score=0.45)
    local.look(thing_before_wall())
    local.look(thing_before_wall())
    assert not local.is_convincing
    local.look(thing_before_wall())
    assert certain(local.target).mean_score == pytest.approx((0.31 + 0.31 + 0.9) / 3)
    assert local.is_convincing


def rival(score, box=(58.0, 42.0, 102.0, 80.0)):
    return Detection(Box(*box), score, "couch", is_goal=False)


def test_a_target_that_looks_more_like_something_else_is_dropped():
    doubtful = [Detection(Box(60.0, 40.0, 100.0, 80.0), 0.5, "bed"), rival(0.6)]
    local = Perception(ScriptedDetector([list(doubtful) for _ in range(4)]), min_verdicts=4)
    for _ in range(3):
        local.look(thing_before_wall())
        assert not local.is_convincing
        assert local.evidence.is_contradicted
    local.look(thing_before_wall())
    assert local.target is None


def test_a_weaker_rival_does_no_harm():
    local = Perception(ScriptedDetector([[*seen(), rival(0.4)] for _ in range(6)]))
    for _ in range(6):
        local.look(thing_before_wall())
    assert local.is_convincing
    assert not local.evidence.is_contradicted


@pytest.mark.parametrize(
    "other",
    [
        rival(0.95, box=(105.0, 40.0, 145.0, 80.0)),  # beside it
        rival(0.95, box=(0.0, 40.0, 160.0, 80.0)),  # much wider
        rival(0.95, box=(58.0, 0.0, 102.0, 24.0)),  # above it, on the wall behind
    ],
)
def test_what_is_elsewhere_is_no_rival(other):
    local = Perception(ScriptedDetector([[*seen(), other] for _ in range(5)]))
    for _ in range(5):
        local.look(thing_before_wall(thing_m=2.0, wall_m=4.0))
    assert certain(local.target).rival_score == 0.0


def test_rivals_are_not_weighed_in_the_paper_s_way():
    local = Perception(ScriptedDetector([[*seen(), rival(0.95)]] * 5), weigh_rivals=False)
    for _ in range(5):
        local.look(thing_before_wall())
    assert local.is_convincing


def test_only_uncertain_targets_need_a_second_look_and_only_one():
    local = Perception(sure_score=0.75)
    local.look(thing_before_wall())  # ground truth is certain
    assert not local.needs_second_look
    faint = [Detection(Box(60.0, 40.0, 100.0, 80.0), 0.6, "bed")]
    local = Perception(ScriptedDetector([faint, faint]), sure_score=0.75)
    local.look(thing_before_wall())
    assert local.needs_second_look
    local.evidence = confirmed(local.evidence)
    local.look(thing_before_wall())
    assert not local.needs_second_look
