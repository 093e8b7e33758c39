"""What the things around a remembered thing say about where it is."""

import pytest

from box_views import CAMERA, FLOOR, view_of
from hypernav.core.embodiment import CameraConfig, Embodiment
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.top_down_map import TopDownMap
from hypernav.search.memory.goal_words import chances_by_name, weights_of_place
from hypernav.search.memory.thing import Thing


def thing(number: int, label: str, x: float, y: float, **values) -> Thing:
    """A thing of half a metre on the floor."""
    low, high = (x - 0.25, y - 0.25, 0.0), (x + 0.25, y + 0.25, 0.5)
    return Thing(number, label, 1.0, low, high, ((x, y - 1.0, 1.0),), 1.0, 1, 1, **values)


WALL = ((0.8, -4.0, 0.0), (0.9, 4.0, 2.5))


@pytest.fixture
def floor_map() -> TopDownMap:
    """A map of nothing: what is unknown hides nothing."""
    camera = CameraConfig(width=CAMERA.width, height=CAMERA.height)
    return TopDownMap(MappingConfig(), Embodiment(camera=camera))


def weights(floor_map: TopDownMap, goal: str, *known: Thing) -> list[float]:
    """Those of the two mirrors that come first."""
    return weights_of_place(known[:2], known, Goal(goal), floor_map)


MIRRORS = thing(0, "mirror", 0.0, 0.0), thing(1, "mirror", 8.0, 0.0)


def test_what_it_is_beside_speaks_for_a_thing_and_its_absence_against(floor_map):
    near, far = weights(
        floor_map, "the mirror beside the trash can", *MIRRORS, thing(2, "bin", 0.9, 0.0)
    )
    assert near > 1.0 > far


def test_what_is_gone_or_never_seen_says_nothing(floor_map):
    gone = thing(2, "trash can", 0.9, 0.0, missed=100)
    goal = "the mirror beside the trash can"
    assert weights(floor_map, goal, *MIRRORS, gone) == weights(floor_map, goal, *MIRRORS)
    assert weights(floor_map, goal, *MIRRORS) == [1.0, 1.0]


def test_what_people_tell_a_room_by_speaks_for_the_thing_that_is_near_it(floor_map):
    known = *MIRRORS, thing(2, "bed", 2.0, 0.0), thing(3, "toilet", 7.0, 1.0)
    bedroom, bathroom = weights(floor_map, "mirror in the bedroom", *known)
    assert bedroom > 1.0 > bathroom
    bedroom, bathroom = weights(floor_map, "mirror in the bathroom", *known)
    assert bathroom > 1.0 > bedroom


def test_what_is_behind_a_wall_tells_no_room(floor_map):
    known = *MIRRORS, thing(2, "toilet", 1.5, 0.0), thing(3, "bed", -2.0, 0.0)
    seen, _ = weights(floor_map, "mirror in the bathroom", *known)
    for _ in range(3):
        floor_map.integrate(view_of([FLOOR, WALL], Pose2(-1.0, 0.0, 0.0)))
    hidden, nothing = weights(floor_map, "mirror in the bathroom", *known)
    assert hidden < nothing < seen


def test_what_is_only_of_the_goal_s_kind_is_less_likely_than_what_is_called_like_it():
    def chance(label: str, goal: str) -> float:
        ((_, found),) = chances_by_name([thing(0, label, 0.0, 0.0)], Goal(goal))
        return found

    full = thing(0, "sofa", 0.0, 0.0).chance
    assert chance("sofa", "sofa") == full
    assert chance("sofa", "red sofa") == full / 2.0
    assert chance("sofa", "bed") == 0.0


@pytest.mark.parametrize("goal", ["mirror", "round mirror", "mirror in the orangery"])
def test_where_no_known_place_is_asked_for_none_weighs_more(floor_map, goal):
    known = *MIRRORS, thing(2, "bed", 2.0, 0.0)
    assert weights(floor_map, goal, *known) == [1.0, 1.0]
