"""The evidence of a failure in whole episodes, and the step of one that a report links to."""

import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from box_scenes import room_boxes, scene_of
from hypernav.app.build.agents import build_search
from hypernav.core.embodiment import Action
from hypernav.core.errors import ModelUnavailableError
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.trace import DetectionRecord, ExchangeLog, Mode, StepTrace
from hypernav.lab.evaluation.failure_evidence import decisive_step
from hypernav.lab.evaluation.failures import Failure
from hypernav.lab.evaluation.workers.job import Job
from hypernav.lab.evaluation.workers.worker import EpisodeWorker
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from small_episodes import episode_from
from small_worlds import InScenes, small_config

AREA = [[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]]
SEEN = [DetectionRecord(box=(0.0, 0.0, 1.0, 1.0), score=0.3, label="bed")]


def steps(areas, seen=()):
    """Steps with a goal area where there is a mark, and a detection at some of them."""
    return [
        StepTrace(
            step=number,
            pose=(0.0, 0.0, 0.0),
            action=None,
            mode=Mode.EXPLORE,
            goal_area=AREA if mark == "x" else [],
            detections=SEEN if number in seen else [],
        )
        for number, mark in enumerate(areas)
    ]


@pytest.mark.parametrize(
    ("areas", "decisive"), [("...xxx", 3), ("xx..xx", 4), ("xxx", 0), ("....", 3), ("xx..", 3)]
)
def test_a_wrong_belief_is_decided_where_the_last_one_began(areas, decisive):
    assert decisive_step(Failure.FALSE_DETECTION, steps(areas)) == decisive


def test_a_goal_that_was_missed_is_decided_where_it_was_first_detected():
    assert decisive_step(Failure.SEEN_BUT_MISSED, steps("......", seen={2, 4})) == 2
    assert decisive_step(Failure.SEEN_BUT_MISSED, steps("......")) == 5


@pytest.mark.parametrize("failure", [Failure.NEVER_SEEN, Failure.STOPPED_TOO_FAR])
def test_all_others_are_decided_at_their_end(failure):
    assert decisive_step(failure, steps("..xx..xx", seen={1})) == 7


LIVING_ROOM = Pose2(3.0, 2.0, 0.0)
BED = (7.0, 0.1, 0.0), (8.9, 1.7, 0.5)


@cache
def flat(closed=False):
    """A living room (x 0 to 5) and a bedroom (x 5 to 9), with a door or without."""
    wall = [(None, (4.95, 0.0, 0.0), (5.05, 4.0 if closed else 2.6, 2.5))]
    boxes = [
        *room_boxes(9.0, 4.0),
        *wall,
        (None, (4.95, 3.6, 0.0), (5.05, 4.0, 2.5)),
        ("sofa", (0.1, 1.2, 0.0), (0.9, 2.8, 0.7)),
        ("refrigerator", (2.0, 0.1, 0.0), (2.7, 0.8, 1.8)),
        ("bed", *BED),
    ]
    return scene_of(*boxes, name="flat")


@cache
def fenced():
    """A vase that nobody comes near to: benches stand around it."""
    fence = [
        ("bench", (2.2, 1.2, 0.0), (3.8, 1.8, 0.4)),
        ("bench", (2.2, 2.2, 0.0), (3.8, 2.8, 0.4)),
        ("bench", (2.2, 1.8, 0.0), (2.8, 2.2, 0.4)),
        ("bench", (3.2, 1.8, 0.0), (3.8, 2.2, 0.4)),
    ]
    vase = ("vase", (2.9, 1.9, 0.0), (3.1, 2.1, 0.8))
    return scene_of(*room_boxes(6.0, 4.0), *fence, vase, name="fenced")


class Mistaking:
    """A detector that takes one kind of thing for the goal."""

    def __init__(self, taken):
        self._taken, self._eyes = Goal(taken), GroundTruthDetector()

    def detect(self, observation, goal):
        return self._eyes.detect(observation, self._taken)


class Blind:
    def detect(self, observation, goal):
        return []


class Unreachable:
    def detect(self, observation, goal):
        raise ModelUnavailableError("no answer for 120 s")


