"""Where a robot stands in its memory, by one turn's images in a frame of its own."""

import math

import numpy as np
import pytest

from box_views import CAMERA, room, view_of
from hypernav.core.embodiment import Embodiment
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2, wrap_angle
from hypernav.core.observation import Observation
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.memory.floor import counted_from
from hypernav.search.memory.memory import Memory
from hypernav.search.memory.start.relocalization import (
    Relocalization,
    _candidates,
    _coarse,
    _counts,
    _Fields,
    _Kinds,
    _Seen,
    _turned,
    relocalized,
)

HALL = [
    *room(8.0, 6.0),
    ((4.0, 0.0, 0.0), (4.2, 4.0, 2.5)),
    ((6.0, 4.5, 0.0), (7.5, 5.8, 0.9)),
    ((1.0, 0.3, 0.0), (2.0, 1.0, 0.8)),
]
LOFT = [*room(8.0, 6.0), ((2.0, 2.5, 0.0), (8.0, 2.7, 2.5)), ((0.2, 4.8, 0.0), (1.2, 5.8, 0.6))]
SQUARE = room(4.0, 4.0)
SPOTS = ((1.0, 2.0), (2.5, 4.5), (5.0, 5.0), (6.0, 2.0))


def turn(boxes, at: Pose2, own: Pose2 | None = None) -> list[Observation]:
    """A turn's frames at a pose, which the robot takes for another one: that of its own frame."""
    own = own or Pose2(0.0, 0.0, 0.0)
    frames = []
    for k in range(12):
        really = view_of(boxes, Pose2(at.x, at.y, at.yaw + k * math.pi / 6.0))
        said = view_of([], Pose2(own.x, own.y, own.yaw + k * math.pi / 6.0))
        frames.append(
            Observation(really.rgb, really.depth, really.camera, said.camera_to_map, said.robot)
        )
    return frames


def memory_of(*storeys) -> Memory:
    """The memory of a robot that has turned around at several spots of each storey, 3 m high."""
    size = {"width": CAMERA.width, "height": CAMERA.height}
    robot = Embodiment()
    robot = robot.model_copy(update={"camera": robot.camera.model_copy(update=size)})
    memory = Memory(MappingConfig(), robot)
    for number, (boxes, spots) in enumerate(storeys):
        floor = memory.floor if number == 0 else memory.floors[memory.add_floor(3.0 * number)]
        for x, y in spots:
            for frame in turn(boxes, Pose2(x, y, 0.0), Pose2(x, y, 0.0)):
                floor.map.integrate(frame)
    return memory


@pytest.fixture(scope="module")
def hall() -> Memory:
    return memory_of((HALL, SPOTS))


def is_right(found: Relocalization | None, at: Pose2, own: Pose2 | None = None) -> bool:
    """Whether the robot's pose comes out where it stands."""
    assert found is not None
    own = own or Pose2(0.0, 0.0, 0.0)
    pose = found.own_to_map @ own.to_transform()
    away_m = math.dist(pose.translation[:2], at.xy)
    return away_m < 0.25 and abs(wrap_angle(pose.yaw - at.yaw)) < math.radians(5.0)


@pytest.mark.parametrize("at", [Pose2(1.5, 3.0, 0.4), Pose2(5.5, 2.5, -2.0), Pose2(3.0, 5.0, 1.6)])
def test_a_robot_finds_its_place_from_a_frame_of_its_own(hall, at):
    found = relocalized(hall, turn(HALL, at))
    assert found is not None
    assert found.doubt == ""
    assert is_right(found, at)
    assert -math.pi <= found.own.yaw < math.pi
    assert found.own_z == 0.0


def test_a_place_without_any_other_has_no_rival(hall, monkeypatch):
    monkeypatch.setattr("hypernav.search.memory.start.relocalization._CANDIDATES", 1)
    found = relocalized(hall, turn(HALL, Pose2(1.5, 3.0, 0.4)))
    assert found is not None
    assert found.rival == 0.0


def test_any_upright_frame_will_do(hall):
    at, own = Pose2(5.5, 2.5, -2.0), Pose2(30.0, -12.0, 1.0)
    frames = [counted_from(-7.0, one) for one in turn(HALL, at, own)]
    found = relocalized(hall, frames)
    assert found is not None
    assert found.doubt == ""
    assert is_right(found, at, own)
    assert found.own_z == pytest.approx(-7.0)


def test_the_memory_stays_as_it_is(hall):
    before = {name: array.copy() for name, array in hall.floor.map.state.items()}
    assert relocalized(hall, turn(HALL, Pose2(1.5, 3.0, 0.4))) is not None
    assert all(np.array_equal(before[name], now) for name, now in hall.floor.map.state.items())
    assert len(hall.floors) == 1


