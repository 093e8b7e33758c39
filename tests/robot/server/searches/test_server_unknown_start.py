"""Searches of robots that don't know where they start in the memory of their server."""

import json
import math
import shutil
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from box_scenes import room_boxes, scene_of
from hypernav.core.embodiment import Action
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.observation import Observation
from hypernav.core.trace import Mode
from hypernav.robot.server.searches.agents import AgentPlan, PlanAgent
from hypernav.robot.wire.frames import pack_observation
from hypernav.robot.wire.requests import ObservationFacts, OpenSearch
from hypernav.robot.wire.values import PlanarPose
from hypernav.search.memory.memory import Memory
from hypernav.search.memory.start.relocalization import FoundStart, found_by_turn
from hypernav.search.memory.store.memory_folder import MemoryFolder
from hypernav.search.memory.store.memory_reader import read_index
from hypernav.simulator.worlds.simulation import SimulatedWorld
from memory_folders import files_of
from servers.robots import RobotLink, real_plan, robot_server
from small_episodes import episode_from
from small_worlds import colourless_world, small_config, two_rooms

LIVING_ROOM = Pose2(2.5, 1.0, 1.5)
BEDROOM = Pose2(6.0, 3.0, 0.4)
ODOMETRY = Pose2(210.0, -40.0, 2.0)
"""Where the robot's odometry stands at the start: it has run for a while."""
TURNS = 11


def elsewhere() -> SimulatedWorld:
    """Another building."""
    boxes = [*room_boxes(4.0, 7.0), (None, (1.0, 4.0, 0.0), (4.0, 4.1, 2.5))]
    scene = scene_of(*boxes, ("bed", (0.1, 5.0, 0.0), (1.9, 6.9, 0.5)), name="elsewhere")
    return colourless_world(scene, small_config())


class Lost:
    """A simulated robot whose poses are in a frame of its own."""

    def __init__(self, world: SimulatedWorld, start: Pose2, odometry: Pose2 = ODOMETRY) -> None:
        self._world = world
        self._seen = world.reset(episode_from(start, "bed"))
        self._start_to_odom = odometry.to_transform()
        self._sequence, self._is_blocked = 0, False

    @property
    def base_to_odom(self) -> PlanarPose:
        x, y = self._seen.robot.xy
        here = self._start_to_odom @ Pose2(x, y, self._seen.robot.yaw).to_transform()
        return PlanarPose(x=here.translation[0], y=here.translation[1], yaw=here.yaw)

    def body(self) -> bytes:
        """The next observation."""
        facts = ObservationFacts(
            sequence=self._sequence,
            stamp_s=0.1 * self._sequence,
            base_to_odom=self.base_to_odom,
            blocked=self._is_blocked,
        )
        rgb = self._seen.rgb.copy()
        rgb[0, 0] = self._sequence % 256  # no two images of a camera are the same
        rgb[0, 1] = self._sequence // 256
        return pack_observation(
            facts, rgb, self._seen.depth, self._seen.truth, jpeg_quality=None, raw_depth=True
        )

    def in_scene(self) -> tuple[float, float]:
        """Where it stands, scene frame, metres."""
        return self._world.pose.xy

    def stay(self, link: RobotLink, search: str, turns: int) -> list[dict[str, Any]]:
        """Turn as the server says for some turns, none of which happens; the replies."""
        replies = list[dict[str, Any]]()
        for _ in range(turns):
            replies += self.drive(link, search, most=1)
            self.undo_turn()
        return replies

    def undo_turn(self) -> None:
        """Undo the last turn, as if the wheels had not turned."""
        self._seen, self._is_blocked = self._world.step(Action.TURN_RIGHT), True

    def drive(self, link: RobotLink, search: str, most: int = 200) -> list[dict[str, Any]]:
        """Go on as the server says, to the end or for some steps; the replies."""
        replies = list[dict[str, Any]]()
        for _ in range(most):
            reply = link.observe(search, self.body()).json
            if reply["hold"]:
                reply = link.answer(search, self._sequence)
            replies.append(reply)
            self._sequence, self._is_blocked = self._sequence + 1, False
            if reply["done"]:
                break
            self._seen = self._world.step(Action(reply["action"]))
        return replies


