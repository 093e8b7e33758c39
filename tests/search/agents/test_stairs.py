"""A search goes over stairs to what is on another floor."""

import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from box_scenes import Box, scene_of
from box_views import FLOOR, view_of
from chat_models import Parrot
from hypernav.app.build.agents import build_search
from hypernav.app.build.presets import preset
from hypernav.core.chat import Question
from hypernav.core.embodiment import Action
from hypernav.core.episode import Episode
from hypernav.core.exploring.exploration import ExplorationView
from hypernav.core.geometry.grid import Cell
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog, Mode, StepTrace
from hypernav.io.foreign_folder import ForeignFolder
from hypernav.search.mapping.stairs.connectors import Connector, Passage, UnderWay, with_crossing
from hypernav.search.memory.memory import Memory
from hypernav.search.memory.store.memory_reader import read_memory
from hypernav.search.memory.store.memory_writer import Writer
from hypernav.search.memory.thing import Thing
from hypernav.search.memory.things import Things
from hypernav.search.perception.config import VlmReasonerConfig
from hypernav.search.perception.explorers.geometric_reasoner import GeometricReasoner
from hypernav.search.perception.explorers.map_question import VlmReasoner
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from hypernav.simulator.worlds.simulation import SimulatedWorld
from searches import searched
from small_episodes import episode_from
from small_worlds import colourless_world
from stair_views import FIRST_X, RISE_M, SIDES_Y, STEPS, TREAD_M

CONFIG = preset("default").with_(embodiment={"body": {"max_step_m": 0.2}})
ABOVE_M = STEPS * RISE_M
CAMERA = CONFIG.embodiment.camera.intrinsics
START_X = 1.5
HEAD_X = FIRST_X + (STEPS - 1) * TREAD_M


@cache
def split_level(steps: int = STEPS, *, two_sofas: bool = False) -> SimulatedWorld:
    """A room with a sofa; stairs between walls lead from it to one with a bed, 1.8 m higher.

    The upper room may have a sofa, too.
    """
    low, high = SIDES_Y
    above_m, head_x = steps * RISE_M, FIRST_X + (steps - 1) * TREAD_M
    boxes: list[Box] = [
        (None, (-0.1, -0.1, -0.1), (13.1, 4.1, 0.0)),
        (None, (-0.1, -0.1, 0.0), (13.1, 0.0, 4.4)),
        (None, (-0.1, 4.0, 0.0), (13.1, 4.1, 4.4)),
        (None, (-0.1, 0.0, 0.0), (0.0, 4.0, 4.4)),
        (None, (13.0, 0.0, 0.0), (13.1, 4.0, 4.4)),
        (None, (-0.1, -0.1, 4.4), (13.1, 4.1, 4.5)),
        (None, (FIRST_X, 0.0, 0.0), (head_x, low, 4.4)),
        (None, (FIRST_X, high, 0.0), (head_x, 4.0, 4.4)),
        (None, (head_x, 0.0, 0.0), (13.0, 4.0, above_m)),
        ("sofa", (0.1, 3.0, 0.0), (1.6, 3.9, 0.7)),
        ("bed", (11.0, 0.1, above_m), (12.9, 1.7, above_m + 0.5)),
    ]
    if two_sofas:
        boxes.append(("sofa", (7.4, 3.0, above_m), (8.9, 3.9, above_m + 0.7)))
    boxes += [
        (
            None,
            (FIRST_X + k * TREAD_M, low, 0.0),
            (FIRST_X + (k + 1) * TREAD_M, high, (k + 1) * RISE_M),
        )
        for k in range(steps - 1)
    ]
    scene = replace(scene_of(*boxes, name="split level"), storeys=(0.0, above_m))
    return colourless_world(scene, CONFIG)


def search(goal: str, *, steps: int = STEPS, **switches: bool) -> tuple[list[StepTrace], Memory]:
    """The trace of a search from the lower room, and what it knows after."""
    config = CONFIG.model_copy(update={"search": CONFIG.search.model_copy(update=switches)})
    agent = build_search(config, GroundTruthDetector())
    start = episode_from(Pose2(START_X, 1.0, 0.0), goal, start_z=0.0)
    return searched(agent, split_level(steps), start, most_steps=250), agent.memory