class Believing:
    """Turns on the spot and holds a given area for the goal; stops if told to.

    Attributes:
        area: Corners of the goal area, scene frame.
        of: Box of pixels that gave it.
        grid: Its map.
    """

    def __init__(self, start, area, of, grid, steps):
        self._to_map = start.to_transform().inverse()
        corners = np.array([(x, y, 0.0) for x, y in area])
        self._area = [(float(x), float(y)) for x, y, _ in self._to_map.apply(corners)]
        self._of, self.grid, self._steps = of, grid, steps

    def reset(self, goal):
        self._step = -1

    def act(self, observation):
        self._step += 1
        self._pose = observation.robot
        last = self._steps is not None and self._step == self._steps
        self._action = Action.STOP if last else Action.TURN_LEFT
        return self._action

    @property
    def last_step(self):
        return StepTrace(
            step=self._step,
            pose=(self._pose.x, self._pose.y, self._pose.yaw),
            action=self._action,
            mode=Mode.APPROACH,
            goal_area=[self._area],
            detections=[DetectionRecord(box=self._of, score=1.0, label="it", accepted=True)]
            if self._step == 0
            else [],
        )


class Mute:
    """Stops at once and explains nothing."""

    def reset(self, goal):
        pass

    def act(self, observation):
        return Action.STOP


def run(agent, *, scene=flat, goal="bed", start=LIVING_ROOM, config=None, max_steps=120):
    """The record of one episode."""
    job = Job(
        Path("unused"),
        config or small_config(),
        make_agent=lambda: agent,
        world=InScenes(lambda name: scene()),
    )
    return EpisodeWorker(job).run(episode_from(start, goal, max_steps=max_steps))


def search(detector=None, config=None):
    return build_search(config or small_config(), detector or GroundTruthDetector(), ExchangeLog())


def believing(area, *, start, steps=None, of=(60.0, 85.0, 100.0, 110.0), wall=None):
    """See `Believing`; its map shows free floor everywhere but on a wall `(x_min, x_max)`."""
    cells = np.full((240, 240), Cell.FREE, np.uint8)
    if wall is not None:
        cells[:, int((wall[0] + 6) / 0.05) : int((wall[1] + 6) / 0.05)] = Cell.OCCUPIED
    return Believing(start, area, of, OccupancyGrid(cells, 0.05, (-6.0, -6.0)), steps)


def square(x, y, half=0.3):
    return [(x - half, y - half), (x + half, y - half), (x + half, y + half), (x - half, y + half)]


def test_success_has_no_failure():
    record = run(search())
    assert record.success
    assert record.failure is None
    assert record.why == ""


def test_false_detection():
    record = run(search(Mistaking("refrigerator")))
    assert record.failure is Failure.FALSE_DETECTION
    assert record.why == "it took the refrigerator for the goal; it stopped"


def test_language():
    record = run(search(Mistaking("sofa")), goal="armchair")
    assert record.failure is Failure.LANGUAGE
    assert "took the sofa, a near miss by name" in record.why


FACING_BED = Pose2(5.4, 0.9, 0.0)  # 0.6 m short of where the bed counts as reached


def test_wrong_map_when_the_goal_area_lies_beside_the_object():
    agent = believing(square(7.5, 3.2), start=FACING_BED, steps=3)
    record = run(agent, start=FACING_BED)
    assert record.failure is Failure.WRONG_MAP
    assert "1.5 m beside the bed" in record.why


def test_wrong_map_when_the_map_closes_what_is_open():
    agent = believing(square(7.4, 0.9), start=FACING_BED, wall=(0.3, 0.9))
    record = run(agent, start=FACING_BED, max_steps=4)
    assert record.failure is Failure.WRONG_MAP
    assert "no path to the bed, though there is one" in record.why


def test_target_surrounded():
    start = Pose2(1.0, 2.0, 0.0)
    agent = believing(square(3.0, 2.0, 0.1), start=start, of=(76.0, 66.0, 84.0, 82.0))
    record = run(agent, scene=fenced, goal="vase", start=start, max_steps=4)
    assert record.failure is Failure.TARGET_SURROUNDED
    assert "can be stood on" in record.why


def test_path_planning():
    record = run(search(), start=Pose2(5.6, 3.1, -0.5), max_steps=3)
    assert record.failure is Failure.PATH_PLANNING
    assert "took the bed for the goal, rightly, and ran out of steps" in record.why


