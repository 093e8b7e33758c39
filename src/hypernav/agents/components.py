"""The components of a search; `hypernav.build` puts them together from a configuration."""

from dataclasses import dataclass
from functools import cached_property

from hypernav.agents.config import SearchConfig
from hypernav.agents.phases.gaze import Gaze
from hypernav.core.components.protocols import Explorer, PresenceCheck
from hypernav.core.embodiment import Embodiment
from hypernav.core.trace import ExchangeLog
from hypernav.mapping.config import MappingConfig
from hypernav.perception.local.local_perception import LocalPerception
from hypernav.planning.bump_sensor import BumpSensor
from hypernav.planning.config import PlanningConfig
from hypernav.planning.navigator import Navigator


@dataclass(frozen=True, eq=False)
class SearchComponents:
    """The components of a search. None of them keeps anything between two steps.

    Attributes:
        mapping: Configuration of the maps.
        local: Local perception: finds the goal in images and on the floor plan.
        explorer: Explorer: chooses destinations while the goal is out of sight.
        planning: Configuration of planning and path following.
        embodiment: Body, camera, step and turn of the robot.
        presence: Presence check before STOP; None trusts the goal area.
        log: Log of the questions to detectors and reasoners, for the trace.
        config: Configuration of the search, for steps of 0.5 m and turns of 30 degrees.
    """

    mapping: MappingConfig
    local: LocalPerception
    explorer: Explorer
    planning: PlanningConfig
    embodiment: Embodiment
    presence: PresenceCheck | None
    log: ExchangeLog
    config: SearchConfig

    @cached_property
    def paced(self) -> SearchConfig:
        """The configuration for this robot's steps and turns."""
        return self.config.paced(self.embodiment.motion)

    @cached_property
    def navigator(self) -> Navigator:
        """Navigator that drives the robot."""
        return Navigator(self.planning, self.embodiment)

    @cached_property
    def bumps(self) -> BumpSensor:
        """Sensor of collisions with what the camera did not show."""
        return BumpSensor(self.planning, self.embodiment)

    @cached_property
    def gaze(self) -> Gaze | None:
        """Choice of the turns that show something; None where full circles are turned."""
        least_m2 = self.config.least_unseen_m2
        return None if least_m2 is None else Gaze(self.embodiment, least_m2)