@pytest.mark.slow
def test_a_search_goes_up_to_the_goal():
    trace, memory = search("bed")
    assert trace[-1].action is Action.STOP
    assert [one.z for one in memory.floors] == pytest.approx([0.0, ABOVE_M], abs=0.1)
    assert [one.floor for one in (trace[0], trace[-1])] == [None, 2]
    climbing = [one for one in trace if one.mode is Mode.CLIMB]
    assert climbing
    assert all(one.reason.startswith("on the stairs up") for one in climbing)
    assert {one.passage for one in memory.connectors} == {Passage.USED}
    assert [trace[0].z, trace[-1].z] == pytest.approx([0.0, ABOVE_M], abs=0.1)
    assert [one.z for one in climbing] == sorted(one.z for one in climbing)
    on_stairs_x = [one.pose[0] + START_X for one in climbing]
    assert max(x for x, _ in memory.floors[0].trajectory) + START_X < FIRST_X + 2.0 * TREAD_M
    assert max(on_stairs_x) > HEAD_X - TREAD_M


@pytest.mark.slow
@pytest.mark.parametrize("steps", [10, 13])
@pytest.mark.parametrize("start", [Pose2(11.5, 3.0, math.pi), Pose2(11.5, 2.5, math.pi / 2.0)])
def test_where_the_mesh_floats_above_the_upper_floor_a_search_goes_down_to_the_goal(start, steps):
    world, agent = split_level(steps), build_search(CONFIG, GroundTruthDetector())
    above_m = steps * RISE_M
    episode = episode_from(start, "sofa", start_z=above_m)
    world.reset(episode)
    assert world.position[2] - above_m >= 0.09
    trace = searched(agent, world, episode, most_steps=90)
    assert trace[-1].action is Action.STOP
    assert len(agent.memory.floors) == 2
    (left, _) = agent.memory.connectors
    assert left.passage is Passage.USED


@pytest.mark.slow
def test_without_stairs_a_search_stays_on_its_floor():
    trace, memory = search("bed", use_stairs=False)
    assert trace[-1].action is not Action.STOP
    assert len(memory.floors) == 1
    assert not memory.connectors
    assert all(one.mode is not Mode.CLIMB for one in trace)


@pytest.mark.slow
def test_a_search_comes_back_by_the_stairs_that_it_took():
    trace, memory = search("umbrella")
    floors = [one.floor for one in trace if one.mode is not Mode.CLIMB]
    assert floors[-1] == 1
    assert 2 in floors
    assert memory.number == 0
    last_climb = next(one for one in reversed(trace) if one.mode is Mode.CLIMB)
    assert last_climb.reason == "on the stairs to floor 1"


@pytest.mark.parametrize("steps", [2, 4])
def test_a_level_of_the_same_floor_is_drawn_on_its_map(steps):
    world = split_level(steps)
    agent = build_search(CONFIG, GroundTruthDetector())
    agent.reset(Goal("umbrella"))
    start = Pose2(START_X, sum(SIDES_Y) / 2.0, 0.0)
    agent.act(world.reset(Episode("x", "0", Goal("umbrella"), start, start_z=0.0)))
    while world.pose.x < HEAD_X + 2.0:
        agent.act(world.step(Action.MOVE_FORWARD))
    memory = agent.memory
    assert not memory.on_stairs
    assert len(memory.floors) == 1
    assert memory.footing.z == pytest.approx(steps * RISE_M, abs=0.1)
    grid = agent.grid
    ahead = [grid.cell_of(world.pose.x - START_X + k * 0.25, 0.0) for k in range(7)]
    assert {int(grid.cells[cell]) for cell in ahead} == {Cell.FREE}


@pytest.mark.slow
def test_stairs_to_a_level_of_the_same_floor_lead_somewhere():
    trace, memory = search("bed", steps=4)
    assert trace[-1].action is Action.STOP
    assert any(one.mode is Mode.CLIMB for one in trace)
    assert "another level reached" in [event for one in trace for event in one.events]
    assert len(memory.floors) == 1
    assert {one.passage for one in memory.connectors if one.goes_up} == {Passage.USED}


