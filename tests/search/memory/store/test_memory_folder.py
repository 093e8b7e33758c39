"""A memory on disk: the same after loading, whole after a kill, bounded, and for one process."""

import itertools
import json
import os
import shutil
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hypernav.app.build.agents import build_search
from hypernav.app.build.memories.building_memory import open_memory
from hypernav.core.embodiment import Action
from hypernav.core.errors import MemoryFolderError, MemoryStartError, RunFolderError
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog
from hypernav.io.foreign_folder import ForeignFolder
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.search.mapping.ros_map import load_ros_map
from hypernav.search.memory.key_images import KeyImages
from hypernav.search.memory.memory import Memory
from hypernav.search.memory.store.memory_folder import MemoryFolder
from hypernav.search.memory.store.memory_reader import read_index
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from memory_folders import files_of
from small_episodes import episode_from
from small_worlds import small_config, two_rooms

CONFIG = small_config()
LIVING_ROOM, DOOR = Pose2(2.5, 1.0, 1.5), Pose2(4.0, 3.1, 0.0)


def run(memory, start: Pose2 = LIVING_ROOM, goal: str = "bed", most: int = 60, world=None):
    """A search; returns its actions and poses."""
    agent = build_search(CONFIG, GroundTruthDetector(), ExchangeLog())
    search = EpisodeRun(
        agent, world or two_rooms(), episode_from(start, goal, max_steps=most), memory=memory
    )
    return [(step.trace.action, step.trace.pose, step.trace.reason) for step in search]


@pytest.fixture(scope="module")
def saved(tmp_path_factory) -> Path:
    """A folder with the memory of a search for the bed."""
    folder = tmp_path_factory.mktemp("memory") / "home"
    with open_memory(folder, CONFIG) as memory:
        memory.memory.floor.was_explored = True
        run(memory)
    return folder


@pytest.fixture
def home(saved, tmp_path) -> Path:
    """A copy of it."""
    return shutil.copytree(saved, tmp_path / "home")


def test_every_save_has_a_name_of_its_own(home, tmp_path):
    with open_memory(home, CONFIG) as memory:
        first = memory.save_name
    with open_memory(home, CONFIG) as memory:
        assert memory.save_name == first  # the same, whenever it is read
        memory.save()
        assert memory.save_name != first
    with open_memory(tmp_path / "empty", CONFIG) as memory:
        assert memory.save_name == ""


def images_of(folder: MemoryFolder) -> KeyImages:
    assert folder.memory.images is not None
    return folder.memory.images


def is_same(a: Memory, b: Memory) -> None:
    assert len(a.floors) == len(b.floors)
    assert (a.number, a.searches) == (b.number, b.searches)
    for one, other in zip(a.floors, b.floors, strict=True):
        for name, array in one.map.state.items():
            assert np.array_equal(array, other.map.state[name]), name
        assert one.trajectory == other.trajectory
        assert one.things.known == other.things.known
        assert one.things.count == other.things.count
        assert one.sightings == other.sightings
        assert one.was_explored == other.was_explored
        assert one.z == other.z
    assert a.images is not None
    assert b.images is not None
    assert a.images.showing == b.images.showing
    for one, other in zip(a.images.kept, b.images.kept, strict=True):
        assert (one.jpeg, one.png, one.number, one.robot) == (
            other.jpeg,
            other.png,
            other.number,
            other.robot,
        )
        assert np.array_equal(one.camera_to_map.matrix, other.camera_to_map.matrix)
        assert np.array_equal(one.patches, other.patches)


def test_loading_gives_what_was_saved(tmp_path):
    with open_memory(tmp_path, CONFIG) as first:
        first.memory.floor.was_explored = True
        run(first)
    with open_memory(tmp_path, CONFIG) as second:
        is_same(first.memory, second.memory)
        assert [one.goal for one in second.history] == ["bed"]
        assert second.history[0].outcome == "found"
        assert second.left_out == ()


def test_a_search_goes_on_from_disk_as_it_does_from_the_memory_in_the_process(tmp_path):
    with open_memory(tmp_path / "a", CONFIG) as memory:
        run(memory, most=15)
        within = run(memory, DOOR, "sofa")
    with open_memory(tmp_path / "b", CONFIG) as memory:
        run(memory, most=15)
    with open_memory(tmp_path / "b", CONFIG) as memory:
        assert run(memory, DOOR, "sofa") == within


def test_a_first_search_takes_the_steps_of_one_without_memory(tmp_path):
    with open_memory(tmp_path, CONFIG) as memory:
        steps = run(memory)
    assert steps[-1][0] is Action.STOP
    assert steps == run(None)


