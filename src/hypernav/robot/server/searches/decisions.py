"""The decisions of one search, and what its robot is told; independent of network and disk."""

import logging
import math
from collections.abc import Callable, Sequence
from typing import cast

import numpy as np

from hypernav.app.build.agents import BuiltAgent
from hypernav.core.components.abilities import GoesWhereSent, KeepsOut
from hypernav.core.components.protocols import ExplainsItself, Remembers
from hypernav.core.embodiment import Action, Embodiment
from hypernav.core.errors import OutputError, WireError
from hypernav.core.exploring.operator_place import OperatorPlace
from hypernav.core.geometry.closed_area import ClosedArea, with_closed
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import Ending, Mode, StepTrace, floor_of
from hypernav.robot.driving.base import Velocity as BaseVelocity
from hypernav.robot.driving.obstacles import MapObstacles
from hypernav.robot.driving.pure_pursuit import DriveConfig, PurePursuit
from hypernav.robot.server.searches.doubts import Doubts
from hypernav.robot.server.searches.journal import EndRecord, Journal, SearchRecord, StepRecord
from hypernav.robot.server.searches.sensing import Sensing
from hypernav.robot.server.searches.unknown_start import UnknownStart
from hypernav.robot.wire.frames import PackedObservation, decode_observation, unpack_observation
from hypernav.robot.wire.replies import Reply, SearchEnding, StartInMemory, Velocity
from hypernav.robot.wire.requests import ObservationFacts
from hypernav.search.memory.store.memory_folder import MemoryFolder

_LOG = logging.getLogger(__name__)
_BLOCKED = "the robot says that it was blocked"
_LOOKING = "finding out where it is in the memory"
_BLIND = "the camera measures no depth, turning instead of driving"
_SURROUNDINGS_M = 3.0
_SUGGESTED_S = 1.0
"""Time to reach the suggested velocity: a robot at standstill gets the full velocity."""
_ENDINGS = {Ending.FOUND: SearchEnding.FOUND, Ending.GAVE_UP: SearchEnding.GAVE_UP}


