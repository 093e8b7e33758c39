"""Agents for searches: every search has its own, built for its robot."""

import logging
from collections.abc import Callable
from contextlib import ExitStack, closing
from dataclasses import dataclass
from pathlib import Path

from hypernav.app.build.agents import BuiltAgent, build_agent
from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.memories.building_memory import open_memory
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.components.abilities import check_remembers
from hypernav.core.components.protocols import Agent
from hypernav.core.errors import ConfigError
from hypernav.core.goal import Goal
from hypernav.robot.server.searches.journal import MODEL_FILE
from hypernav.robot.wire.requests import OpenSearch
from hypernav.search.memory.store.memory_folder import MemoryFolder

_LOG = logging.getLogger(__name__)
_PATIENCE_S = 10.0

READ_LABELS = frozenset({"ground-truth", "noisy", "systematic", "truth"})
"""Registered names of the components that read true labels."""


@dataclass(frozen=True)
class AgentPlan:
    """What an agent is built from.

    Attributes:
        config: Configuration of everything, with the robot of the search.
        specs: Specifications of the components.
        memory: Folder of the memory that a search begins with and adds to; None if there is none.
        memory_mb: Size that the memory may have from now on, megabytes; None for its own.
        relocalize: Whether robots don't know where they start in it, and find out by a turn.
    """

    config: HyPerNavConfig
    specs: ComponentSpecs
    memory: Path | None = None
    memory_mb: float | None = None
    relocalize: bool = False

    def check(self) -> str:
        """Build the agent once without a goal, so that mistakes show before a robot comes.

        Returns:
            Description of the detector, for people.

        Raises:
            HyPerNavError: As `build`, except for errors of the goal.
        """
        with closing(build_agent(self.config, self.specs)) as built:
            self._check(built.agent)
            return built.detector_words

    def build(self, goal: Goal, folder: Path) -> BuiltAgent:
        """Build the agent and give it its goal.

        Args:
            goal: What to find.
            folder: Folder of the search. Questions to the model that are recorded there are
                answered from the recording.

        Raises:
            ConfigError: The components do not fit together, or the agent lacks trace or map.
            GoalError: The goal can never be found.
            HyPerNavError: A component cannot be built.
        """
        vlm = self.specs.vlm
        asks = vlm is not None and not vlm.startswith("replay:")
        built = build_agent(
            self.config, self.specs, record=folder / MODEL_FILE if asks else None, resume=True
        )
        with ExitStack() as failed:
            failed.callback(built.close)
            self._check(built.agent)
            built.check_goal(goal)
            built.agent.reset(goal)
            failed.pop_all()
        return built

    def open_memory(self) -> MemoryFolder | None:
        """The memory, if there is one; waits a moment for the last search, which still saves to it.

        Raises:
            MemoryFolderError: The folder holds no memory, a broken one, or that of another robot or
                of a simulated building.
            RunFolderError: It is in use, or can't be written.
        """
        if self.memory is None:
            return None
        memory = open_memory(
            self.memory, self.config, most_megabytes=self.memory_mb, patience_s=_PATIENCE_S
        )
        with ExitStack() as failed:
            failed.callback(memory.leave)
            memory.check_is_of_robot()
            failed.pop_all()
        for line in memory.left_out:
            _LOG.warning("%s: %s", self.memory, line)
        return memory

    def _check(self, agent: Agent) -> None:
        _check_explains(agent)
        if self.memory is not None:
            check_remembers(agent)


def check_labels(built: BuiltAgent, request: OpenSearch) -> None:
    """Refuse a robot whose images lack the labels that the agent's components read.

    Raises:
        ConfigError: A component would fail at the first observation.
    """
    names = [choice.entry.name for choice in built.chosen.by_kind.values()]
    reading = [name for name in names if name in READ_LABELS]
    if reading and not request.labels:
        raise ConfigError(
            f"this server looks for goals with {reading[0]}, which reads true labels, and only a "
            "simulated robot can send them (labels in the request). For a real one start the "
            "server with --vlm or another --detector, such as yolox:FILE.onnx"
        )


def _check_explains(agent: Agent) -> None:
    """Refuse an agent without trace and map.

    Raises:
        ConfigError: It lacks one of them.
    """
    # `isinstance` would evaluate `last_step`, which does not exist before the first step.
    if not (hasattr(type(agent), "last_step") and hasattr(type(agent), "grid")):
        raise ConfigError(
            f"the agent {type(agent).__name__} does not explain itself; a server needs its "
            "last_step and grid (hypernav.core.components.protocols.ExplainsItself)"
        )


PlanAgent = Callable[[OpenSearch], AgentPlan]
"""Chooses the agent for a request, from the server's options and the robot's."""