def test_the_same_images_give_the_same_place(hall):
    at = Pose2(1.5, 3.0, 0.4)
    found = relocalized(hall, turn(HALL, at))
    assert is_right(found, at)
    assert relocalized(hall, turn(HALL, at)) == found


def test_a_thing_that_came_since_does_not_matter(hall):
    at = Pose2(1.5, 3.0, 0.4)
    found = relocalized(hall, turn([*HALL, ((2.6, 3.2, 0.0), (3.0, 3.6, 0.9))], at))
    assert found is not None
    assert found.doubt == ""
    assert is_right(found, at)


def test_of_two_storeys_the_right_one_is_found():
    memory = memory_of((HALL, SPOTS), (LOFT, ((1.0, 1.0), (6.0, 1.2), (5.0, 4.5))))
    at = Pose2(5.0, 4.0, 0.7)
    found = relocalized(memory, turn(LOFT, at))
    assert found is not None
    assert (found.floor, found.doubt) == (1, "")
    assert is_right(found, at)
    assert found.own_z == 3.0


def test_in_a_square_room_two_places_look_alike():
    memory = memory_of((SQUARE, ((2.0, 2.0),)))
    found = relocalized(memory, turn(SQUARE, Pose2(1.0, 1.5, 0.3)))
    assert found is not None
    assert found.doubt == "two remembered places look like what the robot sees"


def test_on_two_storeys_that_are_alike_it_is_not_clear_which_one_it_is():
    memory = memory_of((HALL, SPOTS), (HALL, SPOTS))
    found = relocalized(memory, turn(HALL, Pose2(1.5, 3.0, 0.4)))
    assert found is not None
    assert found.doubt == "two remembered places look like what the robot sees"


def test_elsewhere_no_place_is_sure(hall):
    elsewhere = [*room(3.0, 9.0), ((1.0, 4.0, 0.0), (1.6, 4.4, 2.5))]
    found = relocalized(hall, turn(elsewhere, Pose2(1.5, 2.0, 0.0)))
    assert found is not None
    assert found.doubt == "no remembered place looks like what the robot sees"


def test_without_obstacles_there_is_nothing_to_compare(hall):
    assert (
        relocalized(hall, turn([((-20, -20, -0.1), (20, 20, 0.0))], Pose2(0.0, 0.0, 0.0))) is None
    )
    assert relocalized(memory_of(), turn(HALL, Pose2(1.5, 3.0, 0.4))) is None


def test_floor_that_is_seen_in_an_obstacle_speaks_against_a_place_but_on_its_edge():
    tall = np.zeros((30, 40), dtype=bool)
    tall[10:20, 12:30] = True
    grid = OccupancyGrid(
        np.where(tall, Cell.OCCUPIED, Cell.FREE).astype(np.uint8), 0.05, (0.0, 0.0)
    )
    *_, by_floor = _Fields(_Kinds(grid, tall, np.zeros_like(tall)), 1.0).by_kind
    against = np.argwhere(by_floor < 0.0)
    assert (np.ptp(against, axis=0) + 1).tolist() == [8, 16]
    assert len(against) == 8 * 16


def test_places_that_come_into_question_are_the_best_around_at_their_heading(monkeypatch):
    """Of 40 cm to all sides, by the comparison on large cells; other candidates are for nothing."""
    monkeypatch.setattr("hypernav.search.memory.start.relocalization._CANDIDATES", 200)
    random = np.random.default_rng(0)
    tall = random.random((120, 160)) < 0.02
    cells = np.where(tall, Cell.OCCUPIED, Cell.FREE).astype(np.uint8)
    grid = OccupancyGrid(cells, 0.05, (-4.0, -3.0))
    fields = _Fields(_Kinds(grid, tall, np.zeros_like(tall)), math.sqrt(2.0))
    seen = _Seen(*random.uniform(-1.0, 1.0, (3, 40, 2)))
    reach = math.ceil(seen.reach_m / 0.2)
    side, coarse = 2 * reach + 1, [_coarse(one) for one in fields.by_kind]
    found = _candidates(fields, seen)
    assert len(found) == 200
    for x, y, yaw in found:
        column, row = np.round((np.array([x, y]) - fields.origin) / 0.2 - 0.5).astype(int) - reach
        drawn = [_counts(_turned(one, yaw), 0.2, reach) for one in seen.kinds]
        fits = {
            (i, j): sum(
                np.vdot(field[i : i + side, j : j + side], counts)
                for field, counts in zip(coarse, drawn, strict=True)
            )
            for i in range(max(row - 2, 0), min(row + 3, coarse[0].shape[0] - side + 1))
            for j in range(max(column - 2, 0), min(column + 3, coarse[0].shape[1] - side + 1))
        }
        assert fits[row, column] == pytest.approx(max(fits.values()))
