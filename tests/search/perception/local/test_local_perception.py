from dataclasses import dataclass, field, replace

import numpy as np
import pytest

import images
from certainty import certain
from hypernav.core.embodiment import CameraConfig, Embodiment
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.memory.floor import SearchMemory
from hypernav.search.memory.memory import Memory
from hypernav.search.models.reliability import known
from hypernav.search.perception.config import LocalConfig
from hypernav.search.perception.local.belief import (
    confirmed,
    is_convincing,
    needs_second_look,
    reconsidered,
    rejected,
)
from hypernav.search.perception.local.local_perception import LocalPerception
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector

GOAL = Goal("thing")  # a kind whose form is not known


def thing_before_wall(**view):
    """An upright plate that is called a thing."""
    return images.thing_before_wall(label=ObjectLabel("thing"), **view)


AS_YOLOX = {"score_weights": known()["yolox-nano"].boxes, "look_closer_below": 0.0}
"""What the scores of the scripted detectors are worth; they see nothing anew in a part."""


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
        self.config = LocalConfig(**(AS_YOLOX | config))
        self.floor = Memory(MappingConfig(), Embodiment()).floor
        self._local = LocalPerception(
            detector or GroundTruthDetector(),
            WholeBox(),
            self.config,
            CameraConfig(),
            cell_size_m=0.05,
        )

    def look(self, observation, *, asks=True):
        return self._local.look(observation, GOAL, self.floor, asks=asks)

    @property
    def target(self):
        return self.evidence.target

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


def test_a_record_has_the_box_to_a_tenth_of_a_pixel():
    box = (60.34, 40.26, 100.17, 80.42)
    (record,) = Perception(ScriptedDetector([seen(box)])).look(thing_before_wall())
    assert record.box == pytest.approx(box, abs=0.0501)


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


@pytest.mark.parametrize("rule", ["latest", "candidates"])
def test_a_rejected_area_is_remembered(rule):
    local = Perception(target=rule)
    local.look(thing_before_wall())
    local.reject(for_good=True)
    (record,) = local.look(thing_before_wall(robot=Pose2(0.3, 0.1, 0.0), thing_m=1.7))
    assert local.target is None
    assert record.reason == "rejected before"
    local.begin_search()
    local.look(thing_before_wall())
    assert local.target is not None


def test_a_rejection_may_be_for_now_only():
    local = Perception(target="latest", rejected_for_looks=3)
    local.look(thing_before_wall())
    local.reject()
    for _ in range(3):
        (record,) = local.look(thing_before_wall())
        assert record.reason == "rejected before"
    (record,) = local.look(thing_before_wall())
    assert record.accepted


def looks_until_believed(local, sides, most=12):
    """Number of images after a rejection until the goal is gone to again; None: never."""
    for number in range(1, most + 1):
        y = sides[number % len(sides)]
        local.look(thing_before_wall(robot=Pose2(0.0, y, 0.0), box=shifted(y)))
        if local.target is not None:
            return number
    return None


def shifted(y):
    """Box of a thing 2 m ahead of the origin, seen from ``(0, y)``."""
    move = round(y / 2.0 * thing_before_wall().camera.fx)
    return (60 + move, 40, 100 + move, 80)


def doubtful(score):
    """A detector that sees what is there, and gives it a score."""

    class Doubtful:
        def detect(self, observation, goal):
            found = GroundTruthDetector().detect(observation, goal)
            return [replace(one, score=score) for one in found]

    return Doubtful()


def test_what_was_refuted_comes_back_only_with_new_evidence():
    local = Perception(doubtful(0.6))
    local.look(thing_before_wall())
    local.reject()
    assert looks_until_believed(local, (0.0, 0.1)) is None  # the same view once more
    assert looks_until_believed(local, (0.9, -0.9)) is not None


def test_low_scores_bring_nothing_back():
    local = Perception(doubtful(0.2))
    local.look(thing_before_wall())
    local.reject()
    assert looks_until_believed(local, (0.0, 0.9, -0.9)) is None


def test_what_was_denied_for_good_stays_rejected():
    local = Perception(doubtful(0.9))
    local.look(thing_before_wall())
    local.reject(for_good=True)
    assert looks_until_believed(local, (0.0, 0.9, -0.9)) is None
    assert not local.reconsider()


def test_every_doubtful_candidate_has_a_last_chance_the_likeliest_first():
    views = [thing_before_wall(robot=Pose2(0.0, y, 0.0)) for y in (0.0, 6.0)]
    local = Perception(ScriptedDetector([[replace(seen()[0], score=s)] for s in (0.5, 0.7)]))
    for view in views:
        local.look(view)
        local.reject()
    for y in (6.0, 0.0):
        assert local.reconsider()
        assert certain(local.target).area.centre[1] == pytest.approx(y, abs=0.1)
        assert local.is_convincing  # nothing better is left
        local.reject()
    assert not local.reconsider()
    assert local.target is None


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


