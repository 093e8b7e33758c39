"""The start of a robot that doesn't know where it is in the server's memory.

It turns once around, in a ``map`` frame that begins where it stands. After that one fixed transform
takes the frame of its poses to the ``map`` frame of the search. That is the memory's if the place
is sure; else it stays the one that begins where the robot stands, with a memory of its own.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from hypernav.core.embodiment import Embodiment
from hypernav.core.errors import MemoryStartError
from hypernav.core.geometry.transforms import Transform, wrap_angle
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.robot.server.searches.journal import StepRecord
from hypernav.robot.wire.replies import Reply, StartInMemory
from hypernav.robot.wire.requests import ObservationFacts
from hypernav.search.memory.memory import Memory
from hypernav.search.memory.start.relocalization import found_by_turn
from hypernav.search.memory.store.memory_folder import MemoryFolder

_MISSING = 0.5
"""Share of a turn that may be missing at the end: turns are not exact."""
_APART = 0.5
"""Share of a turn by which a frame is turned from all others that are kept."""
_MOST_CIRCLES = 3
"""Number of circles whose turns are ordered at most: some may not happen."""
_NOT_AROUND = "the robot did not turn around"


class UnknownStart:
    """What the first turn of a search shows, and the transform that follows. Not thread-safe.

    Attributes:
        told: What people are told about it; None as long as the robot turns.
    """

    def __init__(
        self,
        folder: MemoryFolder | None,
        robot: Embodiment,
        recorded: StartInMemory | None = None,
    ) -> None:
        """Begin before the first observation.

        Args:
            folder: Memory, which knows something and is open; it is changed only by `begin`. None
                for a search that has left it.
            robot: The robot, whose turns are taken.
            recorded: What people were told before a restart of the server, which stays so; None if
                the robot still turned, or there was none.
        """
        self.told: StartInMemory | None = None
        self._folder, self._recorded = folder, recorded
        motion = robot.motion
        self._turn_rad = math.radians(motion.turn_angle_deg)
        self._most_turns = _MOST_CIRCLES * motion.turns_of_a_circle
        self._frames = list[Observation]()
        self._turned_rad, self._yaw = 0.0, 0.0
        self._robot_to_map: Transform | None = None

    def robot_to_map(self, facts: ObservationFacts) -> Transform:
        """The transform from the frame of the robot's poses to the ``map`` frame of the search.

        Args:
            facts: What the latest observation says of its poses.
        """
        return self._robot_to_map or facts.base_to_map.inverse()

    def look(self, facts: ObservationFacts, seen: Observation) -> bool:
        """Take a frame of the turn.

        Args:
            facts: What the observation says of its poses.
            seen: The same observation, in the ``map`` frame that begins where the robot stands.

        Returns:
            Whether the turn is over; else the robot is to turn on to the left.
        """
        self._robot_to_map = self.robot_to_map(facts)
        if self._recorded is not None:
            return facts.sequence >= self._recorded.turns
        yaw = seen.robot.yaw
        self._turned_rad += wrap_angle(yaw - self._yaw)  # it is 0 in the first frame
        self._yaw = yaw
        apart_rad = _APART * self._turn_rad
        if all(abs(wrap_angle(yaw - one.robot.yaw)) >= apart_rad for one in self._frames):
            self._frames.append(seen)
        return self._is_around or facts.sequence >= self._most_turns

    def begin(
        self, facts: ObservationFacts, seen: Observation, goal: Goal
    ) -> tuple[Memory | None, Observation]:
        """Begin the search where the turn shows the robot to be, if that is sure.

        Args:
            facts: What the last observation of the turn says of its poses.
            seen: The same observation, in the ``map`` frame that begins where the robot stood.
            goal: What to find.

        Returns:
            The memory, None if the place is not sure; and the last frame, ``map`` frame of the
            search.

        Raises:
            MemoryFolderError: The memory is that of a simulated building.
            MemoryStartError: What was sure before a restart contradicts the memory now.
        """
        own = self.robot_to_map(facts)
        if self._recorded is not None:
            told, memory, seen = self._begin_as(self._recorded, seen, own, goal)
        else:
            told, memory, seen = self._begin_by_turn(facts.sequence, seen, own, goal)
        self._frames.clear()
        self._robot_to_map, self.told = told.robot_to_map, told
        return memory, seen

    @property
    def _is_around(self) -> bool:
        """Whether the robot has looked all around."""
        return self._turned_rad >= 2.0 * math.pi - (1.0 + _MISSING) * self._turn_rad

    def _begin_by_turn(
        self, turns: int, seen: Observation, own: Transform, goal: Goal
    ) -> tuple[StartInMemory, Memory | None, Observation]:
        """Begin where the frames of the turn lie in the memory, or anew."""
        if self._folder is None or not self._is_around:
            facts = {"sure": False, "doubt": _NOT_AROUND, "turns": turns}
            return _start_in_memory(facts, own), None, seen
        found = replace(found_by_turn(self._folder.memory, self._frames), turns=turns)
        if found.place is None or found.doubt:
            return _start_in_memory(found.as_dict(), own), None, seen
        told = _start_in_memory(found.as_dict(), found.place.own_to_map @ own)
        try:
            return self._begin_as(told, seen, own, goal)
        except MemoryStartError:
            return _start_in_memory(replace(found, is_refused=True).as_dict(), own), None, seen

    def _begin_as(
        self, told: StartInMemory, seen: Observation, own: Transform, goal: Goal
    ) -> tuple[StartInMemory, Memory | None, Observation]:
        """Begin as people are told: by what they are told alone, so that a restart can repeat it.

        Raises:
            MemoryStartError: What the robot sees contradicts the memory there.
        """
        if self._folder is None or not told.sure:
            return told, None, seen
        there = seen.in_frame(told.robot_to_map @ own.inverse())
        return told, self._folder.begin(goal, there), there

    def as_robot_knows(self, step: StepRecord) -> StepRecord:
        """A decision with its reply in the frame of the robot's poses.

        Its trace, in the ``map`` frame of the search, gets the number of its observation, since
        those of the turn have none; the first one says what the turn has shown.
        """
        if step.trace is None or self.told is None or self._robot_to_map is None:
            return step.model_copy(update={"start": self.told})
        number, trace = step.reply.sequence, step.trace
        events = [self.told.words] if number == self.told.turns else []
        numbered = trace.model_copy(update={"step": number, "events": [*events, *trace.events]})
        reply = _moved(step.reply, self._robot_to_map.inverse())
        return step.model_copy(update={"reply": reply, "trace": numbered, "start": self.told})


def _moved(reply: Reply, map_to_robot: Transform) -> Reply:
    """A reply with destination and path in another upright frame."""
    ends = [] if reply.destination is None else [reply.destination]
    points = np.array([(x, y, 0.0) for x, y in (*ends, *reply.path)]).reshape(-1, 3)
    moved = [(x, y) for x, y, _ in map_to_robot.apply(points).tolist()]
    end = moved[0] if ends else None
    return reply.model_copy(update={"destination": end, "path": tuple(moved[len(ends) :])})


def _start_in_memory(facts: Mapping[str, Any], robot_to_map: Transform) -> StartInMemory:
    x, y, z = robot_to_map.translation.tolist()
    frame = (x, y, robot_to_map.yaw)
    return StartInMemory(**facts, robot_frame=frame, robot_frame_z=z)