def test_the_way_over_stairs_is_known_until_the_next_search():
    world, agent = split_level(), build_search(CONFIG, GroundTruthDetector())
    agent.reset(Goal("umbrella"))
    start = Pose2(START_X, sum(SIDES_Y) / 2.0, 0.0)
    agent.act(world.reset(Episode("x", "0", Goal("umbrella"), start, start_z=0.0)))
    frames = 1
    while not agent.memory.on_stairs:
        agent.act(world.step(Action.MOVE_FORWARD))
        frames += 1
    assert len(agent.memory.track) == frames
    assert agent.memory.track[-1] == agent.last_step.pose[:2]
    agent.reset(Goal("bed"), agent.memory)
    assert not agent.memory.track


def test_a_search_that_begins_on_stairs_is_not_blind():
    world, agent = split_level(), build_search(CONFIG, GroundTruthDetector())
    agent.reset(Goal("umbrella"))
    start = Pose2(START_X, sum(SIDES_Y) / 2.0, 0.0)
    agent.act(world.reset(Episode("x", "0", Goal("umbrella"), start, start_z=0.0)))
    while world.pose.x < FIRST_X + 2.5 * TREAD_M:
        agent.act(world.step(Action.MOVE_FORWARD))
    agent.memory.set_current_connector(None)
    agent.reset(Goal("bed"), agent.memory)
    for _ in range(6):  # turns to the lower room
        agent.act(world.step(Action.TURN_LEFT))
    memory = agent.memory
    assert memory.footing.z > 0.3
    assert not memory.on_stairs
    before = len(memory.floor.trajectory)
    agent.act(world.step(Action.TURN_LEFT))
    assert len(memory.floor.trajectory) == before + 1


@pytest.mark.slow
@pytest.mark.parametrize("on_disk", [False, True])
@pytest.mark.parametrize("last", ["in the middle", "at the end"])
def test_stairs_on_which_a_search_ended_are_known_to_the_next_one(tmp_path, last: str, on_disk):
    world, agent = split_level(), build_search(CONFIG, GroundTruthDetector())
    first = episode_from(Pose2(START_X, 1.0, 0.0), "umbrella", start_z=0.0)
    agent.reset(first.goal, agent.new_memory())
    seen = world.reset(first)
    ends_m = ABOVE_M / 2.0 if last == "in the middle" else ABOVE_M - 0.05
    while (action := agent.act(seen)) is not None and world.position[2] < ends_m:
        seen = world.step(action)
    memory = agent.memory
    assert {one.passage for one in memory.connectors if one.goes_up} == {Passage.UNTRIED}
    if on_disk:
        memory = written_and_read(memory, tmp_path)
        memory.begin_at(seen)
    assert agent.last_step.mode is Mode.CLIMB
    agent.reset(Goal("bed"), memory)
    reasons = list[str]()
    while (action := agent.act(seen)) is not None and len(reasons) < 80:
        reasons.append(agent.last_step.reason)
        if action is Action.STOP:
            break
        seen = world.step(action)
    assert action is Action.STOP
    assert reasons[0] == "on the stairs up"
    ways = {(one.floor, one.other_floor) for one in memory.connectors if one.is_usable}
    assert ways == {(0, 1), (1, 0)}


def test_a_robot_that_was_carried_is_not_on_its_way_over_stairs():
    memory = Memory(CONFIG.mapping, CONFIG.embodiment)
    memory.connectors = (Connector(0, True, (1.0, 0.0), 0.0),)
    memory.track.append((1.5, 0.0))
    memory.set_current_connector(0)
    assert memory.under_way == UnderWay(0, (1.5, 0.0, 0.0))
    memory.begin_search(sees_stairs=True)
    memory.follow(view_of([FLOOR], Pose2(4.0, 0.0, 0.0), camera=CAMERA))
    assert memory.under_way is None


def written_and_read(memory: Memory, folder: Path) -> Memory:
    with ForeignFolder(folder) as home:
        Writer(home, None).write(memory, None, (), most_bytes=10**9)
        contents = read_memory(home, CONFIG.mapping, CONFIG.embodiment, most_bytes=10**9)
    assert contents is not None
    return contents.memory