@pytest.mark.parametrize("rule", ["candidates", "latest"])
@pytest.mark.parametrize("is_guessed", [True, False])
def test_a_few_far_pixels_are_strays_only_where_the_mask_was_guessed_for_a_candidate(
    rule, is_guessed
):
    view = thing_before_wall(thing_m=2.0, wall_m=4.0)
    view.depth[57:63, 77:83] = 4.0  # a gap in the thing through which the wall shows
    box = Box(60.0, 40.0, 100.0, 80.0)
    found = Detection(box, 0.9, "bed", None if is_guessed else box.mask(160, 120))
    local = Perception(
        ScriptedDetector([[found]]), target=rule, largest_cluster_only=False, entry_reach_m=0
    )
    local.look(view)
    has_wall = certain(local.target).area.seen_points[:, 0].max() > 3.0
    assert has_wall == (rule == "latest" or not is_guessed)


@pytest.mark.parametrize(
    ("detector", "is_wanted", "named"),
    [
        (GroundTruthDetector(), True, {images.THING}),
        (GroundTruthDetector(), False, set()),
        (ScriptedDetector([[]]), True, set()),
    ],
)
def test_all_that_a_detector_can_name_is_remembered_where_it_is_wanted(detector, is_wanted, named):
    local = LocalPerception(
        detector,
        WholeBox(),
        LocalConfig(),
        CameraConfig(),
        cell_size_m=0.05,
        names_things=is_wanted,
    )
    floor = Memory(MappingConfig(), Embodiment()).floor
    local.look(thing_before_wall(), Goal("bed"), floor)
    assert floor.sightings.named == named
    assert [one.label for one in floor.sightings.things] == ["thing"] * len(named)


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


def test_a_second_box_of_the_same_thing_in_an_image_says_nothing_new():
    twice = [*seen(), replace(seen()[0], score=0.4)]
    once, both = (Perception(ScriptedDetector([boxes])) for boxes in (seen(), twice))
    for local in (once, both):
        local.look(thing_before_wall())
    assert certain(both.target).log_odds == certain(once.target).log_odds
    assert (certain(both.target).area.views == certain(once.target).area.views).all()


@pytest.mark.parametrize(
    ("score", "widens"), [(0.9, True), (0.21, True), (0.2, False), (0.1, False)]
)
def test_an_image_widens_a_candidate_only_if_it_speaks_for_it(score, widens):
    wider = replace(seen((40.0, 40.0, 120.0, 80.0))[0], score=score)  # with the wall beside it
    local = Perception(ScriptedDetector([seen(), [wider]]))
    local.look(thing_before_wall())
    before = len(certain(local.target).area.seen_points)
    local.look(thing_before_wall())
    assert len(local.evidence.candidates) == 1
    assert (len(certain(local.target).area.seen_points) > before) is widens


@pytest.mark.parametrize(("least", "is_taken"), [(1, True), (12, False)])
def test_a_handful_of_pixels_gives_no_goal_area(least, is_taken):
    """What this guards against: a few stray pixels that a detector takes for the goal."""
    local = Perception(ScriptedDetector([seen((60.0, 55.0, 63.0, 58.0))]), min_points=least)
    local.look(thing_before_wall())
    assert bool(local.evidence.candidates) is is_taken


def test_the_latest_detection_wins_in_the_paper_s_way():
    local = Perception(ScriptedDetector([seen(), seen((5.0, 40.0, 30.0, 80.0))]), target="latest")
    local.look(thing_before_wall())
    here = certain(local.target).area.centre
    local.look(thing_before_wall())
    assert certain(local.target).area.centre != here


def test_a_target_that_should_be_seen_and_is_not_is_left():
    local = Perception(ScriptedDetector([[replace(seen()[0], score=0.5)], *[[]] * 4]))
    local.look(thing_before_wall())
    assert local.target is not None
    for x in (0.5, 0.9, -0.9, -1.9):
        local.look(thing_before_wall(robot=Pose2(x, 0.0, 0.0), thing_m=2.0 - x))
    assert local.target is None


def test_an_image_that_misses_what_an_equal_one_showed_says_nothing():
    local = Perception(ScriptedDetector([[replace(seen()[0], score=0.5)], *[[]] * 4]))
    for _ in range(5):
        local.look(thing_before_wall())
    assert local.target is not None


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


@pytest.mark.parametrize("score", [0.5, 0.7, 0.9])
def test_no_score_of_one_view_convinces(score):
    local = Perception(doubtful(score))
    for _ in range(9):
        local.look(thing_before_wall())
    assert not local.is_convincing
    assert local.needs_second_look