class Decisions:
    """Decides about the observations of one search, in order. Not thread-safe."""

    def __init__(
        self,
        record: SearchRecord,
        built: BuiltAgent,
        memory: MemoryFolder | None = None,
        start: StartInMemory | None = None,
    ) -> None:
        """Begin with an agent that has its goal and has seen nothing.

        Args:
            record: What the search was opened with.
            built: Agent of the search, which has a trace and a map.
            memory: Memory that the search begins with and adds to, open; it is saved at the end of
                the search alone, so that a restarted server can begin with the same one. None if
                there is none, or the search has left it.
            start: Where the robot was found to be in it before a restart; None if it knew, or the
                journal doesn't say it yet.
        """
        request = record.request
        self._built, self._memory = built, memory
        self._goal, self._thing = Goal(request.goal), request.thing
        self._agent = cast(ExplainsItself, built.agent)
        self._name, self._most_steps = record.id, request.max_steps
        self._robot, self._camera = request.robot, request.camera
        self._camera_to_base = request.embodiment.camera.camera_to_base
        self._sensing = Sensing(request.embodiment)
        self._doubts = Doubts(self._camera, self._camera_to_base)
        self._doubts_told: tuple[str, ...] = ()
        self._not_in_trace: list[str] = []
        self._has_labels = request.labels
        self._start: UnknownStart | None = None
        if record.relocalize:
            self._start = UnknownStart(memory, self._robot, start)
        self._commanded: Action | None = None
        self._steps = 0

    def check(self, packed: PackedObservation) -> Observation:
        """Decode the next observation, and look whether it can be true; nothing else changes.

        Raises:
            WireError: It is broken, or lacks the labels that the robot said it would send.
            SensorError: What the robot senses cannot be right.
        """
        seen = self._decoded(packed)
        if self._has_labels and packed.labels is None:
            raise WireError("the search was opened with labels: true; this observation has none")
        self._sensing.check(packed, seen, self._commanded)
        return seen

    @property
    def keeps_out(self) -> bool:
        """Whether the agent can be told where its robot is not to go."""
        return isinstance(self._built.agent, KeepsOut)

    @property
    def goes_where_sent(self) -> bool:
        """Whether the agent can be sent to a place."""
        return isinstance(self._built.agent, GoesWhereSent)

    def decide(
        self,
        packed: PackedObservation,
        seen: Observation,
        closed: Sequence[ClosedArea] = (),
        place: OperatorPlace | None = None,
    ) -> tuple[StepRecord, OccupancyGrid | None]:
        """Decide about an observation that was checked.

        Args:
            packed: The observation.
            seen: The same, decoded.
            closed: Places that the robot is not to enter.
            place: Place that it is to go to; None if it is to search.

        Returns:
            The decision, and a copy of the map that it was made on; None if the steps have run out,
            or the robot still turns to find out where it is in the memory.

        Raises:
            ModelUnavailableError: A model did not answer.
            ModelSetupError: A model can never answer.
            MemoryStartError: What the robot sees at first contradicts the memory.
            HyPerNavError: The agent cannot go on.
        """
        step, grid = self._decided(packed, seen, closed, place)
        step = self._with_doubts(step, self._doubts.look(packed.header, seen))
        self._commanded = step.reply.action
        return step if self._start is None else self._start.as_robot_knows(step), grid

    def _decided(
        self,
        packed: PackedObservation,
        seen: Observation,
        closed: Sequence[ClosedArea],
        place: OperatorPlace | None,
    ) -> tuple[StepRecord, OccupancyGrid | None]:
        """The decision in the ``map`` frame of the search, and the map."""
        number, start = packed.header.sequence, self._start
        if self._steps >= self._most_steps:
            return StepRecord(reply=_reply_out_of_steps(number, self._steps), trace=None), None
        self._sensing.note(packed, seen, self._commanded)
        if start is not None and start.told is None and not start.look(packed.header, seen):
            return StepRecord(reply=_reply_looking_around(number, self._robot), trace=None), None
        if self._steps == 0:
            seen = self._begin(packed.header, seen)
        elif self._memory is not None:
            self._memory.check(seen)
        if isinstance(self._built.agent, KeepsOut):
            self._built.agent.keep_out_of(closed)
        if isinstance(self._built.agent, GoesWhereSent):
            self._built.agent.go_to(place)
        self._built.agent.act(seen)
        self._steps += 1
        grid, trace = self._agent.grid, self._agent.last_step
        if self._sensing.blind > 0 and trace.action is Action.MOVE_FORWARD:
            trace = _turning(trace)
        if packed.header.blocked:
            trace = trace.model_copy(update={"events": [*trace.events, _BLOCKED]})
        here = [one for one in closed if one.floor == floor_of(trace)]
        reply = reply_of(number, trace, with_closed(grid, here), self._robot)
        return StepRecord(reply=reply, trace=trace), grid.cropped().copy()

    def _with_doubts(self, step: StepRecord, doubts: list[str]) -> StepRecord:
        """Tell robot and operator what may be misread; the trace, from its first step on."""
        for words in doubts:
            _LOG.warning("search %s: %s", self._name, words)
        self._not_in_trace += doubts
        self._doubts_told += tuple(doubts)
        reply, trace = step.reply, step.trace
        if doubts:
            reason = ". Check what the robot sends: ".join([reply.reason, *doubts])
            reply = reply.model_copy(update={"reason": reason})
        if trace is not None and self._not_in_trace:
            trace = trace.model_copy(update={"events": [*trace.events, *self._not_in_trace]})
            self._not_in_trace = []
        return step.model_copy(update={"reply": reply, "trace": trace, "doubts": self._doubts_told})

    def _begin(self, facts: ObservationFacts, seen: Observation) -> Observation:
        """Begin with the memory, if there is one and the robot's place there is sure.

        Returns:
            The first frame, ``map`` frame of the search.

        Raises:
            MemoryStartError: What the robot sees contradicts the memory, and it knew its place.
        """
        folder, memory = self._memory, None
        if self._start is not None:
            memory, seen = self._start.begin(facts, seen, self._goal)
        elif folder is not None:
            memory = folder.begin(self._goal, seen)
        if memory is None:
            if folder is not None:
                folder.leave()
            self._memory = None
            return seen
        cast(Remembers, self._built.agent).reset(self._goal, memory)
        if self._thing is not None:
            memory.go_first_to(self._thing.floor - 1, self._thing.number)
        return seen

    def repeat(self, journal: Journal, is_wanted: Callable[[], bool]) -> dict[int, OccupancyGrid]:
        """After a restart, give the agent all decided observations again.

        Args:
            journal: Journal of the search.
            is_wanted: Function that says whether to go on.

        Returns:
            The last map of every floor, by its number; empty before the first decision.

        Raises:
            HyPerNavError: The agent cannot repeat it.
        """
        maps, closed, sent = dict[int, OccupancyGrid](), journal.closed, journal.sent
        for number in range(journal.step_count):
            if not is_wanted():
                break
            recorded = journal.step(number)
            packed = unpack_observation(journal.observation(number))
            heeded = closed.at(number), sent.at(number)
            again, grid = self.decide(packed, self._decoded(packed), *heeded)
            if again.trace is not None and grid is not None:
                maps[floor_of(again.trace)] = grid
            self._commanded = recorded.reply.action
            if again.reply.action != self._commanded:
                _LOG.warning(
                    "search %s, step %d: the action was %s, and would be %s today",
                    self._name,
                    number,
                    self._commanded,
                    again.reply.action,
                )
        return maps

    def close(self, end: EndRecord | None) -> None:
        """Release what the agent holds, and save the memory if the search is over.

        Args:
            end: End of the search; None if it is to be taken up again.
        """
        self._built.close()
        if self._memory is None:
            return
        try:
            if end is not None:
                self._memory.end(end.ending.value, steps=self._steps)
                if words := self._memory.forgotten_words:
                    _LOG.warning("search %s: %s", self._name, words)
        except OutputError as error:
            _LOG.error("search %s: %s", self._name, error)
        finally:
            self._memory.leave()

    def _decoded(self, packed: PackedObservation) -> Observation:
        start = self._start
        to_map = None if start is None else start.robot_to_map(packed.header)
        return decode_observation(packed, self._camera, self._camera_to_base, to_map)