def takes_stairs(question: Question) -> str:
    """The answer of a model that wants to change floor."""
    options = [one for one in question.text.splitlines() if one.startswith("- block")]
    away = [one for one in options if "another floor" in one or "on floor" in one]
    return (away or options)[0].removeprefix("- block ").partition(":")[0]


@pytest.mark.slow
def test_a_model_sends_the_robot_upstairs_and_to_what_is_unseen_there():
    log, model = ExchangeLog(), Parrot(takes_stairs)
    asks = VlmReasonerConfig(skip_only_block=False)
    reasoner = VlmReasoner(model, log, GeometricReasoner(log), asks)
    world = split_level()
    agent = build_search(CONFIG, GroundTruthDetector(), log, reasoner=reasoner)
    start = Episode("x", "0", Goal("umbrella"), Pose2(START_X, 1.0, 0.0), start_z=0.0)

    def searched_until_upstairs(memory: Memory | None) -> StepTrace:
        """The first step of exploration on the upper floor."""
        agent.reset(Goal("umbrella"), memory)
        observation = world.reset(start)
        agent.memory.begin_at(observation)
        for _ in range(120):
            action = agent.act(observation)
            if (agent.last_step.mode, agent.memory.number) == (Mode.EXPLORE, 1):
                break
            assert action is not None
            observation = world.step(action)
        return agent.last_step

    searched_until_upstairs(agent.new_memory())
    assert "stairs up to another floor" in model.asked[0].text
    model.asked.clear()
    step = searched_until_upstairs(agent.memory)
    assert agent.memory.number == 1
    (question,) = model.asked
    assert "on floor 2, 1.8 m higher" in question.text
    assert step.destination is not None
    assert step.reason.startswith("block ")


def test_a_robot_that_gets_onto_stairs_on_its_way_takes_them():
    world, agent = split_level(), build_search(CONFIG, GroundTruthDetector())
    agent.reset(Goal("umbrella"))
    start = Pose2(START_X, sum(SIDES_Y) / 2.0, 0.0)
    agent.act(world.reset(Episode("x", "0", Goal("umbrella"), start, start_z=0.0)))
    for action in (Action.MOVE_FORWARD, Action.TURN_LEFT, Action.TURN_RIGHT):
        agent.act(world.step(action))  # sees the stairs twice
    trace: list[StepTrace] = []
    while world.pose.x < FIRST_X + 3.5 * TREAD_M:
        agent.act(world.step(Action.MOVE_FORWARD))
        trace.append(agent.last_step)
    assert "came onto stairs sooner than planned" in [
        event for one in trace for event in one.events
    ]
    assert trace[-1].mode is Mode.CLIMB
    assert trace[-1].reason.startswith("on the stairs up")  # nobody knows where to
    for _ in range(3):
        agent.act(world.step(Action.TURN_LEFT))
    assert agent.memory.footing.ground_z == 0.0


@pytest.mark.parametrize("were_taken", [True, False])
def test_a_robot_that_strays_onto_stairs_that_it_has_taken_stays_on_its_floor(were_taken: bool):
    """Else its floor would be an obstacle from there, and nothing left to explore."""
    world, agent = split_level(), build_search(CONFIG, GroundTruthDetector())
    agent.reset(Goal("umbrella"))
    start = Pose2(START_X, sum(SIDES_Y) / 2.0, 0.0)
    agent.act(world.reset(Episode("x", "0", Goal("umbrella"), start, start_z=0.0)))
    for action in (Action.MOVE_FORWARD, Action.TURN_LEFT, Action.TURN_RIGHT):
        agent.act(world.step(action))
    memory, passage = agent.memory, Passage.USED if were_taken else Passage.REFUTED
    memory.connectors = tuple(replace(one, passage=passage) for one in memory.connectors)
    if were_taken:
        memory.connectors = tuple(replace(one, other_floor=0) for one in memory.connectors)
    while not memory.on_stairs:
        agent.act(world.step(Action.MOVE_FORWARD))
    for action in (Action.TURN_LEFT, Action.TURN_LEFT):
        agent.act(world.step(action))
    assert memory.on_stairs == were_taken
    assert (memory.footing.ground_z == 0.0) == were_taken


