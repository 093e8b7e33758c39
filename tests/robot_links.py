"""A server of one search without a network, and a robot without a world."""

import math
import threading
from dataclasses import dataclass, field

import numpy as np

from hypernav.app.build.agents import build_agent
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.embodiment import Action, Embodiment
from hypernav.core.errors import RequestRefusedError
from hypernav.core.geometry.grid import Cell
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.observation import LabelledPixels
from hypernav.core.trace import StepTrace
from hypernav.robot.client.robot import Executed, Sensed
from hypernav.robot.driving.base import Velocity
from hypernav.robot.wire.frames import decode_observation, unpack_observation
from hypernav.robot.wire.replies import Reply, SearchEnding
from hypernav.search.agents.search import SearchAgent


@dataclass
class AgentLink:
    """Lets an agent decide, numbers checked as the contract says. A `Link`.

    Attributes:
        config: Configuration of the agent.
        goal: What it searches for.
        hold_first: How many replies are on hold before the decision.
        blocked: Numbers of the observations that say that the motion before did not happen, and
            whether the map then shows an obstacle at the robot's front.
    """

    config: HyPerNavConfig
    goal: str
    hold_first: int = 0
    steps: list[StepTrace] = field(default_factory=list)
    last: Reply | None = None
    closed: bool = False
    blocked: dict[int, bool] = field(default_factory=dict)

    def __post_init__(self) -> None:
        agent = build_agent(self.config).agent
        assert isinstance(agent, SearchAgent)
        self.agent = agent
        self.agent.reset(Goal(self.goal))
        self._holds = self.hold_first

    def ask(self, body: bytes, sequence: int, timeout_s: float) -> Reply:
        packed = unpack_observation(body)
        expected = 0 if self.last is None else self.last.sequence + 1
        if self.last is not None and packed.header.sequence == self.last.sequence:
            return self.ask_again(sequence, timeout_s)
        if packed.header.sequence != expected:
            raise RequestRefusedError("number", error="sequence", status=409, expected=expected)
        camera = self.config.embodiment.camera
        seen = decode_observation(packed, camera.intrinsics, camera.camera_to_base)
        action = self.agent.act(seen)
        trace = self.agent.last_step
        if packed.header.blocked:
            self.blocked[packed.header.sequence] = self._is_front_occupied(seen.robot)
        self.steps.append(trace)
        ending = {Action.STOP: SearchEnding.FOUND, None: SearchEnding.GAVE_UP}.get(action)
        self.last = Reply(
            sequence=packed.header.sequence,
            action=Action.STOP if action is None else action,
            path=tuple(trace.path),
            mode=trace.mode,
            reason=trace.reason,
            done=ending is not None,
            ending=ending,
        )
        self._holds = self.hold_first
        return self.ask_again(sequence, timeout_s)

    def ask_again(self, sequence: int, timeout_s: float) -> Reply:
        assert self.last is not None
        if self._holds > 0:
            self._holds -= 1
            return Reply(sequence=self.last.sequence, hold=True)
        return self.last

    def give_up(self, reason: str) -> None:
        self.given_up = reason

    def close(self) -> None:
        self.closed = True

    def _is_front_occupied(self, robot: Pose2) -> bool:
        reach_m = self.config.planning.clearances_m(self.config.embodiment.body)[0]
        fronts = (
            Velocity(reach_m).moved(Pose2(robot.x, robot.y, robot.yaw + math.radians(angle)), 1.0)
            for angle in range(-60, 61, 10)
        )
        grid = self.agent.grid
        return any(grid.state_at(*front.xy) is Cell.OCCUPIED for front in fronts)


_SMALL = Embodiment.model_validate({"camera": {"width": 16, "height": 12}})


class StandIn:
    """A robot of which every step succeeds, unless it is stopped."""

    def __init__(self, embodiment: Embodiment = _SMALL) -> None:
        self.embodiment = embodiment
        self.x = 0.0
        self.executed: list[Action] = []
        self.stops = 0
        self.begun, self.stopped = threading.Event(), threading.Event()
        self.hangs = self.camera_hangs = False

    def observe(self) -> Sensed:
        size = (self.embodiment.camera.height, self.embodiment.camera.width)
        rgb, depth = np.zeros((*size, 3), dtype=np.uint8), np.ones(size, dtype=np.float32)
        labels = LabelledPixels(np.full(size, -1, dtype=np.int32), {})
        pose = Pose2(self.x, 0.0, 0.0)
        stamp_s = 0.0 if self.camera_hangs else self.x
        return Sensed(rgb, depth, pose, stamp_s=stamp_s, truth=labels)

    def execute(self, action: Action) -> Executed:
        self.executed.append(action)
        self.begun.set()
        if self.hangs:
            self.stopped.wait()
            return Executed.STOPPED
        self.x += 0.5
        return Executed.DONE

    def stop(self) -> None:
        self.stops += 1
        self.stopped.set()