@pytest.fixture(scope="module")
def house() -> SimulatedWorld:
    return two_rooms(coloured=False)


@pytest.fixture
def plan(tmp_path: Path) -> PlanAgent:
    def with_memory(request: OpenSearch) -> AgentPlan:
        return replace(real_plan(request), memory=tmp_path / "home", relocalize=True)

    return with_memory


@pytest.fixture(scope="module")
def lived_in(tmp_path_factory, house) -> dict[str, bytes]:
    """The memory of a search through both rooms, in vain, by a robot that began in the first."""
    folder = tmp_path_factory.mktemp("first")

    def plan(request: OpenSearch) -> AgentPlan:
        return replace(real_plan(request), memory=folder / "home", relocalize=True)

    with robot_server(folder / "state", plan) as link:
        search = opened(link, "piano")
        replies = Lost(house, LIVING_ROOM, Pose2(0.0, 0.0, 0.0)).drive(link, search)
        assert replies[-1]["ending"] == "gave up"
        assert status(link, search)["start"] is None  # a new memory begins where the robot is
    return files_of(folder / "home")


@pytest.fixture
def home(tmp_path, lived_in) -> Path:
    folder = tmp_path / "home"
    for name, content in lived_in.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)
    return folder


def memory_of(folder: Path) -> MemoryFolder:
    config = small_config()
    return MemoryFolder(folder, config.mapping, config.embodiment)


def opened(link: RobotLink, goal: str = "bed", **values: Any) -> str:
    return link.open(goal, embodiment=small_config().embodiment.model_dump(), **values)


def status(link: RobotLink, search: str) -> dict[str, Any]:
    return link.call("GET", search).json


def traces(link: RobotLink, search: str) -> list[dict[str, Any]]:
    lines = link.call("GET", f"{search}/trace").content.decode().splitlines()
    return [json.loads(line) for line in lines]


def history(folder: Path) -> list[dict[str, Any]]:
    return json.loads((folder / "memory.json").read_text())["history"]


def things(folder: Path) -> list[tuple[str, float, float]]:
    """Label and middle of the remembered things, ``map`` frame of the memory, metres."""
    index = read_index(folder)
    assert index is not None
    return sorted(
        (one.label, (one.low[0] + one.high[0]) / 2.0, (one.low[1] + one.high[1]) / 2.0)
        for floor in index.floors
        for one in floor.things
    )


def frame_of(start: dict[str, Any]) -> Transform:
    """What takes the frame of the robot's poses to the ``map`` frame of the search."""
    return Pose2(*start["robot_frame"]).to_transform(start["robot_frame_z"])


def moved(points: list[list[float]], transform: Transform) -> list[list[float]]:
    return [list(transform.apply(np.array([[*point, 0.0]]))[0, :2]) for point in points]


def test_the_memory_is_used_and_extended_in_its_own_frame(tmp_path, plan, home, house):
    before, robot = things(home), Lost(house, BEDROOM)
    with robot_server(tmp_path / "state", plan) as link:
        search = opened(link, "sofa")
        replies = robot.drive(link, search)
        start, decided = status(link, search)["start"], traces(link, search)
    assert (start["sure"], start["doubt"], start["floor"], start["turns"]) == (True, "", 1, TURNS)
    found = frame_of(start) @ ODOMETRY.to_transform()
    true = LIVING_ROOM.to_transform().inverse() @ BEDROOM.to_transform()
    assert math.dist(found.translation, true.translation) < 0.1
    assert abs(found.yaw - true.yaw) < math.radians(2.0)
    assert replies[-1]["ending"] == "found"
    assert robot.in_scene()[0] < 2.5  # at the sofa, in the other room
    assert [label for label, *_ in things(home)] == [label for label, *_ in before]
    for label, *middle in things(home):
        ((x, y),) = moved([middle], LIVING_ROOM.to_transform())
        (low, high) = next(
            (one.box_min, one.box_max) for one in house.instances if label in one.name
        )
        assert low[0] < x < high[0]
        assert low[1] < y < high[1]
    assert [one["goal"] for one in history(home)] == ["piano", "sofa"]
    assert history(home)[-1]["steps"] == len(decided) == len(replies) - TURNS
    assert decided[0]["reason"] == "on the way to a sofa seen before"