def test_a_robot_that_gets_onto_stairs_down_that_it_has_not_seen_takes_them():
    world, agent = split_level(), build_search(CONFIG, GroundTruthDetector())
    agent.reset(Goal("umbrella"))
    away = Pose2(HEAD_X + 0.3, sum(SIDES_Y) / 2.0, 0.0)
    observation = world.reset(Episode("x", "0", Goal("umbrella"), away, start_z=ABOVE_M))
    agent.act(observation)
    for _ in range(6):
        observation = world.step(Action.TURN_LEFT)
    while world.position[2] > ABOVE_M - 1.5 * RISE_M:
        observation = world.step(Action.MOVE_FORWARD)
    assert not agent.memory.connectors
    agent.act(observation)
    assert "came onto stairs sooner than planned" in agent.last_step.events
    assert agent.last_step.mode is Mode.CLIMB
    (stairs,) = agent.memory.connectors
    assert not stairs.goes_up
    assert stairs.is_new


def test_the_paper_stays_on_one_floor():
    assert not preset("paper").search.use_stairs
    assert preset("default").search.use_stairs


def search_above_for_the_sofa(*, is_sent: bool, two_sofas: bool, steps: int = 150):
    """The trace of a search from the upper room for a sofa that is known below, and the memory.

    Args:
        is_sent: Whether that sofa alone is meant.
        two_sofas: Whether there is one above, too.
        steps: Number of steps that the search has.
    """
    world, agent = split_level(two_sofas=two_sofas), build_search(CONFIG, GroundTruthDetector())
    memory = Memory(CONFIG.mapping, CONFIG.embodiment)
    low = Episode("x", "0", Goal("bed"), Pose2(START_X, 1.0, 0.0), start_z=0.0)
    high = replace(low, goal=Goal("sofa"), start=Pose2(10.0, 2.5, math.pi), start_z=ABOVE_M)
    trace = list[StepTrace]()
    for episode, most in ((low, 150), (high, steps)):
        agent.allow_steps(most)
        agent.reset(episode.goal, memory)
        observation = world.reset(episode)
        world.keep_map_frame(world.map_to_scene)
        if episode is high:
            memory.begin_at(observation)
            (sofa,) = [one for one in memory.floors[0].things.known if one.label == "sofa"]
            if is_sent:
                memory.go_first_to(0, sofa.number)
            floor, couch = memory.floors[0], replace(sofa, number=999, label="couch", score=0.8)
            floor.things = replace(floor.things, known=(couch, *floor.things.known))
        trace.clear()
        while len(trace) < most:
            action = agent.act(observation)
            trace.append(agent.last_step)
            if action is None or action is Action.STOP:
                break
            observation = world.step(action)
    world.keep_map_frame(None)
    return trace, memory


@pytest.mark.slow
@pytest.mark.parametrize(
    ("is_sent", "two_sofas", "reason"),
    [
        (True, False, "the sofa that is meant is on another floor: stairs down"),
        (True, True, "the sofa that is meant is on another floor: stairs down"),
        (False, False, "a sofa was seen on another floor: stairs down"),
    ],
)
def test_a_robot_takes_the_stairs_that_it_knows_to_a_thing_on_another_floor(
    is_sent, two_sofas, reason
):
    trace, memory = search_above_for_the_sofa(is_sent=is_sent, two_sofas=two_sofas)
    assert not (is_sent and trace[0].mode is Mode.LOOK_AROUND)
    assert next(one.reason for one in trace if one.mode is not Mode.LOOK_AROUND) == reason
    climbed = [one.reason for one in trace if one.mode is Mode.CLIMB]
    assert all(one.startswith("on the stairs to floor 1") for one in climbed)
    assert trace[-1].action is Action.STOP
    assert memory.number == 0


