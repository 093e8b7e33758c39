"""What a robot knows, kept as one value."""

import pickle

import numpy as np
import pytest

from box_views import FLOOR, view_of
from hypernav.app.build.agents import build_search
from hypernav.core.embodiment import Embodiment
from hypernav.core.exploring.floors import SeenThing
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.memory.memory import Memory
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from small_episodes import episode_from
from small_worlds import small_config, two_rooms
from stair_views import CAMERA as STAIR_CAMERA
from stair_views import CLIMBER, memory_after


def searched(goal: str = "bed", most: int = 12):
    """An agent that has looked for something for a few steps."""
    agent = build_search(small_config(), GroundTruthDetector(), ExchangeLog())
    for _ in EpisodeRun(
        agent, two_rooms(), episode_from(Pose2(2.5, 1.0, 1.5), goal, max_steps=most)
    ):
        pass
    return agent


def test_a_copy_shares_nothing_that_changes():
    memory = searched().memory
    copy = memory.copy()
    before = copy.floor.map.grid.cells.copy()
    memory.floor.map.mark_occupied(np.array([[0.0, 0.0]]))
    memory.search.visits.append((1.0, 2.0))
    memory.search.notes["mine"] = [1]
    memory.floor.trajectory.clear()
    assert np.array_equal(copy.floor.map.grid.cells, before)
    assert (1.0, 2.0) not in copy.search.visits
    assert "mine" not in copy.search.notes
    assert copy.floor.trajectory


def test_a_memory_can_be_written_down():
    memory = searched().memory
    again: Memory = pickle.loads(pickle.dumps(memory))
    assert np.array_equal(again.floor.map.grid.cells, memory.floor.map.grid.cells)
    assert again.floor.trajectory == memory.floor.trajectory


def test_another_goal_keeps_map_and_things_and_forgets_the_search():
    memory = searched().memory
    memory.search.visits.append((1.0, 2.0))
    memory.floor.sightings = memory.floor.sightings.with_named({7: SeenThing("sofa", (1.0, 2.0))})
    explored = memory.floor.map.grid.explored.sum()
    memory.begin_search()
    assert memory.search.visits == []
    assert memory.search.evidence.target is None
    assert memory.floor.map.grid.explored.sum() == explored
    assert [one.label for one in memory.floor.sightings.things] == ["sofa"]


def test_a_search_with_a_memory_goes_on_with_its_map():
    first = searched("piano", 30)
    known = first.grid.explored.sum()
    agent = build_search(small_config(), GroundTruthDetector(), ExchangeLog())
    agent.reset(Goal("bed"), first.memory)
    assert agent.memory is first.memory
    assert agent.grid.explored.sum() == known


def test_a_new_search_knows_nothing():
    agent = searched()
    agent.reset(Goal("bed"))
    assert not agent.grid.explored.any()
    assert agent.memory.floor.trajectory == []


def test_exploring_anew_forgets_visits_and_notes_and_keeps_what_may_be_the_goal():
    memory = Memory(MappingConfig(), Embodiment())
    search = memory.search
    search.visits.append((0.0, 1.0))
    search.notes["mine"] = 1
    evidence = search.evidence
    search.forget_exploration()
    assert (search.visits, search.notes) == ([], {})
    assert search.evidence is evidence


@pytest.mark.parametrize(("hole_m", "number"), [(0.0, 1), (0.6, 0)])
def test_ground_beyond_a_hole_makes_no_floor_of_a_landing(hole_m: float, number: int):
    """Over presumed steps down, which count on the way over stairs, it would be in reach."""
    z, end_x = 2.0, 2.0
    boxes = [
        ((-30.0, -30.0, -3.1), (30.0, 30.0, 0.0)),
        ((-0.5, -0.6, -3.0), (end_x, 0.6, z)),
        ((end_x + hole_m, -6.0, -3.0), (12.0, 6.0, z)),
    ]
    memory = memory_after([FLOOR], Pose2(-1.0, 0.0, 0.0))
    for x in np.arange(-0.2, 1.6, 0.25):
        height_m = CLIMBER.camera.height_m + z
        pose = Pose2(float(x), 0.0, 0.0)
        memory.follow(view_of(boxes, pose, camera=STAIR_CAMERA, height_m=height_m))
    assert memory.number == number


def test_what_was_walked_is_the_length_of_the_track():
    memory = Memory(MappingConfig(), CLIMBER)
    poses = [Pose2(0.5, 0.5, 0.0), Pose2(0.9, 0.8, 0.0), Pose2(0.9, 0.8, 1.0), Pose2(1.2, 1.2, 1.0)]
    for pose, walked_m in zip(poses, (0.0, 0.5, 0.5, 1.0), strict=True):
        memory.follow(view_of([FLOOR], pose, camera=STAIR_CAMERA))
        assert memory.footing.walked_m == pytest.approx(walked_m)