def test_the_robot_is_answered_in_its_own_frame_and_people_in_the_memorys(
    tmp_path, plan, home, house
):
    robot = Lost(house, BEDROOM)
    with robot_server(tmp_path / "state", plan) as link:
        search = opened(link, "sofa")
        here = robot.base_to_odom
        reply = robot.drive(link, search, most=TURNS + 1)[-1]
        (trace,) = traces(link, search)
        now = status(link, search)
    back = frame_of(now["start"]).inverse()
    assert trace["step"] == reply["sequence"] == TURNS
    assert math.dist(reply["path"][0], (here.x, here.y)) < 0.3
    assert np.allclose(reply["path"], moved(trace["path"], back))
    assert np.allclose(reply["destination"], moved([trace["destination"]], back)[0])
    assert now["pose"] == trace["pose"]
    assert trace["events"][0] == "found on floor 1 of the memory by one turn"


def test_the_turn_is_ordered_by_the_server_and_has_no_trace(tmp_path, plan, home, house):
    with robot_server(tmp_path / "state", plan) as link:
        search = opened(link)
        replies = Lost(house, BEDROOM).drive(link, search, most=TURNS)
        now = status(link, search)
        assert {one["action"] for one in replies} == {Action.TURN_LEFT}
        assert {one["mode"] for one in replies} == {Mode.LOOK_AROUND}
        assert all(one["velocity"]["angular_rad_s"] > 0.0 for one in replies)
        assert traces(link, search) == []
        assert (now["start"], now["pose"], now["map"]) == (None, None, None)
        assert now["last"]["reason"] == "finding out where it is in the memory"
        assert link.call("GET", f"{search}/map.png").status == 404


def test_turns_that_did_not_happen_are_made_again(tmp_path, plan, home, house):
    robot, stuck = Lost(house, BEDROOM), 3
    with robot_server(tmp_path / "state", plan) as link:
        search = opened(link)
        robot.drive(link, search, most=4)
        for _ in range(stuck):
            robot.undo_turn()
            robot.drive(link, search, most=1)
        robot.drive(link, search, most=TURNS - 3)
        start = status(link, search)["start"]
    assert (start["sure"], start["turns"]) == (True, TURNS + stuck)


def test_in_another_building_the_search_begins_anew_and_the_memory_stays(tmp_path, plan, home):
    before = files_of(home)
    robot = Lost(elsewhere(), Pose2(2.0, 2.0, 0.5))
    with robot_server(tmp_path / "state", plan) as link:
        search = opened(link, "bed")
        robot.drive(link, search, most=TURNS + 1)
        start, (trace,) = status(link, search)["start"], traces(link, search)
        with memory_of(home) as still:  # other programs may use it at once
            assert len(still.history) == 1
        replies = robot.drive(link, search)
    assert start["sure"] is False
    assert start["doubt"]
    words = f"not found in the memory: {start['doubt']}; the search began anew"
    assert trace["events"][0] == words
    x, y = ODOMETRY.xy
    assert moved([[x, y]], frame_of(start))[0] == pytest.approx([0.0, 0.0], abs=1e-6)
    assert replies[-1]["ending"] == "found"
    assert files_of(home) == before


def test_where_the_map_contradicts_a_sure_place_the_search_begins_anew(
    tmp_path, plan, home, house, monkeypatch
):
    monkeypatch.setattr("hypernav.search.memory.start.start_check._SURE_AT_ONCE", -1e6)
    before = files_of(home)
    with robot_server(tmp_path / "state", plan) as link:
        search = opened(link, "bed")
        replies = Lost(house, BEDROOM).drive(link, search)
        assert "contradicts the map" in status(link, search)["start"]["doubt"]
        assert replies[-1]["ending"] == "found"
    assert files_of(home) == before


