"""Searches that remember: straight to what was seen, and on where it is gone."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest

from box_scenes import room_boxes, scene_of
from hypernav.app.build.agents import build_search
from hypernav.core.geometry.boxes import Detection
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog, Mode
from hypernav.lab.episodes.episode_run import EpisodeResult, EpisodeRun
from hypernav.search.memory.memory import Memory
from hypernav.search.memory.things import Things
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from hypernav.simulator.worlds.simulation import SimulatedWorld
from small_episodes import episode_from
from small_worlds import colourless_world, small_config, two_rooms

CONFIG = small_config()
START = Pose2(2.5, 1.0, 1.5)
IN_BEDROOM = Pose2(6.0, 3.0, 0.0)


def rooms(bed: tuple[float, float]) -> SimulatedWorld:
    """`two_rooms` with the bed's lower left corner elsewhere."""
    x, y = bed
    boxes = [
        *room_boxes(9.0, 4.0),
        (None, (4.95, 0.0, 0.0), (5.05, 2.6, 2.5)),
        (None, (4.95, 3.6, 0.0), (5.05, 4.0, 2.5)),
        ("sofa", (0.1, 1.2, 0.0), (0.9, 2.8, 0.7)),
        ("bed", (x, y, 0.0), (x + 1.0, y + 0.8, 0.5)),
    ]
    return colourless_world(scene_of(*boxes, name="two rooms"), CONFIG)


@contextmanager
def in_frame_of_start(world: SimulatedWorld) -> Iterator[None]:
    """The world, which other tests use, too, begins its episodes in one frame for a while."""
    world.keep_map_frame(START.to_transform())
    try:
        yield
    finally:
        world.keep_map_frame(None)


def searched(world, goal: str, start: Pose2, memory: Memory | None, **search):
    """The steps of a search in the frame of START, and the memory it leaves."""
    config = small_config(search=search)
    agent = build_search(config, GroundTruthDetector(), ExchangeLog())
    with in_frame_of_start(world):
        episode = episode_from(start, goal, max_steps=200)
        run = EpisodeRun(agent, world, episode, memory=memory or agent.new_memory())
        steps = [step.trace for step in run]
    return steps, run.result(), agent.memory


@pytest.fixture(scope="module")
def explored() -> Memory:
    """What a robot knows that has explored both rooms in vain."""
    _, _, memory = searched(two_rooms(coloured=False), "piano", START, None)
    return memory


@pytest.fixture
def memory(explored) -> Memory:
    """A copy of it."""
    return explored.copy()


def test_a_remembered_thing_is_gone_to_at_once(memory):
    steps, result, _ = searched(two_rooms(coloured=False), "sofa", IN_BEDROOM, memory)
    assert steps[0].reason == "on the way to a sofa seen before"
    assert steps[0].mode is Mode.RECALL
    assert result.metrics.success
    assert result.metrics.spl > 0.8
    assert not any(step.mode is Mode.LOOK_AROUND for step in steps)


def test_without_recall_the_map_is_known_and_the_thing_is_not_gone_to(memory):
    steps, _, _ = searched(two_rooms(coloured=False), "sofa", IN_BEDROOM, memory, recall=False)
    assert not any(" seen before" in step.reason for step in steps)


def test_what_is_hardly_likely_is_gone_to_when_nothing_is_left_to_explore(memory):
    floor = memory.floor
    doubted = tuple(replace(one, score=0.4) for one in floor.things.known)
    floor.things = replace(floor.things, known=doubted)
    steps, _, _ = searched(two_rooms(coloured=False), "sofa", IN_BEDROOM, memory)
    reasons = [step.reason for step in steps]
    recalls = [k for k, one in enumerate(reasons) if " seen before" in one]
    assert " seen before" not in reasons[0]
    assert not recalls or "block" in " ".join(reasons[: recalls[0]])


@pytest.mark.parametrize(
    ("goal", "is_gone_to"), [("sofa", True), ("the sofa beside the bed", False)]
)
def test_what_is_hardly_likely_where_it_is_waits_as_well(memory, goal, is_gone_to):
    steps, _, _ = searched(two_rooms(coloured=False), goal, IN_BEDROOM, memory)
    assert (steps[0].reason == "on the way to a sofa seen before") is is_gone_to


def test_the_present_search_recalls_nothing_of_its_own():
    steps, _, memory = searched(two_rooms(coloured=False), "piano", START, None)
    assert not memory.floor.things.known_before(memory.search.number).known
    assert not any(step.mode is Mode.RECALL for step in steps)
    assert not any(" seen before" in step.reason for step in steps)