def test_several_sides_convince():
    local = Perception(doubtful(0.95))
    for y in (0.0, 0.9, -0.9):
        local.look(thing_before_wall(robot=Pose2(0.0, y, 0.0), box=shifted(y)))
    assert local.is_convincing
    assert not local.needs_second_look
    assert len(local.evidence.candidates) == 1


def test_weak_detections_count_when_they_come_back_from_other_sides():
    local = Perception(doubtful(0.35))
    local.look(thing_before_wall(thing_m=4.0, wall_m=6.0))
    weak = local.evidence.candidates[0].log_odds
    local.look(thing_before_wall(robot=Pose2(2.0, 0.0, 0.0), thing_m=2.0, wall_m=4.0))
    assert local.evidence.candidates[0].log_odds > weak


def test_a_likelier_candidate_is_gone_to_instead():
    weak, strong = replace(seen()[0], score=0.45), seen((5.0, 40.0, 30.0, 80.0))
    local = Perception(ScriptedDetector([[weak], strong]))
    local.look(thing_before_wall())
    first = certain(local.target).number
    local.look(thing_before_wall(robot=Pose2(0.0, 0.0, 0.0)))
    assert certain(local.target).number != first
    assert len(local.evidence.candidates) == 2


def test_what_is_hardly_likely_is_remembered_and_not_gone_to():
    local = Perception(doubtful(0.1))
    (record,) = local.look(thing_before_wall())
    assert record.accepted
    assert local.target is None
    assert len(local.evidence.candidates) == 1


def rival(score, box=(58.0, 42.0, 102.0, 80.0)):
    return Detection(Box(*box), score, "couch", is_goal=False)


def odds_beside(*others):
    detection = Detection(Box(60.0, 40.0, 100.0, 80.0), 0.6, "bed")
    local = Perception(ScriptedDetector([[detection, *others]]))
    local.look(thing_before_wall(thing_m=2.0, wall_m=4.0))
    return local.evidence.candidates[0].log_odds


def test_another_name_for_the_same_pixels_speaks_against_it():
    assert odds_beside(rival(0.9)) < odds_beside(rival(0.6)) < odds_beside()
    assert odds_beside(rival(0.15)) == odds_beside()


@pytest.mark.parametrize(
    "other",
    [
        rival(0.95, box=(105.0, 40.0, 145.0, 80.0)),  # beside it
        rival(0.95, box=(0.0, 40.0, 160.0, 80.0)),  # much wider
        rival(0.95, box=(58.0, 0.0, 102.0, 24.0)),  # above it, on the wall behind
    ],
)
def test_what_is_elsewhere_is_no_rival(other):
    assert odds_beside(other) == odds_beside() > odds_beside(rival(0.95))


def test_nothing_is_doubted_in_the_paper_s_way():
    faint = Detection(Box(60.0, 40.0, 100.0, 80.0), 0.05, "bed")
    local = Perception(ScriptedDetector([[faint, rival(0.95)]]), target="latest")
    local.look(thing_before_wall())
    assert local.is_convincing
    assert not local.needs_second_look


def test_a_second_look_is_taken_once():
    local = Perception(doubtful(0.6))
    local.look(thing_before_wall())
    assert local.needs_second_look
    local.evidence = confirmed(local.evidence)
    local.look(thing_before_wall())
    assert not local.needs_second_look


class SeesEverything(ScriptedDetector):
    """Has names for all things."""

    def things_in(self, observation, detections):
        return [*detections, Detection(Box(0.0, 0.0, 30.0, 30.0), 0.9, "wall")]


@pytest.mark.parametrize("is_new", [True, False])
def test_in_a_view_that_is_not_new_the_goal_alone_is_remembered(is_new):
    found = [Detection(Box(60.0, 40.0, 100.0, 80.0), 0.9, "thing")]
    local = Perception(SeesEverything([found]))
    local.floor.search = SearchMemory(lasts=True, has_new_view=is_new)
    local.look(thing_before_wall())
    labels = {one.label for one in local.floor.things.known}
    assert labels == ({"thing", "wall"} if is_new else {"thing"})


class Pointing(WholeBox):
    """Takes all pixels right of a point."""

    def segment_point(self, observation, x, y):
        mask = np.zeros(observation.depth.shape, dtype=bool)
        mask[int(y) - 5 : int(y) + 5, int(x) : int(x) + 10] = True
        return mask


@pytest.mark.parametrize(("segmenter", "pixels"), [(Pointing(), 100), (WholeBox(), 1600)])
def test_a_point_goes_to_a_segmenter_that_takes_points_else_its_box(segmenter, pixels):
    seen = Detection(Box(60.0, 40.0, 100.0, 80.0), 1.0, "thing", point=(70.0, 60.0))
    local = LocalPerception(
        ScriptedDetector(), segmenter, LocalConfig(), CameraConfig(), cell_size_m=0.05
    )
    assert local._mask(seen, thing_before_wall()).sum() == pixels