def test_a_robot_that_goes_away_while_it_turns_leaves_the_memory_as_it_was(
    tmp_path, plan, home, house
):
    before = files_of(home)
    with robot_server(tmp_path / "state", plan) as link:
        search = opened(link)
        Lost(house, BEDROOM).drive(link, search, most=4)
        link.call("POST", f"{search}/close", {"reason": "no battery", "failed": True})
        assert status(link, search)["ending"] == "robot failed"
        opened(link)  # the memory was let go
    assert files_of(home) == before


@pytest.mark.slow
@pytest.mark.parametrize("steps", [3, TURNS + 2])
def test_a_restarted_server_goes_on_with_the_turn_and_the_frame(tmp_path, plan, home, house, steps):
    before, replies, starts = files_of(home), list[list[dict[str, Any]]](), list[Any]()
    for state, cut in (("whole", 1000), ("cut", steps)):
        for name, content in before.items():
            (home / name).write_bytes(content)
        robot = Lost(house, BEDROOM)
        with robot_server(tmp_path / state, plan) as link:
            search = opened(link, "sofa")
            made = robot.drive(link, search, most=cut)
        with robot_server(tmp_path / state, plan) as link:
            made += [] if made[-1]["done"] else robot.drive(link, search)
            starts.append(status(link, search)["start"])
        replies.append(made)
    assert replies[0] == replies[1]
    assert starts[0] == starts[1]
    assert starts[0]["sure"]


def other_memory(folder: Path) -> None:
    """Let another search, which is in vain, change a memory on disk."""
    with memory_of(folder) as memory:
        memory.history.append(memory.history[-1].model_copy(update={"goal": "lamp"}))
        memory.save()


@pytest.mark.slow
def test_a_restart_leaves_the_start_as_it_was_decided(tmp_path, plan, home, house, monkeypatch):
    robot = Lost(house, BEDROOM)
    with robot_server(tmp_path / "state", plan) as link:
        search = opened(link, "sofa")
        made = robot.drive(link, search, most=TURNS + 2)
        start = status(link, search)["start"]

    def undecidable(*_: object) -> None:
        raise AssertionError("what was decided is decided again")

    monkeypatch.setattr("hypernav.robot.server.searches.unknown_start.found_by_turn", undecidable)
    with robot_server(tmp_path / "state", plan) as link:
        made += robot.drive(link, search)
        assert status(link, search)["start"] == start
        assert start["sure"]
    assert made[-1]["ending"] == "found"
    assert robot.in_scene()[0] < 2.5


@pytest.mark.slow
@pytest.mark.parametrize("steps", [3, TURNS + 2])
def test_a_restarted_server_mixes_no_frames_of_two_memories(tmp_path, plan, home, house, steps):
    robot = Lost(house, BEDROOM)
    with robot_server(tmp_path / "state", plan) as link:
        search = opened(link, "sofa")
        robot.drive(link, search, most=steps)
    other_memory(home)
    before = files_of(home)
    with robot_server(tmp_path / "state", plan) as link:
        now = status(link, search)
        assert now["ending"] == "failed"
        assert "no longer the one that the search began with" in now["detail"]
        assert robot.drive(link, search, most=1)[-1]["action"] == Action.STOP
        opened(link)  # the memory is free
    assert files_of(home) == before


def test_a_first_search_gets_no_turn_by_a_restart(tmp_path, plan, home, house):
    shutil.move(home, tmp_path / "later")
    robot = Lost(house, BEDROOM, Pose2(0.0, 0.0, 0.0))
    with robot_server(tmp_path / "state", plan) as link:
        search = opened(link, "sofa")
        robot.drive(link, search, most=3)
    shutil.rmtree(home)
    shutil.copytree(tmp_path / "later", home)
    with robot_server(tmp_path / "state", plan) as link:
        assert status(link, search)["ending"] == "failed"
    assert files_of(home) == files_of(tmp_path / "later")


