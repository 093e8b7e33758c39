"""The decisions of one search: an agent and its journal, independent of the network."""

import logging
from collections.abc import Callable
from typing import cast

from hypernav.build.agents import BuiltAgent
from hypernav.core.actions import Action
from hypernav.core.components.protocols import ExplainsItself
from hypernav.core.errors import SensorError
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.observation import Observation
from hypernav.core.trace import StepTrace
from hypernav.robot.server.replies import reply_of, reply_out_of_steps
from hypernav.robot.server.state.journal import Journal, StepRecord
from hypernav.robot.wire.frames import PackedObservation, decode_observation, unpack_observation
from hypernav.robot.wire.requests import ObservationFacts

_LOG = logging.getLogger(__name__)
_BLOCKED = "the robot says that it was blocked"
_BLIND = "the camera measures no depth, turning instead of driving"
_MOST_BLIND = 24
"""Number of images without depth in a row after which a search ends."""


class Decisions:
    """Decides about the observations of one search, in order. Not thread-safe.

    Attributes:
        grid: Map after the last decision, a copy; None before the first.
    """

    def __init__(self, journal: Journal, built: BuiltAgent) -> None:
        """Begin with an agent that has its goal and has seen nothing.

        Args:
            journal: Journal of the search.
            built: Agent of the search, which has a trace and a map.
        """
        self.grid: OccupancyGrid | None = None
        self._journal = journal
        self._built = built
        self._agent = cast(ExplainsItself, built.agent)
        self._request = journal.record.request
        self._camera = self._request.camera
        self._camera_to_base = self._request.embodiment.camera.camera_to_base
        self._blind = 0

    def decode(self, packed: PackedObservation) -> Observation:
        """The observation for the agent; nothing else changes.

        Raises:
            WireError: It is broken.
        """
        return decode_observation(packed, self._camera, self._camera_to_base)

    def decide(self, facts: ObservationFacts, observation: Observation) -> StepRecord:
        """Decide about the next observation.

        Raises:
            ModelUnavailableError: A model did not answer.
            ModelSetupError: A model can never answer.
            SensorError: The camera has measured no depth for too long.
            HyPerNavError: The agent cannot go on.
        """
        if facts.sequence >= self._request.max_steps:
            return StepRecord(reply=reply_out_of_steps(facts.sequence), trace=None)
        trace = self._act(observation)
        if facts.blocked:
            trace = trace.model_copy(update={"events": [*trace.events, _BLOCKED]})
        reply = reply_of(facts.sequence, trace, self._agent.grid, self._request.robot)
        return StepRecord(reply=reply, trace=trace)

    def repeat(self, is_wanted: Callable[[], bool]) -> None:
        """After a restart, give the agent all past observations again.

        Args:
            is_wanted: Function that says whether to go on.

        Raises:
            HyPerNavError: The agent cannot repeat it.
        """
        for number in range(self._journal.step_count):
            if not is_wanted():
                return
            recorded = self._journal.step(number)
            if recorded.trace is None:
                continue
            packed = unpack_observation(self._journal.observation(number))
            trace = self._act(self.decode(packed))
            if trace.action != recorded.trace.action:
                _LOG.warning(
                    "search %s, step %d: the action was %s, and would be %s today",
                    self._journal.record.id,
                    number,
                    recorded.trace.action,
                    trace.action,
                )

    def close(self) -> None:
        """Release what the agent holds."""
        self._built.close()

    def _act(self, observation: Observation) -> StepTrace:
        self._built.agent.act(observation)
        self.grid = self._agent.grid.cropped().copy()
        trace = self._agent.last_step
        return trace if self._sees(observation) else _turning(trace)

    def _sees(self, observation: Observation) -> bool:
        """Whether the camera measures any depth.

        Raises:
            SensorError: It has measured none for so many images that the robot has turned around.
        """
        lens = self._request.embodiment.camera
        if is_measured(observation.depth, lens.min_depth_m, lens.max_depth_m).any():
            self._blind = 0
            return True
        self._blind += 1
        if self._blind >= _MOST_BLIND:
            raise SensorError(
                f"{self._blind} images without any depth between {lens.min_depth_m:g} and "
                f"{lens.max_depth_m:g} m; does the camera work, and is its depth in metres?"
            )
        return False


def _turning(trace: StepTrace) -> StepTrace:
    """The decision with a turn in place of a blind step; the agent takes it for a bump."""
    if trace.action is not Action.MOVE_FORWARD:
        return trace
    return trace.model_copy(
        update={
            "action": Action.TURN_LEFT,
            "path": [],
            "reason": _BLIND,
            "events": [*trace.events, _BLIND],
        }
    )
