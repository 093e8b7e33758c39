"""The start of a robot that doesn't know where it is in the server's memory.

It turns once around, in a ``map`` frame that begins where it stands. After that one fixed transform
takes the frame of its poses to the ``map`` frame of the search. That is the memory's if the place
is sure; else it stays the one that begins where the robot stands, with a memory of its own.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from hypernav.core.embodiment import Embodiment
from hypernav.core.errors import MemoryStartError
from hypernav.core.geometry.transforms import Transform, wrap_angle
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.mapping.memory.memory import Memory
from hypernav.mapping.memory.memory_folder import MemoryFolder
from hypernav.mapping.memory.unknown_start import FoundStart, found_by_turn
from hypernav.robot.server.state.journal import StepRecord
from hypernav.robot.wire.replies import Reply, StartInMemory
from hypernav.robot.wire.requests import ObservationFacts

_MISSING = 0.5
"""Share of a turn that may be missing at the end: turns are not exact."""


class UnknownStart:
    """What the first turn of a search shows, and the transform that follows. Not thread-safe.

    Attributes:
        told: What people are told about it; None as long as the robot turns.
    """

    def __init__(self, folder: MemoryFolder, robot: Embodiment) -> None:
        """Begin before the first observation.

        Args:
            folder: Memory, which knows something and is open; it is changed only by `begin`.
            robot: The robot, whose turns are taken.
        """
        self.told: StartInMemory | None = None
        self._folder = folder
        turn_rad = math.radians(robot.motion.turn_angle_deg)
        self._around_rad = 2.0 * math.pi - (1.0 + _MISSING) * turn_rad
        self._frames = list[Observation]()
        self._last_of_turn = 0
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
            Whether the robot has looked all around; else it is to turn on to the left.
        """
        self._robot_to_map = self.robot_to_map(facts)
        self._frames.append(seen)
        self._last_of_turn = facts.sequence
        return _turned_rad(self._frames) >= self._around_rad

    def begin(self, facts: ObservationFacts, goal: Goal) -> tuple[Memory | None, Observation]:
        """Begin the search where the turn shows the robot to be, if that is sure.

        Args:
            facts: What the last observation of the turn says of its poses.
            goal: What to find.

        Returns:
            The memory, None if the place is not sure; and the last frame, ``map`` frame of the
            search.

        Raises:
            MemoryFolderError: The memory is that of a simulated building.
        """
        found, seen = found_by_turn(self._folder.memory, self._frames), self._frames[-1]
        self._frames.clear()
        memory, to_map = None, self.robot_to_map(facts)
        if found.place is not None and not found.doubt:
            there = seen.in_frame(found.place.own_to_map)
            try:
                memory = self._folder.begin(goal, there)
            except MemoryStartError:
                found = replace(found, is_refused=True)
            else:
                seen, to_map = there, found.place.own_to_map @ to_map
        self._robot_to_map, self.told = to_map, _told(found, to_map)
        return memory, seen

    def as_robot_knows(self, step: StepRecord) -> StepRecord:
        """A decision with its reply in the frame of the robot's poses.

        Its trace, in the ``map`` frame of the search, gets the number of its observation, since
        those of the turn have none; the first one says what the turn has shown.
        """
        if step.trace is None or self.told is None or self._robot_to_map is None:
            return step.model_copy(update={"start": self.told})
        number, trace = step.reply.sequence, step.trace
        events = [self.told.words] if number == self._last_of_turn else []
        numbered = trace.model_copy(update={"step": number, "events": [*events, *trace.events]})
        reply = _moved(step.reply, self._robot_to_map.inverse())
        return StepRecord(reply=reply, trace=numbered, start=self.told)


def _moved(reply: Reply, map_to_robot: Transform) -> Reply:
    """A reply with destination and path in another upright frame."""
    ends = [] if reply.destination is None else [reply.destination]
    points = np.array([(x, y, 0.0) for x, y in (*ends, *reply.path)]).reshape(-1, 3)
    moved = [(x, y) for x, y, _ in map_to_robot.apply(points).tolist()]
    end = moved[0] if ends else None
    return reply.model_copy(update={"destination": end, "path": tuple(moved[len(ends) :])})


def _turned_rad(frames: Sequence[Observation]) -> float:
    """Angle by which the robot has turned to the left since the first frame, radians."""
    return sum(wrap_angle(b.robot.yaw - a.robot.yaw) for a, b in pairwise(frames))


def _told(found: FoundStart, robot_to_map: Transform) -> StartInMemory:
    x, y, z = robot_to_map.translation.tolist()
    frame = (x, y, robot_to_map.yaw)
    return StartInMemory(**found.as_dict(), robot_frame=frame, robot_frame_z=z)