def test_what_was_moved_is_missed_then_looked_for_and_found_and_remembered_where_it_is():
    before, after = rooms((7.5, 0.3)), rooms((7.5, 3.0))
    _, _, memory = searched(before, "piano", START, None)
    steps, result, memory = searched(after, "bed", START, memory)
    assert steps[0].reason == "on the way to a bed seen before"
    assert result.metrics.success
    beds = [one for one in memory.floor.things.known if one.label == "bed"]
    assert sum(not one.is_gone for one in beds) >= 1
    _, again, _ = searched(after, "bed", START, memory)
    assert again.metrics.success
    assert again.steps <= result.steps


def test_what_was_taken_away_is_looked_for_everywhere_and_then_given_up(memory):
    without = rooms((7.5, 0.3))
    empty = colourless_world(
        scene_of(
            *room_boxes(9.0, 4.0),
            (None, (4.95, 0.0, 0.0), (5.05, 2.6, 2.5)),
            (None, (4.95, 3.6, 0.0), (5.05, 4.0, 2.5)),
            ("bed", (7.5, 0.3, 0.0), (8.5, 1.1, 0.5)),
            name="two rooms",
        ),
        CONFIG,
    )
    _, _, known = searched(without, "piano", START, None)
    steps, result, known = searched(empty, "sofa", IN_BEDROOM, known)
    assert not result.metrics.success
    assert steps[-1].reason == "nothing is left to explore"
    assert known.search.revisits
    (sofa,) = [one for one in known.floor.things.known if one.label == "sofa"]
    assert sofa.is_gone
    assert known.floor.things.fitting(Goal("sofa")) == []


def test_a_thing_that_was_never_seen_is_looked_for_again_where_all_is_known(memory):
    steps, _, known = searched(two_rooms(coloured=False), "piano", IN_BEDROOM, memory)
    assert any("all is known, looking again" in step.events for step in steps)
    over = known.search.coverage
    assert over is not None
    grid = known.floor.map.grid
    assert over.cells[grid.explored].mean() > 0.7


def test_another_of_the_goal_s_kind_does_not_make_the_robot_look_at_all_again(memory):
    steps, _, known = searched(two_rooms(coloured=False), "red sofa", IN_BEDROOM, memory)
    events = [event for step in steps for event in step.events]
    assert steps[0].reason == "on the way to a sofa seen before"
    assert "remembered thing is gone" not in events
    assert events.index("remembered thing is another") < events.index("all is known, looking again")
    assert not any(one.missed for one in known.floor.things.known)


def test_a_thing_is_gone_to_on_the_side_that_it_was_seen_from():
    """What hides it from the others, such as the wall that it hangs on, may be on no map."""
    boxes = [*room_boxes(9.0, 4.0), ("bed", (4.2, 1.6, 0.0), (4.8, 2.4, 0.5))]
    world = colourless_world(scene_of(*boxes, name="hall"), CONFIG)
    _, _, memory = searched(world, "piano", Pose2(2.0, 1.0, 1.5), None)
    (bed,) = memory.floor.things.known
    for x in (1.0, 8.0):
        (seen_from,) = world.map_to_scene.inverse().apply(np.array([[x, 2.0, 0.0]]))
        things = replace(bed, views=((*seen_from[:2], 1.0),))
        known = memory.copy()
        known.floor.things = replace(known.floor.things, known=(things,))
        steps, _, _ = searched(world, "bed", Pose2(2.0, 2.0, 3.14), known)
        assert steps[0].destination is not None
        (there,) = world.map_to_scene.apply(np.array([[*steps[0].destination, 0.0]]))
        assert (there[0] > 4.5) == (x > 4.5)


@pytest.mark.slow
def test_what_cannot_be_come_near_is_gone_to_where_it_is_in_sight():
    """Not as far as where it was seen best, which may be at the other end of the hall."""
    tables = [
        ("table", (1.2, 0.3, 0.0), (1.9, 3.7, 0.7)),
        ("table", (0.2, 0.3, 0.0), (1.2, 1.2, 0.7)),
        ("table", (0.2, 2.8, 0.0), (1.2, 3.7, 0.7)),
    ]
    vase = ("vase", (0.3, 1.8, 0.0), (0.6, 2.2, 0.9))
    world = colourless_world(scene_of(*room_boxes(9.0, 4.0), *tables, vase, name="hall"), CONFIG)
    _, _, memory = searched(world, "piano", Pose2(5.0, 2.0, 3.0), None)
    (known,) = [one for one in memory.floor.things.known if one.label == "vase"]
    ((x, y, _),) = world.map_to_scene.inverse().apply(np.array([[7.5, 2.0, 0.0]]))
    things = replace(known, views=((x, y, 1.0),))
    memory.floor.things = replace(memory.floor.things, known=(things,))
    steps, _, _ = searched(world, "vase", Pose2(6.0, 3.0, 0.0), memory)
    assert steps[0].destination is not None
    (there,) = world.map_to_scene.apply(np.array([[*steps[0].destination, 0.0]]))
    assert 1.9 < there[0] < 5.0


