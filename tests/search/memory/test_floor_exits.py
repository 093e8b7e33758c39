"""A goal that is seen on another floor is gone to over stairs."""

from collections.abc import Sequence
from dataclasses import replace

import pytest

from box_views import FLOOR, view_of
from hypernav.core.embodiment import BodyConfig, Embodiment
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.stairs.connectors import Connector
from hypernav.search.memory.floor_exits import (
    forget_seen_from_elsewhere,
    seen_from_elsewhere,
    stairs_to_sighting,
)
from hypernav.search.memory.memory import Memory

CLIMBER = Embodiment(body=BodyConfig(max_step_m=0.2))
UP, DOWN = (Connector(0, goes_up, (1.0, 0.0), 0.0, sightings=2) for goes_up in (True, False))
HERE = (3.0, 4.0)


def memory_with(*connectors: Connector) -> Memory:
    memory = Memory(MappingConfig(), CLIMBER)
    memory.begin_search(sees_stairs=True)
    memory.follow(view_of([FLOOR], Pose2(0.0, 0.0, 0.0), camera=CLIMBER.camera.intrinsics))
    memory.connectors = connectors
    return memory


def led_to(memory: Memory, z: float, by: int) -> None:
    """The robot takes stairs to a new floor at a height, with new stairs up and down."""
    memory.number = memory.add_floor(z)
    memory.crossed(by)
    new = (replace(one, floor=memory.number, end=(9.0, 9.0)) for one in (UP, DOWN))
    memory.connectors = (*memory.connectors, *new)


def numbers(memory: Memory) -> Sequence[int | None]:
    return [one.connector for one in stairs_to_sighting(memory)]


def test_it_is_gone_to_over_stairs_that_lead_there_once():
    memory = memory_with(UP, DOWN)
    assert not stairs_to_sighting(memory)
    memory.search.note_off_floor((*HERE, -2.0))
    assert numbers(memory) == [1]
    assert seen_from_elsewhere(memory) is None
    above = memory.number
    led_to(memory, -2.6, by=1)
    assert not stairs_to_sighting(memory)
    assert seen_from_elsewhere(memory) == HERE
    memory.number = above
    assert numbers(memory) == [1]
    memory.number = 1
    forget_seen_from_elsewhere(memory, HERE)
    memory.number = above
    memory.search.note_off_floor((*HERE, -2.0))
    assert not stairs_to_sighting(memory)


@pytest.mark.parametrize("storey_m", [-5.5, -4.0, -2.6, -1.7, -1.1, 1.1, 2.6, 4.0, 5.5])
def test_by_its_line_of_sight_alone_it_is_on_the_next_floor_up_or_down(storey_m: float):
    """Nothing leads the robot on from there, nor back, however high the storey is."""
    memory = memory_with(UP, DOWN)
    memory.search.note_off_floor((*HERE, -0.9 if storey_m < 0.0 else 3.0))
    led_to(memory, storey_m, by=0 if storey_m > 0.0 else 1)
    assert seen_from_elsewhere(memory) == HERE
    assert not stairs_to_sighting(memory)


@pytest.mark.parametrize(("height_m", "goes_up"), [(-2.6, False), (4.5, True)])
def test_a_floor_between_does_not_have_what_lies_farther_on(height_m: float, goes_up: bool):
    memory = memory_with(UP, DOWN)
    memory.search.note_off_floor((*HERE, height_m))
    led_to(memory, 1.2 if goes_up else -1.2, by=0 if goes_up else 1)
    assert seen_from_elsewhere(memory) is None
    (way,) = numbers(memory)
    assert way is not None
    assert memory.connectors[way].goes_up is goes_up
    led_to(memory, 2.6 if goes_up else -2.6, by=way)
    assert seen_from_elsewhere(memory) == HERE
    assert not stairs_to_sighting(memory)


def test_where_no_stairs_lead_to_one_sighting_those_to_another_are_taken():
    memory = memory_with(DOWN)
    memory.search.note_off_floor((*HERE, 3.3))
    led_to(memory, -2.6, by=0)
    memory.connectors = tuple(one for one in memory.connectors if one.floor == 0 or not one.goes_up)
    memory.floors[0].search.given_up.add(0)
    memory.search.note_off_floor((*HERE, -1.5))
    (way,) = numbers(memory)
    assert way is not None
    assert not memory.connectors[way].goes_up


def test_to_forget_one_place_on_a_floor_leaves_another():
    memory = memory_with(DOWN)
    memory.search.note_off_floor((*HERE, -2.0))
    led_to(memory, -2.6, by=0)
    forget_seen_from_elsewhere(memory, (0.0, 0.0))
    assert seen_from_elsewhere(memory) == HERE
    forget_seen_from_elsewhere(memory, HERE)
    assert seen_from_elsewhere(memory) is None