def test_a_search_is_saved_on_its_way(tmp_path):
    now = iter(range(0, 10_000, 4))
    with MemoryFolder(
        tmp_path, CONFIG.mapping, CONFIG.embodiment, clock=lambda: float(next(now))
    ) as home:
        saves = []
        agent = build_search(CONFIG, GroundTruthDetector(), ExchangeLog())
        episode = episode_from(LIVING_ROOM, max_steps=9)
        for _ in EpisodeRun(agent, two_rooms(), episode, memory=home):
            saves.append(home.index.saves if home.index else 0)
    assert saves == sorted(saves)
    assert 2 <= saves[-1] < len(saves)
    history = json.loads((tmp_path / "memory.json").read_text())["history"]
    assert history[0]["outcome"] == "not_found"


@pytest.mark.parametrize("has_seen", [False, True])
def test_a_search_that_ends_within_its_first_step_leaves_nothing(
    home, tmp_path, monkeypatch, has_seen
):
    agent = build_search(CONFIG, GroundTruthDetector(), ExchangeLog())
    act = agent.act

    def interrupted(observation):
        if has_seen:
            act(observation)
        raise KeyboardInterrupt

    monkeypatch.setattr(agent, "act", interrupted)
    before, episode = files_of(home), episode_from(DOOR, "sofa")
    for folder in (home, tmp_path / "new"):
        with open_memory(folder, CONFIG) as memory:
            earlier = list(memory.history)
            with pytest.raises(KeyboardInterrupt):
                list(EpisodeRun(agent, two_rooms(), episode, memory=memory))
            assert memory.history == earlier
    assert files_of(home) == before
    assert files_of(tmp_path / "new") == {}


def test_one_process_at_a_time(home):
    with (
        open_memory(home, CONFIG),
        pytest.raises(RunFolderError, match=r"in use.*another --memory"),
        open_memory(home, CONFIG),
    ):
        pass
    with open_memory(home, CONFIG):
        pass


def test_the_ros_map_is_the_map(home):
    grid = load_ros_map(home / "floor-1" / "map.yaml")
    with open_memory(home, CONFIG) as memory:
        own = memory.memory.floor.map.grid.cropped()
    assert np.array_equal(grid.cells, own.cells)
    assert grid.origin == pytest.approx(own.origin)


@pytest.mark.parametrize("size", [0, 1, 0.5])
def test_an_index_that_is_cut_off_is_refused_in_words(home, size):
    path = home / "memory.json"
    content = path.read_bytes()
    path.write_bytes(content[: int(size * len(content)) if size < 1 else size])
    with pytest.raises(MemoryFolderError, match=r"memory\.json is broken .*move .* away"):
        open_memory(home, CONFIG)


@pytest.mark.parametrize("saves", [1, 2])
def test_a_first_save_that_ends_while_one_reads_is_no_foreign_file(home, monkeypatch, saves):
    def not_there_yet(folder, path, **options):
        raise FileNotFoundError(path)

    for _ in range(saves - 1):  # removes the first map
        with open_memory(home, CONFIG) as memory:
            memory.save()
    monkeypatch.setattr(ForeignFolder, "read", not_there_yet)
    assert (home / "memory.json").exists()
    assert read_index(home) is None


@pytest.mark.parametrize(
    ("key", "value", "told"),
    [
        ("format", "pixels", "is broken"),
        ("version", 99, "has version 99 .* reads version 1"),
        ("searches", -1, "is broken .searches"),
        ("floors", [], "is broken .floors"),
    ],
)
def test_an_index_of_another_kind_is_refused(home, key, value, told):
    path = home / "memory.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {key: value}))
    with pytest.raises(MemoryFolderError, match=told):
        open_memory(home, CONFIG)


@pytest.mark.parametrize("name", ["images/000000.jpg", "images/000000.png"])
def test_a_damaged_image_is_left_out_by_name_and_the_rest_is_kept(home, name):
    path = home / name
    path.write_bytes(path.read_bytes()[:-7])
    with open_memory(home, CONFIG) as memory:
        count = len(images_of(memory).kept) + 1
        told = f"1 of {count} key images are missing or damaged, and left out: 0"
        assert memory.left_out == (told,)
        assert memory.memory.floor.map.grid.explored.any()
        assert all(one.image != 0 for one in memory.memory.floor.things.known)
        run(memory, DOOR, "sofa")
    with open_memory(home, CONFIG) as memory:
        assert memory.left_out == ()


