"""Destinations that say themselves how they end."""

import math

import numpy as np

from certainty import certain
from drawn_grids import drawn
from hypernav.core.embodiment import Action, CameraConfig, Embodiment, MotionConfig
from hypernav.core.exploring.exploration import Destination
from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import ExchangeLog, ModuleClock
from hypernav.search.agents.config import SearchConfig
from hypernav.search.agents.explore import explore
from hypernav.search.agents.plan import Plan
from hypernav.search.agents.step import Decision, SearchComponents, Step
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.memory.memory import Memory
from hypernav.search.perception.config import LocalConfig
from hypernav.search.perception.local.depth_cut import DepthCutSegmenter
from hypernav.search.perception.local.local_perception import LocalPerception
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from hypernav.search.planning.config import PlanningConfig

# Free floor all around the robot, and the unknown beyond.
FLOOR = drawn("\n".join(["........"] * 8), scale=10)
HERE = Pose2(2.0, 2.0, 0.0)


class Names:
    """Names one destination after the other; counts how often it was asked, and knows visits."""

    def __init__(self, *destinations):
        self._left = list(destinations)
        self.asked = 0
        self.visits = []

    def next_destination(self, view):
        self.visits = view.visits
        self.asked += 1
        return self._left.pop(0) if len(self._left) > 1 else self._left[0]


class Exploration:
    """The exploration phase with its memory and plan, step by step."""

    def __init__(self, explorer, motion, **options):
        embodiment = Embodiment(motion=motion)
        self.events = []
        self._memory = Memory(MappingConfig(), embodiment)
        self._use = SearchComponents(
            mapping=MappingConfig(),
            local=LocalPerception(
                GroundTruthDetector(),
                DepthCutSegmenter(),
                LocalConfig(),
                CameraConfig(),
                cell_size_m=0.05,
            ),
            explorer=explorer,
            planning=PlanningConfig(),
            embodiment=embodiment,
            presence=None,
            image_recall=None,
            image_ranking=None,
            log=ExchangeLog(),
            config=SearchConfig(**{"least_unseen_m2": None, **options}),
        )
        self._plan = Plan.at_start(self._use.config, turns=0)

    def act(self, robot):
        frame = Observation(
            rgb=np.zeros((3, 4, 3), dtype=np.uint8),
            depth=np.zeros((3, 4), dtype=np.float32),
            camera=PinholeCamera.from_hfov(4, 3, 79.0),
            camera_to_map=robot.to_transform() @ optical_to_base(0.88),
            robot=robot,
        )
        step = Step(0, Goal("bed"), frame, FLOOR, self._use, ModuleClock(), self.events)
        outcome, self._plan = explore(step, self._memory, self._plan)
        assert isinstance(outcome, Decision)
        return certain(outcome.action)


def driven(explorer, steps, robot=HERE, **options):
    """Actions on open floor, the events, and where the robot is then."""
    phase = Exploration(explorer, MotionConfig(forward_m=0.25), **options)
    actions = []
    for _ in range(steps):
        actions.append(phase.act(robot))
        if actions[-1] is Action.MOVE_FORWARD:
            x, y = robot.x + 0.25 * math.cos(robot.yaw), robot.y + 0.25 * math.sin(robot.yaw)
            robot = Pose2(x, y, robot.yaw)
        else:
            turn = {Action.TURN_LEFT: 1, Action.TURN_RIGHT: -1}[actions[-1]]
            robot = Pose2(robot.x, robot.y, robot.yaw + turn * math.radians(30.0))
    return actions, phase.events, robot


def test_a_heading_at_the_own_position_turns_around_and_then_asks_again():
    around = Destination(*HERE.xy, reason="turn around", holds=True, arrival_m=0.2, face=math.pi)
    away = Destination(3.5, 2.0, reason="there", holds=True, arrival_m=0.2)
    explorer = Names(around, away)
    actions, events, robot = driven(explorer, 6)
    assert actions == [Action.TURN_LEFT] * 6 or actions == [Action.TURN_RIGHT] * 6
    assert events == []
    assert abs(abs(robot.yaw) - math.pi) < 1e-6
    assert explorer.asked == 1
    _, events, _ = driven(Names(around, away), 7)
    assert events == ["destination reached"]


def test_on_arrival_the_heading_is_turned_to():
    there = Destination(3.0, 2.0, reason="there", holds=True, arrival_m=0.2, face=math.pi / 2)
    actions, _, robot = driven(Names(there), 7)
    assert actions[:4] == [Action.MOVE_FORWARD] * 4
    assert actions[4:] == [Action.TURN_LEFT] * 3
    assert abs(robot.yaw - math.pi / 2) < 1e-6


def test_a_near_destination_is_driven_to_if_its_own_distance_says_so():
    near = Destination(2.5, 2.0, reason="there", holds=True)
    far = Destination(3.5, 3.5, reason="there", holds=True)
    _, events, _ = driven(Names(near, far), 1)
    assert events == []  # not yet reached: its distance is the limit, not below it
    close = Destination(2.4, 2.0, reason="there", holds=True)
    _, events, _ = driven(Names(close, far), 2)
    assert events == ["destination reached"]
    exact = Destination(2.4, 2.0, reason="there", holds=True, arrival_m=0.25)
    actions, events, _ = driven(Names(exact, far), 1)
    assert actions == [Action.MOVE_FORWARD]
    assert events == []


def test_what_holds_is_driven_to_though_all_is_explored_there():
    there = Destination(3.2, 2.0, reason="there")
    held = Destination(3.2, 2.0, reason="there", holds=True)
    other = Destination(0.8, 2.0, reason="back")
    _, events, _ = driven(Names(there, other), 2)
    assert "destination explored" in events
    _, events, _ = driven(Names(held, other), 2)
    assert events == []


def test_the_explorer_is_asked_again_after_as_many_steps_as_it_wishes():
    there = Destination(3.8, 2.0, reason="there", most_steps=2)
    explorer = Names(there)
    actions, events, _ = driven(explorer, 5, drop_explored=False)
    assert explorer.asked == 3
    assert actions == [Action.MOVE_FORWARD] * 5
    assert events == []
    assert explorer.visits == []


def test_the_same_answer_again_does_not_renew_patience():
    """A robot that is asked to go to and fro still notices that it gets nowhere."""
    left, right = (
        Destination(x, 2.0, reason="there", most_steps=1, arrival_m=0.1) for x in (3.8, 3.85)
    )

    class ToAndFro(Names):
        def next_destination(self, view):
            self.asked += 1
            return left if self.asked % 2 else right

    stuck = {"patience_steps": 3, "drop_explored": False}
    phase = Exploration(ToAndFro(left), MotionConfig(), **stuck)
    for _ in range(40):  # the robot never moves, whatever is planned
        phase.act(HERE)
    assert "no progress to destination" in phase.events


def test_a_turn_on_the_spot_is_no_visit():
    around = Destination(*HERE.xy, reason="turn around", holds=True, arrival_m=0.2, face=math.pi)
    away = Destination(3.5, 2.0, reason="there", holds=True, arrival_m=0.2)
    explorer = Names(around, away)
    _, events, _ = driven(explorer, 7)
    assert events == ["destination reached"]
    assert explorer.visits == []
