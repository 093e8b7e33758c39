"""A goal that is seen below or above the room of the robot's floor is on another floor."""

from dataclasses import replace

import numpy as np
import pytest

from box_views import CAMERA, FLOOR, SolidBox, view_of
from certainty import certain
from hypernav.core.embodiment import CameraConfig, Embodiment
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.memory.floor import Floor
from hypernav.search.memory.memory import Memory
from hypernav.search.perception.config import LocalConfig
from hypernav.search.perception.local.depth_cut import DepthCutSegmenter
from hypernav.search.perception.local.local_perception import LocalPerception

GOAL, ROBOT = Goal("thing"), Pose2(1.0, 2.0, 0.5)
BELOW, ABOVE = -1.6, 3.3
"""Heights of a thing's middle, metres: on the floor below, and on the one above."""


class Shows:
    """Shows the goal in one box of every image, with its mask."""

    def __init__(self, box: Box, score: float = 0.9):
        self.box, self.score = box, score

    def detect(self, observation, goal):
        mask = self.box.mask(observation.camera.width, observation.camera.height)
        return [Detection(self.box, self.score, "thing", mask)]


def detector_of(away_m: float, height_m: float, *, score: float = 0.9, side_m: float = 0.3):
    """A detector that shows a cube straight ahead of the robot, by half its side."""
    row = CAMERA.cy + CAMERA.fy * (0.88 - height_m) / away_m
    px = max(6.0, CAMERA.fy * side_m / (away_m - side_m))
    return Shows(Box(CAMERA.cx - px, row - px, CAMERA.cx + px, row + px), score)


def cube_at(away_m: float, height_m: float, side_m: float = 0.3) -> SolidBox:
    x, y = ROBOT.x + away_m * np.cos(ROBOT.yaw), ROBOT.y + away_m * np.sin(ROBOT.yaw)
    low = (x - side_m, y - side_m, height_m - side_m)
    return (low, (x + side_m, y + side_m, height_m + side_m))


def perception(detector: Shows, *, tells_floors: bool = True) -> LocalPerception:
    return LocalPerception(
        detector,
        DepthCutSegmenter(),
        LocalConfig(),
        CameraConfig(),
        cell_size_m=0.05,
        tells_floors=tells_floors,
    )


def new_floor() -> Floor:
    return Memory(MappingConfig(), Embodiment()).floor


def looked_at(away_m: float, height_m: float, *, tells_floors: bool = True, score: float = 0.9):
    """The floor and the record after an image of a cube straight ahead of the robot."""
    seen, floor = view_of([cube_at(away_m, height_m)], ROBOT), new_floor()
    local = perception(detector_of(away_m, height_m, score=score), tells_floors=tells_floors)
    (record,) = local.look(seen, GOAL, floor)
    return floor, record


def without_depth_of(detector: Shows, seen: Observation) -> Observation:
    """The image of a mirror, of glass, or of something black."""
    depth = seen.depth.copy()
    depth[detector.box.mask(CAMERA.width, CAMERA.height)] = 0.0
    return replace(seen, depth=depth)


@pytest.mark.parametrize("height_m", [BELOW, ABOVE])
def test_it_is_no_candidate_here_and_its_position_is_kept(height_m: float):
    floor, record = looked_at(4.5, height_m)
    assert not record.accepted
    assert "another floor" in record.reason
    assert floor.search.evidence.candidates == ()
    x, y, z = certain(floor.search.seen_off_floor)
    assert np.hypot(x - ROBOT.x, y - ROBOT.y) == pytest.approx(4.5, abs=0.4)
    assert z == pytest.approx(height_m, abs=0.3)


@pytest.mark.parametrize("height_m", [-0.3, 0.4, 2.7])
def test_what_is_in_the_room_is_a_candidate(height_m: float):
    floor, record = looked_at(4.0, height_m)
    assert record.accepted
    assert floor.search.seen_off_floor is None


@pytest.mark.parametrize("height_m", [BELOW, ABOVE])
def test_floors_are_told_apart_only_where_it_is_wanted(height_m: float):
    floor, record = looked_at(4.5, height_m, tells_floors=False)
    assert record.accepted
    assert floor.search.seen_off_floor is None


@pytest.mark.parametrize(("height_m", "away_m"), [(-2.3, 8.0), (3.4, 6.0)])
def test_out_of_range_its_line_of_sight_tells_the_floor(height_m: float, away_m: float):
    """The place is where it ends a storey away; the height is the one at which the range ends."""
    floor, record = looked_at(away_m, height_m)
    assert not record.accepted
    assert "another floor" in record.reason
    assert floor.search.evidence.far_position is None
    x, y, z = certain(floor.search.seen_off_floor)
    assert np.hypot(x - ROBOT.x, y - ROBOT.y) == pytest.approx(away_m, abs=0.2)
    assert z == pytest.approx(0.88 + (height_m - 0.88) * CameraConfig().max_depth_m / away_m)


