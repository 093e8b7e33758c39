"""The end of exploration, when nothing is left to explore."""

from hypernav.agents.config import SearchConfig
from hypernav.agents.phases.approach import Approach
from hypernav.agents.phases.explore import Explore
from hypernav.agents.phases.look_around import LookAround
from hypernav.agents.phases.step import Decision, PhaseName, Step
from hypernav.core.actions import Action
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.trace import Ending, Mode
from hypernav.mapping.top_down_map import TopDownMap
from hypernav.perception.local.local_perception import LocalPerception
from hypernav.planning.navigator import Navigator


class End:
    """Goes near a goal in sight; looks once more here, and at what was rejected."""

    def __init__(
        self,
        goal: Goal,
        local: LocalPerception,
        navigator: Navigator,
        world_map: TopDownMap,
        explore: Explore,
        look_around: LookAround,
        approach: Approach,
        config: SearchConfig,
    ) -> None:
        """Put it together.

        Args:
            goal: Target of the search.
            local: Local perception, which knows whether a target is in sight.
            navigator: Navigator that drives to the target.
            world_map: Map, which forgets bumps.
            explore: Exploration, which forgets visits.
            look_around: Turn around, begun once more.
            approach: Approach, which goes as near to the target as possible.
            config: Whether to look once more, and the distance of equal positions.
        """
        self._goal = goal
        self._local = local
        self._navigator = navigator
        self._map = world_map
        self._explore = explore
        self._look_around = look_around
        self._approach = approach
        self._config = config
        self._ends: list[tuple[float, float]] = []

    def act(self, step: Step) -> Decision | PhaseName:
        """The last thing left to try, or the end of the search."""
        if self._local.target is not None and not self._approach.as_near_as_possible:
            self._approach.as_near_as_possible = True
            reason = f"all is explored, going as near to the {self._goal.thing} as possible"
            path = self._navigator.remaining(step.robot)
            return Decision(Action.TURN_LEFT, Mode.APPROACH, reason, path)
        if self._goes_on(step.robot):
            self._ends.append(step.robot.xy)
            self._explore.forget_visits()
            self._map.forget_bumps()
            self._look_around.begin()
            reason = "nothing is left to explore, looking once more"
            return Decision(Action.TURN_LEFT, Mode.LOOK_AROUND, reason)
        if self._local.belief.reconsider():
            self._approach.forget()
            step.events.append("rejected goal area reconsidered")
            reason = (
                f"nothing is left to explore, going to what looked most like the {self._goal.thing}"
            )
            return Decision(Action.TURN_LEFT, Mode.APPROACH, reason)
        reason = "nothing is left to explore"
        if self._config.claim_when_explored:
            return Decision(Action.STOP, Mode.STOP, reason, ending=Ending.FOUND)
        return Decision(None, Mode.STOP, reason, ending=Ending.GAVE_UP)

    def _goes_on(self, robot: Pose2) -> bool:
        """Whether to look once more: always, or where exploration has not yet ended before."""
        if not self._config.end_when_explored:
            return True
        near_m = 2.0 * self._config.arrival_distance_m
        return self._config.look_again_before_giving_up and all(
            robot.distance_to(*position) > near_m for position in self._ends
        )
