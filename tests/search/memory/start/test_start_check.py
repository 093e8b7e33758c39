"""Whether what a robot sees at its start is what its memory shows there."""

import copy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from box_views import CAMERA, room, view_of
from hypernav.core.embodiment import Embodiment
from hypernav.core.errors import MemoryStartError
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.observation import Observation
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.top_down_map import TopDownMap
from hypernav.search.memory.floor import counted_from
from hypernav.search.memory.memory import Memory
from hypernav.search.memory.start.start_check import KnownFloor, StartCheck

HALL = [
    *room(8.0, 6.0),
    ((4.0, 0.0, 0.0), (4.2, 4.0, 2.5)),
    ((6.0, 4.5, 0.0), (7.5, 5.8, 0.9)),
    ((1.0, 0.3, 0.0), (2.0, 1.0, 0.8)),
]


@pytest.fixture(scope="module")
def remembered() -> TopDownMap:
    return map_of(HALL)


def map_of(boxes) -> TopDownMap:
    """The map after the robot has looked around in four places."""
    camera = Embodiment().camera.model_copy(update={"width": CAMERA.width, "height": CAMERA.height})
    map_ = TopDownMap(MappingConfig(), Embodiment().model_copy(update={"camera": camera}))
    for x, y in ((1.0, 2.0), (2.5, 4.5), (5.0, 5.0), (6.0, 2.0)):
        for k in range(12):
            map_.integrate(view_of(boxes, Pose2(x, y, k * np.pi / 6.0)))
    return map_


def standing(x: float, y: float, yaw: float, *, really: Pose2 | None = None, boxes=HALL):
    """An image from one pose, as if the robot stood at another."""
    view = view_of(boxes, really or Pose2(x, y, yaw))
    said = view_of([], Pose2(x, y, yaw))
    return type(view)(view.rgb, view.depth, view.camera, said.camera_to_map, said.robot)


def raised(observation: Observation, z: float) -> Observation:
    """The same image from a pose that is said to be higher."""
    return counted_from(-z, observation)


def fit_of(map_: TopDownMap, observation: Observation) -> float | None:
    """Share of the patches in sight that fit; None where there are none."""
    patches, contradict = KnownFloor(map_).fit_of(observation).counts
    return 1.0 - contradict / patches if patches else None


def check(map_: TopDownMap, observation: Observation, *, trusts_height: bool = False) -> None:
    """Check the start in a memory of one floor, which stays as it is."""
    memory = Memory(map_.config, map_.embodiment)
    memory.floor.map = map_
    try:
        StartCheck(memory, observation, Path("home"), trusts_height=trusts_height)
    finally:
        assert len(memory.floors) == 1


@pytest.mark.parametrize("yaw", np.arange(8) * np.pi / 4.0)
def test_a_robot_that_stands_where_it_says_fits(remembered, yaw):
    fit = fit_of(remembered, standing(2.0, 3.0, yaw))
    assert fit is not None
    assert fit > 0.8