def test_a_robot_looks_at_what_is_unseen_before_it_takes_stairs_to_a_thing():
    world, agent = split_level(), build_search(CONFIG, GroundTruthDetector())
    memory = Memory(CONFIG.mapping, CONFIG.embodiment)
    memory.floor.trajectory = [(0.0, 0.0)]
    memory.add_floor(-ABOVE_M)
    head = (10.0 - HEAD_X, 2.5 - sum(SIDES_Y) / 2.0)
    down = Connector(0, False, head, 0.0, Passage.USED, other_floor=1, sightings=2)
    memory.connectors = with_crossing((down,), 0, 1, (head[0] + 2.0, head[1]), math.pi)
    bed = Thing(0, "bed", 1.0, (8.0, 0.0, 0.0), (9.0, 1.0, 0.5), ((7.0, 0.0, 1.0),), 999.0, 1, 1)
    memory.floors[1].things, memory.searches = Things((bed,), 1), 1
    start = Pose2(10.0, 2.5, math.pi)  # with its back to another bed
    seen = world.reset(Episode("x", "0", Goal("bed"), start, start_z=ABOVE_M))
    agent.reset(Goal("bed"), memory)
    modes = list[Mode]()
    while (action := agent.act(seen)) is not Action.STOP and len(modes) < 20:
        assert action is not None
        modes.append(agent.last_step.mode)
        seen = world.step(action)
    assert action is Action.STOP
    assert modes[0] is Mode.LOOK_AROUND
    assert memory.number == 0


@pytest.mark.slow
@pytest.mark.parametrize("is_sent", [True, False])
def test_what_is_meant_on_another_floor_is_not_taken_for_one_of_this_as_steps_run_out(is_sent):
    trace, memory = search_above_for_the_sofa(is_sent=is_sent, two_sofas=True, steps=16)
    assert memory.number == 1
    assert (trace[-1].action is Action.STOP) is not is_sent


PIANO = Episode("x", "0", Goal("piano"), Pose2(START_X, 1.0, 0.0), start_z=0.0)
"""A search for what is on neither floor."""


class KnowsAll:
    """An explorer with nothing left to explore on this floor."""

    def next_destination(self, view: ExplorationView) -> None:
        return None


@pytest.fixture(scope="module")
def barely_entered() -> Memory:
    """What a robot knows that has explored the lower room, and has just come up."""
    world, agent = split_level(), build_search(CONFIG, GroundTruthDetector())
    memory = Memory(CONFIG.mapping, CONFIG.embodiment)
    agent.reset(PIANO.goal, memory)
    observation = world.reset(PIANO)
    while memory.number == 0 and (action := agent.act(observation)) is not None:
        observation = world.step(action)
    assert memory.number == 1
    assert [one.was_explored for one in memory.floors] == [True, False]
    return memory


@pytest.mark.slow
@pytest.mark.parametrize("was_explored", [False, True])
def test_where_a_floor_is_known_stairs_to_what_is_unseen_come_before_looking_again(
    barely_entered, was_explored
):
    world, agent = split_level(), build_search(CONFIG, GroundTruthDetector())
    memory = barely_entered.copy()
    memory.floors[1].was_explored = was_explored
    agent.components = replace(agent.components, explorer=KnowsAll())
    agent.reset(PIANO.goal, memory)
    observation = world.reset(PIANO)
    memory.begin_at(observation)
    agent.act(observation)
    assert agent.last_step.reason == "nothing is left to explore on this floor: stairs up"
    assert agent.last_step.events == (["all is known, looking again"] if was_explored else [])


@pytest.mark.slow
def test_a_robot_comes_back_to_look_again_and_stays_for_it_where_all_is_known(barely_entered):
    world, agent = split_level(), build_search(CONFIG, GroundTruthDetector())
    memory = barely_entered.copy()
    again = list[list[int]]()
    for _ in range(2):
        agent.reset(PIANO.goal, memory)
        observation = world.reset(PIANO)
        memory.begin_at(observation)
        again.append([])
        for _ in range(400):
            action = agent.act(observation)
            if "all is known, looking again" in agent.last_step.events:
                again[-1].append(memory.number)
            if action is None:
                break
            observation = world.step(action)
        assert agent.last_step.reason == "nothing is left to explore"
        assert all(one.was_explored for one in memory.floors)
    assert again[0][-1] == 0
    assert again[1] == [0, 1]
