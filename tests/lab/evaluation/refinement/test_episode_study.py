import numpy as np
import pytest

from box_scenes import room_boxes, scene_of
from hypernav.app.build.agents import build_agent
from hypernav.core.geometry.boxes import Detection
from hypernav.core.geometry.transforms import Pose2
from hypernav.lab.evaluation.refinement.area_record import BoxSource, MaskSource
from hypernav.lab.evaluation.refinement.study import EpisodeStudy
from hypernav.search.perception.local.depth_cut import DepthCutSegmenter
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from hypernav.simulator.worlds.simulation import SimulatedWorld
from small_episodes import episode_from
from small_worlds import small_config

START = episode_from(Pose2(1.0, 2.0, 0.0), max_steps=3)


class Blind:
    """A detector that finds nothing."""

    def detect(self, observation, goal):
        return []


class Reports:
    """A detector that reports the true boxes, without masks."""

    def detect(self, observation, goal):
        found = GroundTruthDetector().detect(observation, goal)
        return [Detection(one.box, 0.5, one.label) for one in found]


def gap_between_two_posts():
    """A bed that is two posts with a gap between them: its box shows the wall 2 m behind."""
    return world_of(
        ("bed", (3.0, 1.4, 0.0), (3.2, 1.6, 1.2)), ("bed", (3.0, 1.6, 1.1), (3.2, 2.6, 1.2))
    )


def world_of(*things):
    """A room of 6 m by 4 m with these things."""
    config = small_config("paper")
    scene = scene_of(*room_boxes(6.0, 4.0), *things)
    return config, SimulatedWorld(scene, config.world, config.embodiment)


def study(config, detector=None, segmenter=None):
    agent = build_agent(config).agent
    return EpisodeStudy(config, agent, segmenter or DepthCutSegmenter(), detector)


def by_kind(records):
    return {(record.box, record.mask): record for record in records}


@pytest.fixture(scope="module")
def posts():
    config, world = gap_between_two_posts()
    return by_kind(study(config).run(START, world))


def test_a_raw_box_holds_the_wall_behind_and_a_true_mask_does_not(posts):
    raw = posts[BoxSource.TRUE, MaskSource.RAW]
    true = posts[BoxSource.TRUE, MaskSource.TRUE]
    assert raw.frames == true.frames > 0
    assert raw.seen_off > 0
    assert true.seen_off == 0


def test_the_goal_area_of_a_partly_hidden_things_box_lies_off_it_and_that_of_its_mask_does_not():
    config, world = world_of(
        ("bed", (4.0, 1.0, 0.0), (4.5, 3.0, 0.8)),
        ("cabinet", (2.8, 1.5, 0.0), (3.0, 2.5, 1.2)),
    )
    records = by_kind(study(config).run(START, world))
    first = {mask: records[BoxSource.TRUE, mask].first_off for mask in MaskSource}
    raw = first[MaskSource.RAW]
    assert raw is not None
    assert raw == first[MaskSource.BOX]
    assert raw > 0.5
    assert first[MaskSource.TRUE] == 0.0


def test_refined_cells_are_nearly_all_on_the_thing(posts):
    raw = posts[BoxSource.TRUE, MaskSource.RAW]
    refined = posts[BoxSource.TRUE, MaskSource.SEGMENTED]
    assert refined.seen_off / refined.seen < 0.3 * raw.seen_off / raw.seen


def test_the_same_episode_gives_the_same_records(posts):
    config, world = gap_between_two_posts()
    again = by_kind(study(config).run(START, world))
    assert again == posts


def test_smaller_masks_see_no_other_cells():
    config, world = gap_between_two_posts()
    config = config.model_copy(update={"local": config.local.model_copy(update={"erosion_px": 1})})
    parts = study(config)
    frame = next(parts.frames(START, world))
    areas = parts.areas(frame, frame.target.box)
    raw, true = areas[MaskSource.RAW], areas[MaskSource.TRUE]
    assert raw is not None
    assert true is not None
    seen = {tuple(np.round(point, 3)) for point in raw.seen_points}
    assert {tuple(np.round(point, 3)) for point in true.seen_points} <= seen


@pytest.mark.parametrize(
    ("detector", "expected"), [(None, False), (Blind(), False), (Reports(), True)]
)
def test_a_detectors_boxes_are_counted_where_it_has_some(detector, expected):
    config, world = gap_between_two_posts()
    records = by_kind(study(config, detector).run(START, world))
    assert ((BoxSource.DETECTED, MaskSource.RAW) in records) == expected


def test_an_episode_that_never_shows_its_goal_gives_nothing():
    config, world = gap_between_two_posts()
    away = episode_from(Pose2(1.0, 2.0, np.pi), max_steps=1)
    assert study(config).run(away, world) == []


def test_a_raw_area_is_what_was_seen_and_the_others_are_dilated():
    config, world = gap_between_two_posts()
    parts = study(config)
    frame = next(parts.frames(START, world))
    areas = parts.areas(frame, frame.target.box)
    raw, box = areas[MaskSource.RAW], areas[MaskSource.BOX]
    assert raw is not None
    assert box is not None
    assert len(raw.points) == len(raw.seen_points) == len(box.seen_points) < len(box.points)


def test_dilation_brings_the_goal_out_of_the_obstacle(posts):
    raw = posts[BoxSource.TRUE, MaskSource.RAW].position
    dilated = posts[BoxSource.TRUE, MaskSource.TRUE].position
    assert raw is not None
    assert dilated is not None
    assert raw.in_obstacle
    assert not dilated.in_obstacle
    assert not dilated.occluded