def test_four_times_as_many_pixels_are_not_as_much_evidence(remembered):
    known, there = KnownFloor(remembered), Pose2(6.5, 2.0, 1.0)
    doubts = []
    for width in (640, 1280):
        camera = PinholeCamera.from_hfov(width, width * 3 // 4, 79.0)
        view = view_of(HALL, there, camera=camera)
        said = view_of([], Pose2(2.0, 3.0, 0.0), camera=camera)
        doubts.append(known.fit_of(replace(view, camera_to_map=said.camera_to_map)).doubt)
    assert doubts[0] > 5.0
    assert doubts[1] < 2.0 * doubts[0]  # though it has four times as many pixels


def test_few_patches_that_contradict_refuse_nothing(remembered):
    """A coarse camera that looks at a chair which was moved sees little else."""
    seen = standing(2.0, 3.0, 0.0)
    chair = ((3.0, 2.8, 0.0), (3.5, 3.3, 0.9))
    depth = np.zeros_like(seen.depth)
    shows_chair = standing(2.0, 3.0, 0.0, boxes=[chair]).depth
    depth[shows_chair > 0.0] = shows_chair[shows_chair > 0.0]
    only_chair = replace(seen, depth=depth)
    patches, contradict = KnownFloor(remembered).fit_of(only_chair).counts
    assert 0 < contradict <= patches <= 5
    check(remembered, only_chair)


def test_a_chair_that_came_since_changes_little(remembered):
    chair = ((3.0, 2.8, 0.0), (3.5, 3.3, 0.9))
    fit = fit_of(remembered, standing(1.5, 3.0, 0.0, boxes=[*HALL, chair]))
    assert fit is not None
    assert fit > 0.5


@pytest.mark.parametrize(
    "really", [Pose2(6.5, 2.0, 0.0), Pose2(2.0, 3.0, 1.2), Pose2(2.0, 3.0, -1.5)]
)
def test_a_robot_that_stands_elsewhere_is_refused(remembered, really):
    with pytest.raises(MemoryStartError, match=r"at \(2\.0, 3\.0\) is not what home remembers"):
        check(remembered, standing(2.0, 3.0, 0.0, really=really))


def turn(x: float, y: float, *, really: Pose2 | None = None, boxes=HALL) -> list[Observation]:
    """The frames of a turn around, as if the robot stood at another pose."""
    at = really or Pose2(x, y, 0.0)
    yaws = np.arange(12) * np.pi / 6.0
    return [
        standing(x, y, yaw, really=Pose2(at.x, at.y, at.yaw + yaw), boxes=boxes) for yaw in yaws
    ]


def follow(map_: TopDownMap, frames: list[Observation]) -> None:
    """Check a start by its frames, which are drawn on the map meanwhile."""
    memory = Memory(map_.config, map_.embodiment)
    memory.floor.map = copy.deepcopy(map_)
    first, *others = frames
    start = StartCheck(memory, first, Path("home"), trusts_height=True)
    memory.floor.map.integrate(first)
    for frame in others:
        assert not start.is_over
        start.look(frame)
        memory.floor.map.integrate(frame)
    assert start.is_over


def test_a_robot_whose_first_image_fits_by_chance_is_refused_as_it_looks_around(remembered):
    frames = [standing(2.0, 3.0, 0.0), *turn(2.0, 3.0, really=Pose2(6.5, 2.0, 1.0))[1:]]
    check(remembered, frames[0])
    with pytest.raises(MemoryStartError, match="is not what home remembers there"):
        follow(remembered, frames)


def test_a_robot_whose_first_image_tells_nothing_is_refused_as_it_looks_around(remembered):
    frames = turn(9.5, 3.0, really=Pose2(6.5, 2.0, 0.5))
    assert fit_of(remembered, frames[0]) is None
    with pytest.raises(MemoryStartError, match="is not what home remembers there"):
        follow(remembered, frames)


def test_a_robot_that_looks_around_where_it_says_is_never_refused(remembered):
    for x, y in ((2.0, 3.0), (5.0, 5.0), (6.5, 2.0), (3.0, 5.0)):
        follow(remembered, turn(x, y))


def test_things_that_were_moved_refuse_no_robot_that_looks_around(remembered):
    moved = [one for one in HALL if one not in HALL[-2:]]
    moved += [((4.6, 1.0, 0.0), (6.1, 2.0, 0.9)), ((2.6, 4.6, 0.0), (3.6, 5.3, 0.8))]
    follow(remembered, turn(2.0, 3.0, boxes=moved))
    follow(remembered, turn(6.5, 2.0, boxes=moved))


def test_one_cupboard_that_is_gone_refuses_no_robot_however_much_it_hid():
    cupboard = ((2.4, 2.4, 0.0), (2.7, 3.6, 2.0))
    around = turn(2.0, 3.0)
    follow(map_of([*HALL, cupboard]), around)
    gone = KnownFloor(map_of([*HALL, cupboard])).fit_of(around[0])
    assert 0.0 < gone.counts[1] < 10.0


def test_what_is_seen_over_low_things_counts_and_not_they(remembered):
    chairs = [((x, y, 0.0), (x + 0.5, y + 0.5, 0.5)) for x in (2.0, 3.2) for y in (1.5, 2.6)]
    known = KnownFloor(remembered)
    without = known.fit_of(standing(0.6, 3.0, 0.0)).counts
    assert known.fit_of(standing(0.6, 3.0, 0.0, boxes=[*HALL, *chairs])).counts == without


def test_frames_of_another_floor_count_for_nothing(remembered):
    elsewhere = turn(2.0, 3.0, really=Pose2(6.5, 2.0, 1.0))[1:]
    follow(remembered, [standing(2.0, 3.0, 0.0), *(raised(one, 3.0) for one in elsewhere)])


def test_where_nothing_is_known_nothing_is_refused(remembered):
    far = standing(50.0, 50.0, 0.0, really=Pose2(2.0, 3.0, 0.0))
    assert fit_of(remembered, far) is None
    check(remembered, far)


@pytest.mark.parametrize("z", [3.0, -3.0, 40.0])
def test_a_robot_on_a_known_floor_whose_heights_are_wrong_is_refused(remembered, z):
    seen = raised(standing(2.0, 3.0, 0.0), z)
    with pytest.raises(MemoryStartError, match=rf"pose is {z} m high.*fit the floor at 0\.0 m"):
        check(remembered, seen)
    check(remembered, seen, trusts_height=True)


def test_a_robot_may_begin_on_a_new_floor_that_looks_different(remembered):
    other = [*room(8.0, 6.0), ((2.8, 0.0, 0.0), (3.0, 6.0, 2.5))]
    check(remembered, raised(standing(2.0, 3.0, 0.0, boxes=other), 3.0))


@pytest.mark.parametrize("z", [0.4, 0.9, -0.6])
def test_a_robot_on_a_split_level_is_compared_with_its_floor(remembered, z):
    check(remembered, raised(standing(2.0, 3.0, 0.0), z))
    elsewhere = standing(2.0, 3.0, 0.0, really=Pose2(6.5, 2.0, 0.0))
    with pytest.raises(MemoryStartError, match="is not what home remembers"):
        check(remembered, raised(elsewhere, z))
