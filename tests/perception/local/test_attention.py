import math
import weakref
from typing import Any

import pytest

from hypernav.core.geometry.transforms import Pose2
from hypernav.core.observation import Observation
from hypernav.core.trace import ExchangeLog
from hypernav.mapping.memory.goal_area import GoalArea, points_under_mask
from hypernav.mapping.memory.memory import SearchMemory
from hypernav.perception.local.attention import Attention, AttentionConfig
from images import thing_before_wall

WALL_M = 4.0


def view(x: float = 0.0, y: float = 0.0, yaw: float = 0.0) -> Observation:
    """A plain wall at x = 4 m, or the one at x = -4 m for a robot that has turned around."""
    distance_m = WALL_M - x if abs(yaw) < 1.0 else WALL_M + x
    return thing_before_wall(thing_m=distance_m, wall_m=distance_m, robot=Pose2(x, y, yaw))


class Mind:
    """Attention, and the notes of one search."""

    def __init__(self, config: AttentionConfig, log: ExchangeLog) -> None:
        self.attention, self.notes = Attention(log, config), dict[str, Any]()

    def is_worth_a_question(self, observation: Observation, target: GoalArea | None) -> bool:
        return self.attention.is_worth_a_question(observation, target, self.notes)


def attention(**settings: float | bool) -> tuple[Mind, ExchangeLog]:
    log = ExchangeLog()
    on = {"skip_seen_views": True, "skip_held_target": True}
    return Mind(AttentionConfig.model_validate(on | settings), log), log


def target_ahead() -> GoalArea:
    """Something in the middle of the wall."""
    observation = view()
    mask = observation.depth > 0
    mask[:, :70] = mask[:, 90:] = False
    points = points_under_mask(mask, observation, min_depth_m=0.5, max_depth_m=5.0)
    area = GoalArea.from_points(points, resolution_m=0.05)
    assert area is not None
    return area


def test_the_first_image_is_asked_about_and_the_same_again_is_not():
    mind, log = attention(edge_share=0.0)
    assert mind.is_worth_a_question(view(), None)
    assert not mind.is_worth_a_question(view(), None)
    (skipped,) = log.drain()
    assert (skipped.kind, skipped.by_model) == ("attention", False)
    assert "100% of it was seen before" in skipped.answer


def test_another_side_of_the_room_is_new():
    mind, _ = attention()
    assert mind.is_worth_a_question(view(), None)
    assert mind.is_worth_a_question(view(yaw=math.pi), None)


def test_a_step_nearer_is_nothing_new_but_much_nearer_is():
    mind, _ = attention(edge_share=0.0)
    assert mind.is_worth_a_question(view(), None)
    assert not mind.is_worth_a_question(view(x=1.5), None)  # 2.5 m, more than 0.6 of 4 m
    assert mind.is_worth_a_question(view(x=1.8), None)


def test_what_was_only_at_the_edge_may_have_been_cut_off():
    mind, _ = attention(edge_share=0.1)
    assert mind.is_worth_a_question(view(), None)
    assert mind.is_worth_a_question(view(), None)


def test_a_skipped_image_does_not_count_as_seen():
    mind, _ = attention(edge_share=0.0, seen_share=0.5)
    assert mind.is_worth_a_question(view(), None)
    assert not mind.is_worth_a_question(view(y=2.0), None)
    # What the skipped image alone has shown is still new.
    assert mind.is_worth_a_question(view(y=4.5), None)


def test_the_far_end_of_a_hall_is_seen_though_it_has_no_depth():
    mind, _ = attention(edge_share=0.0)
    empty = thing_before_wall(thing_m=0.0, wall_m=0.0)
    assert mind.is_worth_a_question(empty, None)
    assert not mind.is_worth_a_question(empty, None)


def test_a_held_target_is_looked_at_again_only_from_nearer():
    mind, log = attention()
    target = target_ahead()
    asked = [mind.is_worth_a_question(view(x=x), target) for x in (0.0, 0.5, 1.0, 1.5, 2.0, 2.5)]
    assert asked[0]
    assert not asked[1]
    assert 2 <= sum(asked) < 5
    assert all("way to the goal is known" in one.answer for one in log.drain())


def test_every_saving_can_be_switched_off():
    mind, log = attention(skip_seen_views=False, skip_held_target=False)
    assert all(mind.is_worth_a_question(view(), area) for area in (None, None, target_ahead()))
    assert log.drain() == []


def test_a_new_search_begins_with_open_eyes():
    mind, _ = attention(edge_share=0.0)
    assert mind.is_worth_a_question(view(), None)
    mind.notes = SearchMemory().looks
    assert mind.is_worth_a_question(view(), None)


@pytest.mark.parametrize("compared", [True, False])
def test_images_are_kept_only_where_they_are_compared(compared):
    mind, _ = attention(skip_seen_views=compared)
    image = view()
    rgb, depth = weakref.ref(image.rgb), weakref.ref(image.depth)
    assert mind.is_worth_a_question(image, None)
    del image
    assert rgb() is None
    assert (depth() is not None) == compared