@pytest.mark.slow
def test_a_search_that_began_anew_goes_on_after_a_restart_without_the_memory(tmp_path, plan, home):
    robot = Lost(elsewhere(), Pose2(2.0, 2.0, 0.5))
    with robot_server(tmp_path / "state", plan) as link:
        search = opened(link, "bed")
        made = robot.drive(link, search, most=TURNS + 1)
        start = status(link, search)["start"]
    other_memory(home)
    before = files_of(home)
    with memory_of(home), robot_server(tmp_path / "state", plan) as link:  # another program has it
        made += robot.drive(link, search)
        assert status(link, search)["start"] == start
    assert not start["sure"]
    assert made[-1]["ending"] == "found"
    assert files_of(home) == before


@pytest.mark.slow
def test_others_search_with_a_memory_that_a_search_has_left(tmp_path, plan, home, house):
    with robot_server(tmp_path / "state", plan) as link:
        anew = opened(link, "bed")
        Lost(elsewhere(), Pose2(2.0, 2.0, 0.5)).drive(link, anew, most=TURNS + 1)
        search = opened(link, "sofa")
        Lost(house, BEDROOM).drive(link, search, most=TURNS + 1)
        assert status(link, search)["start"]["sure"]
        robot = small_config().embodiment.model_dump()
        request = {"goal": "bed", "labels": True, "embodiment": robot}
        refused = link.call("POST", "/v1/searches", request)
        assert refused.status == 409
        assert search.rpartition("/")[2] in refused.json["message"]


def test_a_robot_that_does_not_turn_around_begins_anew(tmp_path, plan, home, house):
    before, most = files_of(home), 3 * (TURNS + 1)
    robot = Lost(house, BEDROOM)
    with robot_server(tmp_path / "state", plan) as link:
        search = opened(link, "bed")
        robot.stay(link, search, most)
        assert status(link, search)["start"] is None
        robot.drive(link, search, most=1)
        start, (trace,) = status(link, search)["start"], traces(link, search)
    assert (start["sure"], start["turns"]) == (False, most)
    assert start["doubt"] == "the robot did not turn around"
    assert trace["step"] == most
    assert files_of(home) == before


@pytest.mark.slow
def test_only_frames_of_new_headings_are_kept(tmp_path, plan, home, house, monkeypatch):
    def counting(memory: Memory, frames: Sequence[Observation]) -> FoundStart:
        counts.append(len(frames))
        return found_by_turn(memory, frames)

    counts, stuck = list[int](), 10
    monkeypatch.setattr("hypernav.robot.server.searches.unknown_start.found_by_turn", counting)
    robot = Lost(house, BEDROOM)
    with robot_server(tmp_path / "state", plan) as link:
        search = opened(link, "bed")
        robot.stay(link, search, stuck)
        robot.drive(link, search, most=TURNS + 1)
        start = status(link, search)["start"]
    assert counts == [TURNS + 1]
    assert (start["sure"], start["turns"]) == (True, TURNS + stuck)


def test_the_turn_takes_no_steps_of_the_search(tmp_path, plan, home, house):
    with robot_server(tmp_path / "state", plan) as link:
        search = opened(link, "piano", max_steps=2)
        replies = Lost(house, BEDROOM).drive(link, search)
        now = status(link, search)
    assert len(replies) == TURNS + 2 + 1
    assert (replies[-1]["ending"], replies[-1]["reason"]) == (
        "gave up",
        "the limit of 2 steps is reached",
    )
    assert now["start"]["sure"]


def test_a_robot_that_is_sent_to_a_thing_goes_there_from_wherever_it_is(
    tmp_path, plan, home, house
):
    index = read_index(home)
    assert index is not None
    (sofa,) = [one.number for one in index.floors[0].things if one.label == "sofa"]
    robot = Lost(house, BEDROOM)
    with robot_server(tmp_path / "state", plan) as link:
        search = opened(link, "sofa", thing={"floor": 1, "number": sofa})
        assert robot.drive(link, search)[-1]["ending"] == "found"
    assert robot.in_scene()[0] < 2.5