def test_out_of_range_what_may_be_in_the_room_is_far_away():
    floor, _ = looked_at(8.0, 0.4)
    assert floor.search.seen_off_floor is None
    assert floor.search.evidence.far_position is not None


@pytest.mark.parametrize("away_m", [4.5, 8.0])
def test_a_doubtful_detection_leads_to_no_other_floor(away_m: float):
    floor, _ = looked_at(away_m, -2.3 if away_m > 5.0 else BELOW, score=0.2)
    assert floor.search.seen_off_floor is None


@pytest.mark.parametrize(("away_m", "height_m"), [(1.5, 0.2), (2.0, 0.2), (2.0, 0.1)])
def test_what_stands_near_by_without_depth_is_on_no_other_floor(away_m: float, height_m: float):
    detector, floor = detector_of(away_m, height_m, side_m=0.2), new_floor()
    seen = view_of([FLOOR, cube_at(away_m, height_m, 0.2)], ROBOT)
    (record,) = perception(detector).look(without_depth_of(detector, seen), GOAL, floor)
    assert floor.search.seen_off_floor is None
    assert "depth" in record.reason


@pytest.mark.parametrize(
    ("height_px", "gap_px", "is_near"),
    [(20, 7, True), (20, 8, False), (4, 2, True), (4, 3, False)],
)
def test_what_comes_within_half_its_height_right_below_it_tells_whether_it_is_near(
    height_px: int, gap_px: int, is_near: bool
):
    """A quarter of that has a depth, or hardly less; of small things it is three pixels."""
    top = 8
    detector, floor = Shows(Box(150.0, top, 170.0, top + height_px)), new_floor()
    seen = view_of([], ROBOT)
    depth = np.zeros_like(seen.depth)
    depth[top + height_px + gap_px :] = 2.0
    perception(detector).look(replace(seen, depth=depth), GOAL, floor)
    assert (floor.search.seen_off_floor is None) is is_near


def test_what_hangs_near_by_without_depth_is_on_no_other_floor():
    robot, floor = Pose2(0.0, 0.0, 0.0), new_floor()
    detector = detector_of(2.0, 1.9, side_m=0.2)
    seen = view_of([FLOOR, ((2.0, -5.0, 0.0), (2.2, 5.0, 3.0))], robot)
    perception(detector).look(without_depth_of(detector, seen), GOAL, floor)
    assert floor.search.seen_off_floor is None


def test_what_is_nearly_out_of_the_image_is_on_no_other_floor():
    floor = new_floor()
    seen = view_of([FLOOR, cube_at(1.5, 1.9, 0.2)], ROBOT)
    perception(detector_of(1.5, 1.9, side_m=0.2)).look(seen, GOAL, floor)
    assert floor.search.seen_off_floor is None


def test_what_is_right_before_the_camera_is_on_no_other_floor():
    """Nothing there has depth, but the map has what was seen from farther away."""
    robot, floor = Pose2(0.0, 0.0, 0.0), new_floor()
    wall = ((0.45, -5.0, 0.0), (0.6, 5.0, 3.0))
    for away_m in np.arange(1.5, 0.4, -0.1):
        floor.integrate(view_of([FLOOR, wall], Pose2(-float(away_m), 0.0, 0.0)))
    nothing = view_of([], robot)
    detector = detector_of(6.0, -2.3)
    perception(detector).look(nothing, GOAL, floor)
    assert floor.search.seen_off_floor is None
    perception(detector).look(nothing, GOAL, new := new_floor())
    assert new.search.seen_off_floor is not None


def test_what_is_then_measured_on_this_floor_is_on_no_other_one():
    floor = looked_at(8.0, -2.3)[0]
    assert floor.search.seen_off_floor is not None
    near = view_of([FLOOR, cube_at(2.0, 0.3)], ROBOT)
    perception(detector_of(2.0, 0.3)).look(near, GOAL, floor)
    assert floor.search.evidence.target is not None
    assert floor.search.seen_off_floor is None


@pytest.mark.parametrize(("ground_m", "height_m"), [(0.9, -0.7), (-0.9, 3.3)])
@pytest.mark.parametrize("away_m", [4.0, 6.0])
def test_from_another_level_of_the_floor_its_room_is_the_floor_s_too(
    ground_m: float, height_m: float, away_m: float
):
    seen = view_of([cube_at(away_m, height_m)], ROBOT)
    split, level = new_floor(), new_floor()
    for floor, height_of_ground_m in ((split, ground_m), (level, 0.0)):
        local = perception(detector_of(away_m, height_m))
        local.look(seen, GOAL, floor, ground_m=height_of_ground_m)
    assert split.search.seen_off_floor is None
    assert level.search.seen_off_floor is not None or away_m > 5.0


def test_heights_of_sightings_are_counted_from_the_floor():
    floor = new_floor()
    seen = view_of([cube_at(4.5, -1.8)], ROBOT)
    perception(detector_of(4.5, -1.8)).look(seen, GOAL, floor, ground_m=0.6)
    assert certain(floor.search.seen_off_floor)[2] == pytest.approx(-1.2, abs=0.3)
