"""The decisions of one search, independent of network and disk."""

import logging
from collections.abc import Callable
from typing import cast

from hypernav.build.agents import BuiltAgent
from hypernav.core.actions import Action
from hypernav.core.components.protocols import ExplainsItself
from hypernav.core.errors import WireError
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.observation import Observation
from hypernav.core.trace import StepTrace
from hypernav.robot.server.replies import reply_of, reply_out_of_steps
from hypernav.robot.server.sensing import Sensing
from hypernav.robot.server.state.journal import Journal, SearchRecord, StepRecord
from hypernav.robot.wire.frames import PackedObservation, decode_observation, unpack_observation

_LOG = logging.getLogger(__name__)
_BLOCKED = "the robot says that it was blocked"
_BLIND = "the camera measures no depth, turning instead of driving"


class Decisions:
    """Decides about the observations of one search, in order. Not thread-safe.

    Attributes:
        grid: Map after the last decision, a copy; None before the first.
    """

    def __init__(self, record: SearchRecord, built: BuiltAgent) -> None:
        """Begin with an agent that has its goal and has seen nothing.

        Args:
            record: What the search was opened with.
            built: Agent of the search, which has a trace and a map.
        """
        request = record.request
        self.grid: OccupancyGrid | None = None
        self._built = built
        self._agent = cast(ExplainsItself, built.agent)
        self._name, self._most_steps = record.id, request.max_steps
        self._robot, self._camera = request.robot, request.camera
        self._camera_to_base = request.embodiment.camera.camera_to_base
        self._sensing = Sensing(request.embodiment)
        self._has_labels = request.labels
        self._told: Action | None = None

    def check(self, packed: PackedObservation) -> Observation:
        """Decode the next observation, and look whether it can be true; nothing else changes.

        Raises:
            WireError: It is broken, or lacks the labels that the robot said it would send.
            SensorError: What the robot senses cannot be right.
        """
        seen = self._decoded(packed)
        if self._has_labels and packed.labels is None:
            raise WireError("the search was opened with labels: true; this observation has none")
        self._sensing.check(packed, seen, self._told)
        return seen

    def decide(self, packed: PackedObservation, seen: Observation) -> StepRecord:
        """Decide about an observation that was checked.

        Raises:
            ModelUnavailableError: A model did not answer.
            ModelSetupError: A model can never answer.
            HyPerNavError: The agent cannot go on.
        """
        number = packed.header.sequence
        if number >= self._most_steps:
            return StepRecord(reply=reply_out_of_steps(number), trace=None)
        self._sensing.note(packed, seen, self._told)
        trace = self._act(seen)
        if packed.header.blocked:
            trace = trace.model_copy(update={"events": [*trace.events, _BLOCKED]})
        reply = reply_of(number, trace, self._agent.grid, self._robot)
        self._told = reply.action
        return StepRecord(reply=reply, trace=trace)

    def repeat(self, journal: Journal, is_wanted: Callable[[], bool]) -> None:
        """After a restart, give the agent all decided observations again.

        Args:
            journal: Journal of the search.
            is_wanted: Function that says whether to go on.

        Raises:
            HyPerNavError: The agent cannot repeat it.
        """
        for number in range(journal.step_count):
            if not is_wanted():
                return
            recorded = journal.step(number)
            if recorded.trace is None:
                continue
            packed = unpack_observation(journal.observation(number))
            again = self.decide(packed, self._decoded(packed))
            self._told = recorded.reply.action
            if again.reply.action != self._told:
                _LOG.warning(
                    "search %s, step %d: the action was %s, and would be %s today",
                    self._name,
                    number,
                    self._told,
                    again.reply.action,
                )

    def close(self) -> None:
        """Release what the agent holds."""
        self._built.close()

    def _decoded(self, packed: PackedObservation) -> Observation:
        return decode_observation(packed, self._camera, self._camera_to_base)

    def _act(self, seen: Observation) -> StepTrace:
        self._built.agent.act(seen)
        self.grid = self._agent.grid.cropped().copy()
        trace = self._agent.last_step
        is_blind = self._sensing.blind > 0
        return _turning(trace) if is_blind and trace.action is Action.MOVE_FORWARD else trace


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