def test_path_planning_when_the_robot_has_steps_enough_and_stays():
    record = run(believing(square(7.4, 0.9), start=FACING_BED), start=FACING_BED, max_steps=4)
    assert record.failure is Failure.PATH_PLANNING


def test_seen_too_late():
    start = Pose2(4.6, 0.45, math.pi)
    agent = believing(square(2.4, 0.45), start=start)
    record = run(agent, goal="refrigerator", start=start, max_steps=1)
    assert record.failure is Failure.SEEN_TOO_LATE
    assert "m longer than its steps; it ran out of steps" in record.why
    agent = believing(square(2.4, 0.45), start=start)
    record = run(agent, goal="refrigerator", start=start, max_steps=20)
    assert record.failure is Failure.PATH_PLANNING


@cache
def torn(gap_m=0.8):
    """A room whose floor has a hole before the bed; along one wall there is a way past it."""
    floor = (None, (-0.1, -0.1, -0.1), (8.1, 4.1, 0.0))
    walls = [box for box in room_boxes(8.0, 4.0) if box != floor]
    assert len(walls) == len(room_boxes(8.0, 4.0)) - 1
    floors = [
        (None, (-0.1, -0.1, -0.1), (3.0, 4.1, 0.0)),
        (None, (3.0 + gap_m, -0.1, -0.1), (8.1, 4.1, 0.0)),
        (None, (3.0, 2.8, -0.1), (3.0 + gap_m, 4.1, 0.0)),
    ]
    return scene_of(*floors, *walls, ("bed", (6.0, 0.5, 0.0), (7.9, 1.7, 0.5)), name="torn")


BEFORE_THE_HOLE = Pose2(1.5, 1.1, 0.0)


@pytest.mark.parametrize(
    ("gap_m", "failure"), [(0.8, Failure.MISSING_DATA), (0.0, Failure.PATH_PLANNING)]
)
def test_missing_data_where_the_path_leads_over_a_hole_in_the_scan(gap_m, failure):
    agent = believing(square(6.4, 1.1), start=BEFORE_THE_HOLE, of=(70.0, 62.0, 90.0, 72.0))
    record = run(agent, scene=lambda: torn(gap_m), start=BEFORE_THE_HOLE, max_steps=20)
    assert record.failure is failure
    assert ("its images lacked data" in record.why) == (gap_m > 0.0)


def test_stopped_too_far():
    config = small_config(search={"stop_distance_m": 2.0})
    record = run(search(config=config), config=config)
    assert record.failure is Failure.STOPPED_TOO_FAR
    assert f"{record.distance_to_goal_m:.2f} m from where it counts" in record.why


def test_never_seen():
    record = run(search(), max_steps=2)
    assert record.failure is Failure.NEVER_SEEN


def test_seen_but_missed():
    record = run(search(Blind()), start=FACING_BED, max_steps=5)
    assert record.failure is Failure.SEEN_BUT_MISSED
    assert "in the image in" in record.why


def test_unreachable():
    record = run(search(), scene=lambda: flat(closed=True), max_steps=60)
    assert record.failure is Failure.UNREACHABLE
    assert math.isinf(record.shortest_path_m)


def test_model_unavailable_is_apart():
    record = run(search(Unreachable()))
    assert record.failure is Failure.MODEL_UNAVAILABLE
    assert record.why == "no answer for 120 s"
    assert not record.counts


def test_simulator_error_is_apart():
    record = run(search(), start=Pose2(5.0, 1.0, 0.0))
    assert record.failure is Failure.SIMULATOR_ERROR
    assert "StartError" in record.why
    assert not record.counts


@pytest.mark.parametrize(
    ("start", "failure"),
    [
        (Pose2(5.8, 0.9, 0.0), Failure.STOPPED_TOO_FAR),
        (Pose2(3.0, 1.2, 0.0), Failure.FALSE_DETECTION),
    ],
)
def test_a_robot_that_explains_nothing_means_what_is_beside_it(start, failure):
    assert run(Mute(), start=start).failure is failure


def test_of_several_objects_in_the_image_the_one_at_the_goal_area_counts():
    agent = believing(square(2.35, 0.45), start=Pose2(3.0, 2.0, -2.0), steps=2)
    record = run(agent, start=Pose2(3.0, 2.0, -2.0), goal="refrigerator")
    assert record.failure in (None, Failure.STOPPED_TOO_FAR)
