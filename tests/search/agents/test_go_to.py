"""An agent that is sent to a place: what goes first, and how the way there ends."""

from dataclasses import replace

import pytest

from certainty import certain
from hypernav.app.build.agents import build_search
from hypernav.app.build.components.component_specs import PresetName
from hypernav.core.components.abilities import GoesWhereSent
from hypernav.core.exploring.operator_place import OperatorPlace, PlaceState
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog, Mode
from hypernav.search.agents.search import SearchAgent
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from hypernav.simulator.worlds.box_room import BoxRoom
from small_worlds import small_config

PLACE = OperatorPlace(1, 2.0, 1.2)


class Doubting(GroundTruthDetector):
    """Sees the goal, and is not sure of it."""

    def detect(self, observation, goal, **options):
        found = super().detect(observation, goal, **options)
        return [replace(one, score=0.5) for one in found]


def searching(goal: str, detector=None, preset: PresetName = "default") -> SearchAgent:
    agent = build_search(small_config(preset), detector or GroundTruthDetector(), ExchangeLog())
    agent.reset(Goal(goal))
    return agent


def driven(agent: SearchAgent, room: BoxRoom, steps: int) -> list[str]:
    """What is told of the place, until it is more than that it is on its way."""
    told = []
    for _ in range(steps):
        action = agent.act(room.observe())
        told += [one for one in agent.last_step.events if one in [e.event for e in PlaceState]]
        if (
            told not in ([], [PlaceState.ON_ITS_WAY.event])
            or action is None
            or agent.last_step.ending is not None
        ):
            break
        room.step(action)
    return told


@pytest.mark.parametrize("preset", ["default", "paper"])
def test_it_drives_there_by_the_shortest_way_and_looks_around(preset):
    agent, room = searching("piano", preset=preset), BoxRoom()
    assert isinstance(agent, GoesWhereSent)
    room.step(certain(agent.act(room.observe())))
    agent.go_to(PLACE)
    assert driven(agent, room, 12) == [PlaceState.ON_ITS_WAY.event, PlaceState.REACHED.event]
    assert room.pose.distance_to(*PLACE.xy) <= room.embodiment.motion.forward_m
    assert agent.last_step.mode is Mode.LOOK_AROUND
    agent.go_to(None)
    agent.act(room.observe())
    assert agent.last_step.events == []


def test_a_doubtful_sighting_waits_until_the_place_is_reached():
    agent, room = searching("door", Doubting()), BoxRoom()
    room.step(certain(agent.act(room.observe())))
    assert agent.last_step.mode is Mode.APPROACH
    agent.go_to(PLACE)
    room.step(certain(agent.act(room.observe())))
    assert (agent.last_step.mode, agent.last_step.destination) == (Mode.EXPLORE, PLACE.xy)
    assert driven(agent, room, 12)[-1] == PlaceState.REACHED.event
    room.step(certain(agent.last_step.action))
    agent.act(room.observe())
    assert agent.last_step.mode is Mode.APPROACH


def test_a_robot_that_gets_no_nearer_says_so_and_searches_on():
    agent, room = searching("piano"), BoxRoom()
    room.step(certain(agent.act(room.observe())))
    agent.go_to(PLACE)
    pose, told = room.pose, []
    for _ in range(100):
        agent.act(room.observe())
        told += [one for one in agent.last_step.events if "chosen" in one]
        room.pose = pose  # the wheels slip
    assert told[0] == PlaceState.ON_ITS_WAY.event
    assert told[1:] == [PlaceState.NO_PROGRESS.event]


def test_another_floor_has_no_path():
    agent, room = searching("piano"), BoxRoom()
    agent.go_to(replace(PLACE, floor=2))
    assert driven(agent, room, 1) == [PlaceState.ON_ITS_WAY.event, PlaceState.NO_PATH.event]


def test_a_new_search_forgets_the_place():
    agent, room = searching("piano"), BoxRoom()
    agent.go_to(PLACE)
    agent.reset(Goal("piano"))
    assert driven(agent, room, 2) == []
