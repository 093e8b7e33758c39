"""When an agent looks, stops and thinks again."""

from typing import Literal

from hypernav.core.config import RoomConfig


class SearchConfig(RoomConfig):
    """When to look, when to stop, when to think again.

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

    stop_distance_m: float = 0.15
    approach_gap_m: float = 0.15
    patience_steps: int = 16
    arrival_distance_m: float = 0.5
    endurance_steps: int = 40
    give_up_when_stuck: bool = True
    look_around_at_start: bool = True
    look_again_before_giving_up: bool = True
    look_across_boundary: bool = True
    drop_explored: bool = True
    drop_explored_radius_m: float = 0.75
    verify_view: Literal["current", "best"] = "best"
    face_target: bool = True
    see_before_stop: bool = True
    pursue_far_sightings: bool = True
