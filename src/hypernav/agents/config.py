"""When an agent looks, stops and thinks again."""

from typing import Literal

from pydantic import Field

from hypernav.core.config import RoomConfig
from hypernav.core.embodiment import MotionConfig


class SearchConfig(RoomConfig):
    """When to look, when to stop, when to think again.

    Numbers of steps are meant for steps of 0.5 m and turns of 30 degrees; a robot with shorter ones
    gets as many more.

    Attributes:
        stop_distance_m: Of the robot to where it may enter the goal area, for the presence check
            and STOP.
        approach_gap_m: A way leads to the goal area if it ends so near to where that may be
            entered: something may stand before it.
        patience_steps: A robot gets nowhere when its way has not become shorter for so long, and
            for as long as a detour takes. Close to the goal area it then stops where it is, since
            something stands around it; else it explores for a while before it tries again.
        arrival_distance_m: A destination of global perception counts as reached within this.
        endurance_steps: A destination is given up after this many steps (paper: endurance limit).
        give_up_when_stuck: A destination is given up when the robot gets nowhere, however long the
            way may be, instead of after `endurance_steps`.
        look_around_at_start: Turn once around before the first step.
        look_again_before_giving_up: When nothing is left to explore, forget which places were
            visited and where the robot bumped into something, turn once around, and only then give
            up.
        look_across_boundary: At a destination, turn to what is still unexplored around it.
        drop_explored: Give a destination up once nothing unknown is left around it.
        drop_explored_radius_m: What "around it" means.
        verify_view: The image that the presence check sees: the "current" one (paper) or the
            "best" of the approach, which still shows what stands too close or too low.
        face_target: Turn towards the goal area before the presence check.
        see_before_stop: A robot that faces the goal area and has something in between, such as a
            wall, goes on to another place at it.
        pursue_far_sightings: Go towards a goal that is seen beyond the range of depth.
    """

    stop_distance_m: float = Field(default=0.15, ge=0.0)
    approach_gap_m: float = Field(default=0.15, ge=0.0)
    patience_steps: int = Field(default=16, ge=1)
    arrival_distance_m: float = Field(default=0.5, gt=0.0)
    endurance_steps: int = Field(default=40, ge=1)
    give_up_when_stuck: bool = True
    look_around_at_start: bool = True
    look_again_before_giving_up: bool = True
    look_across_boundary: bool = True
    drop_explored: bool = True
    drop_explored_radius_m: float = Field(default=0.75, gt=0.0)
    verify_view: Literal["current", "best"] = "best"
    face_target: bool = True
    see_before_stop: bool = True
    pursue_far_sightings: bool = True

    def paced(self, motion: MotionConfig) -> "SearchConfig":
        """The same patience for a robot whose actions do more, or less, than the paper's."""
        return self.model_copy(
            update={
                "patience_steps": motion.actions_for(self.patience_steps),
                "endurance_steps": motion.actions_for(self.endurance_steps),
            }
        )