def reply_of(sequence: int, trace: StepTrace, grid: OccupancyGrid, robot: Embodiment) -> Reply:
    """The reply for a decision.

    Args:
        sequence: Number of the observation.
        trace: Decision of the agent.
        grid: Its map.
        robot: Body and actions of the robot.
    """
    ending = None if trace.ending is None else _ENDINGS[trace.ending]
    x, y, yaw = trace.pose
    obstacles = MapObstacles(_around(grid, x, y))
    clearance_m = float(obstacles.distances(np.array([[x, y]]))[0])
    return Reply(
        sequence=sequence,
        action=Action.STOP if trace.action is None else trace.action,
        destination=trace.destination,
        path=tuple(trace.path),
        clearance_m=round(clearance_m, 3) if clearance_m <= _SURROUNDINGS_M else None,
        velocity=None if ending else _suggested(Pose2(x, y, yaw), trace, obstacles, robot),
        mode=trace.mode,
        reason=trace.reason,
        done=ending is not None,
        ending=ending,
    )


def _reply_looking_around(sequence: int, robot: Embodiment) -> Reply:
    """The reply during the turn that finds the start in the memory."""
    return Reply(
        sequence=sequence,
        action=Action.TURN_LEFT,
        velocity=_rotation(Action.TURN_LEFT, robot),
        mode=Mode.LOOK_AROUND,
        reason=_LOOKING,
    )


def _reply_out_of_steps(sequence: int, steps: int) -> Reply:
    """The reply when the steps have run out."""
    return Reply(
        sequence=sequence,
        action=Action.STOP,
        reason=f"the limit of {steps} steps is reached",
        done=True,
        ending=SearchEnding.GAVE_UP,
    )


def _turning(trace: StepTrace) -> StepTrace:
    """A turn in place of a blind step; the agent takes it for a bump."""
    return trace.model_copy(
        update={
            "action": Action.TURN_LEFT,
            "path": [],
            "reason": _BLIND,
            "events": [*trace.events, _BLIND],
        }
    )


def _suggested(
    pose: Pose2, trace: StepTrace, obstacles: MapObstacles, robot: Embodiment
) -> Velocity:
    """A velocity along the path; without a path, that of the action's rotation."""
    pursuit = PurePursuit(DriveConfig(), robot.body.radius_m)
    if len(trace.path) > 1:
        return _rounded(pursuit.command(pose, trace.path, _SUGGESTED_S, obstacles))
    if trace.action is Action.TURN_LEFT or trace.action is Action.TURN_RIGHT:
        return _rotation(trace.action, robot)
    return _rounded(pursuit.command(pose, (), _SUGGESTED_S))


def _rotation(action: Action, robot: Embodiment) -> Velocity:
    """The velocity of a turn on the spot."""
    turn = math.radians(robot.motion.turn_angle_deg)
    pursuit = PurePursuit(DriveConfig(), robot.body.radius_m)
    return _rounded(pursuit.rotate(turn if action is Action.TURN_LEFT else -turn, _SUGGESTED_S))


def _rounded(found: BaseVelocity) -> Velocity:
    return Velocity(
        linear_m_s=round(found.linear_m_s, 4), angular_rad_s=round(found.angular_rad_s, 4)
    )


def _around(grid: OccupancyGrid, x: float, y: float) -> OccupancyGrid:
    """The part of a map around a position, at least one cell."""
    row, column = grid.cell_of(x, y)
    reach = math.ceil(_SURROUNDINGS_M / grid.resolution_m)
    rows, columns = grid.cells.shape
    bottom = min(max(row - reach, 0), rows - 1)
    left = min(max(column - reach, 0), columns - 1)
    top, right = max(row + reach + 1, bottom + 1), max(column + reach + 1, left + 1)
    size = grid.resolution_m
    origin = (grid.origin[0] + left * size, grid.origin[1] + bottom * size)
    cells = np.ascontiguousarray(grid.cells[bottom:top, left:right])
    return OccupancyGrid(cells, size, origin)
