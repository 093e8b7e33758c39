"""The agent of this package, slow enough to be interrupted; tests copy it for ``tired:Tired``."""

import time
from typing import Any

from hypernav.app.build.agents import build_agent
from hypernav.app.build.presets import HyPerNavConfig, preset
from hypernav.core.embodiment import Action, Embodiment
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import StepTrace


class SlowAgent:
    """A search with ground truth that waits before every action."""

    def __init__(self, config: HyPerNavConfig, pause_s: float):
        self._agent: Any = build_agent(config).agent
        self._pause_s = pause_s

    def reset(self, goal: Goal) -> None:
        self._agent.reset(goal)

    def act(self, observation: Observation) -> Action | None:
        time.sleep(self._pause_s)
        return self._agent.act(observation)

    @property
    def last_step(self) -> StepTrace:
        return self._agent.last_step

    @property
    def grid(self) -> OccupancyGrid:
        return self._agent.grid


class Tired(SlowAgent):
    """The same with the values of ``default``, as the command line makes it."""

    def __init__(self, embodiment: Embodiment):
        super().__init__(preset("default").model_copy(update={"embodiment": embodiment}), 0.05)