@pytest.mark.parametrize("damage", ["cut", "other bytes", "gone"])
def test_a_damaged_map_is_drawn_anew_and_things_and_images_are_kept(home, damage):
    (path,) = home.glob("floor-1/state-*.npz")
    content = path.read_bytes()
    if damage == "gone":
        path.unlink()
    else:
        path.write_bytes(content[: len(content) // 2] if damage == "cut" else b"x" * len(content))
    with open_memory(home, CONFIG) as memory:
        (line,) = memory.left_out
        assert line.startswith("the map of floor 1 is damaged (")
        assert not memory.memory.floor.map.grid.explored.any()
        assert not memory.memory.floor.was_explored
        assert memory.memory.floor.things.known
        assert all(len(one.patches) for one in images_of(memory).kept)
        actions = run(memory, DOOR, "bed")
    assert actions[-1][2] == "here is the bed"


def test_another_robot_building_or_folder_is_refused(home, tmp_path):
    other = small_config(mapping={"cell_size_m": 0.1})
    with pytest.raises(MemoryFolderError, match=r"made with mapping\.cell_size_m 0\.05 \(now 0\.1"):
        open_memory(home, other)
    agent = build_search(CONFIG, GroundTruthDetector(), ExchangeLog())
    elsewhere = replace(episode_from(DOOR), scene_id="elsewhere")
    with (
        open_memory(home, CONFIG) as memory,
        pytest.raises(MemoryFolderError, match="memory of tests, and this is elsewhere"),
    ):
        EpisodeRun(agent, two_rooms(), elsewhere, memory=memory)
    (tmp_path / "thesis").mkdir()
    (tmp_path / "thesis" / "chapter.tex").touch()
    with pytest.raises(MemoryFolderError, match=r"holds other files .chapter\.tex"):
        open_memory(tmp_path / "thesis", CONFIG)


def test_no_memory_begins_inside_another(home, tmp_path):
    before = sorted(home.rglob("*"))
    for inside in (home / "kitchen", home / "images" / "of" / "mine"):
        with pytest.raises(MemoryFolderError, match=r"lies in .*home, which is a memory itself"):
            open_memory(inside, CONFIG)
    assert sorted(home.rglob("*")) == before
    (tmp_path / "memory.json").write_text("{}")  # of another program
    with open_memory(tmp_path / "beside", CONFIG) as memory:
        assert memory.index is None


def test_a_robot_that_was_moved_unnoticed_is_refused(home):
    with open_memory(home, CONFIG) as memory:
        assert memory.place is not None
        memory.place = memory.place.model_copy(update={"start": (2.5, 1.0, -1.6)})
        with pytest.raises(MemoryStartError, match="is not what"):
            run(memory, LIVING_ROOM)


def test_a_start_that_is_contradicted_later_leaves_the_memory_as_it_was(home):
    before, world = files_of(home), two_rooms()
    first = world.reset(episode_from(LIVING_ROOM, "bed"))
    world.reset(episode_from(DOOR, "bed"))
    with MemoryFolder(
        home, CONFIG.mapping, CONFIG.embodiment, clock=itertools.count(0.0, 100.0).__next__
    ) as memory:
        known, place = len(memory.history), memory.place
        assert place is not None
        begun = memory.begin(
            Goal("bed"), first, building=place.building, map_to_scene=place.map_to_scene
        )
        begun.begin_search(lasts=True)

        def step() -> None:
            seen = world.step(Action.TURN_LEFT)
            memory.check(seen)
            begun.follow(seen).integrate(seen)
            memory.keep()

        with pytest.raises(MemoryStartError, match="is not what"):
            [step() for _ in range(11)]
        memory.end("found", steps=5)
        assert len(memory.history) == known
        assert files_of(home) == before
        assert run(memory)[-1][0] is Action.STOP
    assert [one.outcome for one in memory.history] == ["found", "found"]


def test_the_size_is_bounded_whatever_is_seen(tmp_path):
    with open_memory(tmp_path, CONFIG) as memory:
        run(memory, goal="piano", most=60)
        kept = list(images_of(memory).kept)
    least = sum(one.size for one in kept) // 2
    size = size_of(tmp_path)
    with MemoryFolder(
        tmp_path, CONFIG.mapping, CONFIG.embodiment, most_megabytes=(size - least) / 1e6
    ) as memory:
        memory.save()
        assert 0 < len(images_of(memory).kept) < len(kept)
    assert size_of(tmp_path) <= size - least


def test_the_size_that_was_chosen_holds_for_later_searches(tmp_path):
    for chosen, holds in [(None, 50), (7, 7), (None, 7), (60, 60), (None, 60)]:
        with open_memory(tmp_path, CONFIG, most_megabytes=chosen) as memory:
            assert memory.most_bytes == images_of(memory).most_bytes == holds * 1_000_000
            run(memory, most=1)


def test_a_memory_from_before_sizes_were_noted_opens_and_notes_one(home):
    index = json.loads((home / "memory.json").read_text())
    del index["most_bytes"]
    (home / "memory.json").write_text(json.dumps(index))
    with open_memory(home, CONFIG) as memory:
        memory.save(makes_room=False)
        assert json.loads((home / "memory.json").read_text())["most_bytes"] is None
        memory.save()
    assert json.loads((home / "memory.json").read_text())["most_bytes"] == 50_000_000


def test_images_that_are_forgotten_for_want_of_room_are_told(home):
    with open_memory(home, CONFIG) as memory:
        before = len(images_of(memory).kept)
        memory.most_bytes = size_of(home) - sum(one.size for one in images_of(memory).kept) // 2
        memory.save(makes_room=False)
        assert (len(images_of(memory).kept), memory.forgotten_words) == (before, "")
        memory.save()
        gone = before - len(images_of(memory).kept)
        assert 1 < gone < before
        assert memory.forgotten_words.startswith(f"{gone} key images forgotten: the limit is 0.")
        memory.forget_images()
        assert memory.forgotten_words.startswith(f"{gone} key images")


def size_of(folder: Path) -> int:
    return sum(one.stat().st_size for one in folder.rglob("*") if one.is_file())


def test_two_floors_are_kept_apart(tmp_path):
    agent = build_search(CONFIG, GroundTruthDetector(), ExchangeLog())
    with open_memory(tmp_path, CONFIG) as home:
        episode = episode_from(LIVING_ROOM, "piano", max_steps=12)
        *_, last = EpisodeRun(agent, two_rooms(), episode, memory=home)
        observation = last.observation
        memory = home.memory
        up = Transform(np.eye(3), np.array([0.0, 0.0, 3.0]))
        upstairs = replace(observation, camera_to_map=up @ observation.camera_to_map)
        floor = memory.begin_at(upstairs)
        floor.integrate(memory.seen_from_ground(upstairs))
        memory.keep_image(memory.seen_from_ground(upstairs))
        home.save()
    with open_memory(tmp_path, CONFIG) as again:
        is_same(memory, again.memory)
        assert [one.z for one in again.memory.floors] == [0.0, pytest.approx(3.0)]
        assert {one.floor for one in images_of(again).kept} == {0, 1}
        assert again.memory.begin_at(observation) is again.memory.floors[0]


KILLED = """
import sys
sys.path.insert(0, {tests!r})
from test_memory_folder import CONFIG, run
from hypernav.app.build.memories.building_memory import open_memory
with open_memory({folder!r}, CONFIG) as memory:
    run(memory, goal="piano", most=14)
    print("searched", flush=True)
    while True:
        memory.memory.floor.trajectory.append((0.0, 0.0))
        memory.save()
        print("saved", flush=True)
"""


@pytest.mark.slow
def test_a_memory_opens_after_any_kill(tmp_path):
    here = Path(__file__).parent
    code = KILLED.format(tests=str(here), folder=str(tmp_path / "home"))
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([*sys.path, str(here)])}
    rng = np.random.default_rng(0)
    for _ in range(8):
        with subprocess.Popen(
            [sys.executable, "-c", code], stdout=subprocess.PIPE, env=environment
        ) as process:
            assert process.stdout is not None
            assert process.stdout.readline() == b"searched\n"
            for _ in range(int(rng.integers(1, 5))):
                assert process.stdout.readline() == b"saved\n"
            try:
                process.wait(float(rng.uniform(0.0, 0.05)))
            except subprocess.TimeoutExpired:
                process.send_signal(signal.SIGKILL)
            process.stdout.read()
        with open_memory(tmp_path / "home", CONFIG) as memory:
            assert memory.left_out == ()
            assert memory.memory.floor.map.grid.explored.any()
            assert memory.history[-1].goal == "piano"


def test_a_first_search_that_begins_high_in_its_frame_begins_on_its_floor(tmp_path):
    world = two_rooms()  # other tests use it, too
    world.keep_map_frame(Transform(np.eye(3), np.array([0.0, 0.0, -6.0])))
    with open_memory(tmp_path / "high", CONFIG) as home:
        run(home, world=world)
        world.keep_map_frame(None)
        assert [one.z for one in home.memory.floors] == [pytest.approx(6.0)]
        (bed,) = [one for one in home.memory.floor.things.known if one.label == "bed"]
    assert home.history[-1].outcome == "found"
    assert 0.0 < bed.position[2] < 1.0