def test_what_is_not_in_sight_from_beside_it_is_looked_for_from_where_it_was_seen():
    """The map at the height of the eyes tells nothing of a low cabinet that hides a low thing."""
    boxes = [
        *room_boxes(9.0, 4.0),
        ("cabinet", (3.9, 1.2, 0.0), (4.2, 2.3, 0.8)),
        ("trash can", (4.35, 1.85, 0.0), (4.65, 2.15, 0.3)),
    ]
    world = colourless_world(scene_of(*boxes, name="hall"), CONFIG)
    _, _, memory = searched(world, "piano", Pose2(2.5, 1.0, 1.5), None)
    (can,) = [one for one in memory.floor.things.known if one.label == "trash can"]
    ((x, y, _),) = world.map_to_scene.inverse().apply(np.array([[3.3, 3.3, 0.0]]))
    can = replace(can, views=((x, y, 1.0),))
    memory.floor.things = replace(memory.floor.things, known=(can,))
    steps, result, _ = searched(world, "trash can", Pose2(2.0, 2.0, 3.14), memory)
    (hidden,) = [one for one in steps if "remembered thing not in sight from here" in one.events]
    assert hidden.destination == pytest.approx((x, y))
    assert result.metrics.success
    assert not any("block" in one.reason for one in steps)


TWO_SOFAS = [
    *room_boxes(9.0, 4.0),
    ("sofa", (0.1, 1.2, 0.0), (0.9, 2.8, 0.7)),
    ("sofa", (8.1, 1.2, 0.0), (8.9, 2.8, 0.7)),
]


@pytest.mark.parametrize("meant", [True, False])
def test_a_robot_that_is_sent_to_one_thing_passes_others_of_its_kind(meant):
    world = colourless_world(scene_of(*TWO_SOFAS, name="hall"), CONFIG)
    _, _, memory = searched(world, "piano", Pose2(4.5, 1.0, 1.5), None)
    start = Pose2(3.0, 2.0, 3.14)
    sofas = [one for one in memory.floor.things.known if one.label == "sofa"]
    far = max(sofas, key=lambda one: (world.map_to_scene.apply(np.array([one.position])))[0, 0])
    agent = build_search(CONFIG, GroundTruthDetector(), ExchangeLog())
    with in_frame_of_start(world):
        run = EpisodeRun(agent, world, episode_from(start, "sofa", max_steps=200), memory=memory)
        if meant:
            memory.go_first_to(0, far.number)
        assert all(step.trace.action is not None for step in run)
    assert run.result().metrics.success
    assert (world.pose.x > 4.5) is meant


@pytest.mark.parametrize(("goal", "x"), [("the sofa beside the bin", 9.0), ("red sofa", 0.0)])
def test_what_lies_where_the_goal_is_said_to_be_is_gone_to_before_what_is_nearer(goal, x):
    beside = ("trash can", (8.2, 3.0, 0.0), (8.5, 3.3, 0.4))
    world = colourless_world(scene_of(*TWO_SOFAS, beside, name="hall"), CONFIG)
    _, _, memory = searched(world, "piano", Pose2(4.5, 1.0, 1.5), None)
    steps, _, _ = searched(world, goal, Pose2(3.6, 2.0, 1.5), memory)
    assert steps[0].destination is not None
    (there,) = world.map_to_scene.apply(np.array([[*steps[0].destination, 0.0]]))
    assert abs(there[0] - x) < 3.0


@pytest.mark.parametrize(("start", "x"), [(3.6, 0.0), (5.4, 9.0)])
def test_a_robot_on_its_way_to_the_nearer_thing_passes_one_that_it_sees_farther_away(start, x):
    world = colourless_world(scene_of(*TWO_SOFAS, name="hall"), CONFIG)
    _, _, memory = searched(world, "piano", Pose2(4.5, 1.0, 1.5), None)
    looks_away = Pose2(start, 2.0, 0.0 if start < 4.5 else np.pi)
    _, result, _ = searched(world, "sofa", looks_away, memory)
    assert result.metrics.success
    assert abs(world.pose.x - x) < 3.0


