"""Where a robot goes for what it remembers, told without a search: to face it, or to stairs."""

import math
from dataclasses import replace

import pytest

from box_views import CAMERA, room, turning, view_of
from certainty import certain
from hypernav.app.build.agents import build_search
from hypernav.app.build.presets import preset
from hypernav.core.embodiment import CameraConfig
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog, ModuleClock
from hypernav.search.agents.recall import recalled, stairs_to_errand, stairs_to_recalled
from hypernav.search.agents.step import Step
from hypernav.search.mapping.stairs.connectors import Connector, Passage
from hypernav.search.memory.goal_words import LIKELY
from hypernav.search.memory.memory import Memory
from hypernav.search.memory.thing import Thing
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector

CONFIG = preset("default").with_(
    embodiment={
        "body": {"max_step_m": 0.2},
        "camera": CameraConfig(width=CAMERA.width, height=CAMERA.height).model_dump(),
    }
)
ROBOT = Pose2(2.0, 2.0, 0.0)


def remembering(*boxes, floors: int = 1) -> tuple[Step, Memory]:
    """A robot that has looked around in a room of a building of so many floors, and its memory.

    One flight of stairs, which it has taken, leads from each floor to the next, from number 0 on.
    """
    agent = build_search(CONFIG, GroundTruthDetector(), ExchangeLog())
    memory = Memory(CONFIG.mapping, CONFIG.embodiment)
    frames = [view_of([*room(6.0, 5.0), *boxes], pose) for pose in turning(*ROBOT.xy)]
    memory.follow(frames[0])
    for frame in frames:
        memory.floor.integrate(frame)
    for k in range(1, floors):
        memory.add_floor(3.0 * k)
        up = Connector(k - 1, True, (4.0 + k, 2.0), 0.0, Passage.USED, k, 2)
        memory.connectors = (*memory.connectors, up)
    for _ in range(2):
        memory.begin_search(lasts=True, sees_stairs=True)
    grid = memory.obstacles
    return Step(0, Goal("sofa"), frames[0], grid, agent.components, ModuleClock(), []), memory


def keep(memory: Memory, floor: int, thing: Thing) -> None:
    """Let a floor hold one thing from an earlier search."""
    one = memory.floors[floor]
    one.things = replace(one.things, known=(thing,), count=thing.number + 1)


def sofa(x: float, y: float, *, label: str = "sofa", score: float = 0.95) -> Thing:
    low, high = (x - 0.3, y - 0.3, 0.0), (x + 0.3, y + 0.3, 0.8)
    return Thing(0, label, score, low, high, ((*ROBOT.xy, score),), 900.0, 1, 1)


@pytest.mark.parametrize("at", [(5.0, 4.0), (5.0, 1.0), (0.7, 4.3), (0.6, 0.7)])
def test_a_robot_faces_the_thing_that_it_goes_to(at: tuple[float, float]):
    thing = sofa(*at)
    step, memory = remembering((thing.low, thing.high))
    keep(memory, 0, thing)
    there = certain(recalled(step, memory, LIKELY))
    assert math.dist(there.xy, at) < 1.5
    ahead = Pose2(*there.xy, certain(there.face)).ahead(math.dist(there.xy, at))
    assert ahead.xy == pytest.approx(at)
    assert there.thing == thing.number


@pytest.mark.parametrize("number", [1, 2])
def test_what_is_likely_on_another_floor_is_gone_to_over_the_first_stairs_on_the_way(number: int):
    step, memory = remembering(floors=3)
    assert stairs_to_recalled(step, memory) is None
    keep(memory, number, sofa(1.0, 1.0))
    there = certain(stairs_to_recalled(step, memory))
    assert there.connector == 0
    assert there.xy == pytest.approx(memory.connectors[0].end, abs=0.5)
    keep(memory, number, sofa(1.0, 1.0, score=0.6))  # too doubtful for stairs
    assert stairs_to_recalled(step, memory) is None


@pytest.mark.parametrize("number", [1, 2])
def test_to_the_one_that_is_meant_lead_the_first_stairs_however_doubtful_it_is(number: int):
    step, memory = remembering(floors=3)
    keep(memory, number, sofa(1.0, 1.0, score=0.6))
    for floor, thing in ((number, 1), (3 - number, 0), (3, 0)):
        memory.go_first_to(floor, thing)  # none of these is remembered
        assert stairs_to_errand(step, memory) is None
    memory.go_first_to(number, 0)
    there = certain(stairs_to_errand(step, memory))
    assert there.connector == 0
    assert there.xy == pytest.approx(memory.connectors[0].end, abs=0.5)