class Unsure(GroundTruthDetector):
    """Is half sure of a red sofa and quite sure of all else."""

    def detect(self, observation, goal):
        return list(map(half_sure, super().detect(observation, goal)))

    def things_in(self, observation, detections):
        return list(map(half_sure, super().things_in(observation, detections)))


def half_sure(one: Detection) -> Detection:
    return replace(one, score=0.5) if one.label == "red sofa" else one


def test_of_many_alike_none_is_as_likely_as_one_alone_when_another_is_in_sight():
    hall, left, right = room_boxes(9.0, 4.0), TWO_SOFAS[-2], ("red sofa", *TWO_SOFAS[-1][1:])
    before = colourless_world(scene_of(*hall, left, name="hall"), CONFIG)
    world = colourless_world(scene_of(*hall, left, right, name="hall"), CONFIG)
    _, _, memory = searched(before, "piano", Pose2(4.5, 1.0, 1.5), None)
    (sofa,) = memory.floor.things.known
    far = [
        replace(sofa, number=k, low=(k, 90.0, 0.0), high=(k + 0.9, 91.6, 0.7)) for k in range(1, 8)
    ]
    memory.floor.things = Things((sofa, *far), 8)
    agent = build_search(CONFIG, Unsure(), ExchangeLog())
    with in_frame_of_start(world):
        episode = episode_from(Pose2(4.0, 2.0, 0.0), "red sofa")
        step = next(iter(EpisodeRun(agent, world, episode, memory=memory))).trace
    assert step.reason == "going to the red sofa"


def test_being_sent_to_what_is_forgotten_or_gone_is_a_search_like_any(memory):
    agent = build_search(CONFIG, GroundTruthDetector(), ExchangeLog())
    world = two_rooms(coloured=False)
    episode = episode_from(IN_BEDROOM, "sofa", max_steps=200)
    with in_frame_of_start(world):
        run = EpisodeRun(agent, world, episode, memory=memory)
        for floor, number in ((0, 10_000), (7, 0)):
            memory.go_first_to(floor, number)
        assert memory.search.meant is None
        reasons = [step.trace.reason for step in run]
    assert reasons[0] == "on the way to a sofa seen before"
    assert run.result().metrics.success


def test_a_robot_is_sent_to_one_thing_though_another_has_the_goal_s_own_name(memory):
    (sofa,) = [one for one in memory.floor.things.known if one.label == "sofa"]
    red = replace(sofa, number=9_999, label="red sofa")
    things = memory.floor.things
    memory.floor.things = replace(things, known=(*things.known, red))
    agent, world = (
        build_search(CONFIG, GroundTruthDetector(), ExchangeLog()),
        two_rooms(coloured=False),
    )
    with in_frame_of_start(world):
        run = EpisodeRun(agent, world, episode_from(IN_BEDROOM, "red sofa"), memory=memory)
        memory.go_first_to(0, sofa.number)
        step = next(iter(run)).trace
    assert step.reason == "on the way to a sofa seen before"


def sent_to_the_sofa(memory, change) -> EpisodeResult:
    """The search of a robot that is sent to the sofa, after a change of what is remembered."""
    agent, world = (
        build_search(CONFIG, GroundTruthDetector(), ExchangeLog()),
        two_rooms(coloured=False),
    )
    episode = episode_from(IN_BEDROOM, "sofa", max_steps=200)
    with in_frame_of_start(world):
        run = EpisodeRun(agent, world, episode, memory=memory)
        (sofa,) = [one for one in memory.floor.things.known if one.label == "sofa"]
        memory.go_first_to(0, sofa.number)
        assert memory.search.errand(memory.floor.things, Goal("sofa")) == sofa
        others = tuple(one for one in memory.floor.things.known if one is not sofa)
        memory.floor.things = replace(memory.floor.things, known=(*others, change(sofa)))
        for _ in run:
            pass
    return run.result()


def test_a_robot_finds_what_it_was_sent_to_though_its_record_became_another(memory):
    """Two records of one thing become one, which has the number of either."""
    result = sent_to_the_sofa(memory, lambda sofa: replace(sofa, number=9_999))
    assert result.metrics.success


def test_being_sent_to_what_turns_out_to_be_gone_is_a_search_like_any(memory):
    result = sent_to_the_sofa(memory, lambda sofa: replace(sofa, missed=100))
    assert result.metrics.success
