"""Configuration of the search."""

from typing import Literal

from pydantic import Field

from hypernav.core.config import MOST_STEPS, RoomConfig
from hypernav.core.embodiment import MotionConfig


class SearchConfig(RoomConfig):
    """Configuration of looking, of stopping and of changing the destination.

    Values not marked with "paper" are ours, distances included: the paper is silent on them.
    What each of the paper's sentences became: docs/method.md.
    All numbers of steps but `max_steps` are meant for steps of 0.5 m and turns of 30 degrees; a
    robot with shorter ones gets more of them (`paced`).

    Attributes:
        stop_distance_m: Distance from the robot to an entry point of the goal area, metres, at
            which it checks the presence of the goal and stops.
        approach_gap_m: Distance from a path's end to an entry point of the goal area, metres, up to
            which the path leads there: something may stand before it.
        local_first: Whether the robot goes to a candidate whenever a path leads towards it, however
            large the gap at its end (paper: local perception has priority over global). The
            candidate is rejected if the gap is still larger than `approach_gap_m` there, or if
            patience ends. If False, a path with such a gap is taken only when all is explored.
        patience_steps: Number of steps in which the rest of the path must become shorter, beside
            those of a detour; else the robot is stuck. Close to the goal area it then verifies the
            goal from where it is, since something stands around it; else it explores for a while
            before it tries again.
        arrival_distance_m: Distance within which a destination of global perception counts as
            reached, metres.
        endurance_steps: Number of steps after which a destination is given up if
            `give_up_when_stuck` is false (paper: endurance limit; its value is ours).
        give_up_when_stuck: Whether a destination is given up when the robot is stuck
            (`patience_steps`) instead of after `endurance_steps`; either rule holds for goal areas
            as well.
        end_when_explored: Whether a search ends when nothing is left to explore; else the robot
            forgets what it visited, turns once around and goes on until the step limit (paper).
        look_around_at_start: Whether to look around before the first step on a new floor.
        finish_first_look: Whether to finish this look even if there is a candidate to go to
            already (VLFM).
        look_again_before_giving_up: Whether, when nothing is left to explore, to forget visited
            positions and bumps, turn once around, and only then give up.
        claim_when_explored: Whether to stop with the claim that the goal is here, instead of giving
            up, when nothing is left to explore; VLFM's code does.
        look_across_boundary: Whether to turn, at a destination, to what is still unexplored around
            it.
        least_unseen_m2: Unseen floor that an image must be able to show to be worth turning for, at
            the start and at a destination, square metres. None turns a full circle at the start,
            and at a destination towards the boundary of the unknown around it.
        drop_explored: Whether to give a destination up once nothing unknown is left around it.
        reconsider_steps: Number of steps after which an explorer that answers at once is asked
            again on the way, and the destination changed if it names another; None never asks on
            the way (paper).
        looks: Steps whose image is searched for the goal: "always" all off stairs (paper), or only
            "at-destinations", where the robot then turns once around before it asks the explorer
            (our reading of an ablation without local perception).
        verify_view: Image for the presence check: the "current" one or the "best" of the
            approach, which still shows what stands too close or too low.
        face_target: Whether to turn towards the goal area before the presence check.
        see_before_stop: Whether a robot that faces the goal area, but from which something such as
            a wall hides it, goes on to another entry point.
        enter_in_sight: Whether to enter the goal area where the map shows nothing as high as the
            camera between there and the target, if a path leads there.
        enter_fully: Whether to take one more step, into the goal area, where the robot would end up
            farther than `stop_distance_m` before it because a step is longer than what is left.
        go_nearer: Whether to go straight on after the check, while the path is open, where the
            detector gave a box and no mask: the outline guessed from a box may include what stands
            before the goal.
        open_the_way: Whether to look from near at gaps that are just too narrow where no path leads
            to a convincing candidate; to accept a position up to `approach_gap_m` beside its goal
            area, with the goal in sight, where the path has been blocked for `patience_steps`; and
            to go back, with the last steps, to the nearest position that it was seen from.
        max_steps: Number of steps that a search has (paper: 500); the last of them lead to the
            likeliest candidate, even if it was refuted (with `LocalConfig.target` "candidates").
        use_stairs: Whether a robot that climbs stairs looks for them, and goes on to other floors
            (the paper has nothing about floors).
        pursue_far_sightings: Whether to go towards a goal that was seen beyond the range of depth:
            to where that range ended, also through the unknown, before anything else is explored;
            and over stairs towards one that was seen on another floor.
        recall: Whether a search with a memory first goes to remembered things that may be the goal,
            then to where key images were taken in which a chat model sees it (or that look like
            it, by ``--similarity``), and looks again at what it knows where they are gone or
            nothing new is left.
    """

    stop_distance_m: float = Field(default=0.2, ge=0.0, le=10.0)
    approach_gap_m: float = Field(default=0.15, ge=0.0, le=10.0)
    local_first: bool = False
    patience_steps: int = Field(default=16, ge=0, le=MOST_STEPS)
    arrival_distance_m: float = Field(default=0.5, gt=0.0, le=10.0)
    endurance_steps: int = Field(default=40, ge=1, le=MOST_STEPS)
    give_up_when_stuck: bool = True
    end_when_explored: bool = True
    look_around_at_start: bool = True
    finish_first_look: bool = False
    look_again_before_giving_up: bool = True
    claim_when_explored: bool = False
    look_across_boundary: bool = True
    least_unseen_m2: float | None = Field(default=1.0, ge=0.0, le=1000.0)
    drop_explored: bool = True
    reconsider_steps: int | None = Field(default=3, ge=1, le=MOST_STEPS)
    looks: Literal["always", "at-destinations"] = "always"
    verify_view: Literal["current", "best"] = "best"
    face_target: bool = True
    see_before_stop: bool = True
    enter_in_sight: bool = True
    enter_fully: bool = True
    go_nearer: bool = True
    open_the_way: bool = True
    max_steps: int = Field(default=500, ge=1, le=MOST_STEPS)
    use_stairs: bool = True
    pursue_far_sightings: bool = True
    recall: bool = True

    def paced(self, motion: MotionConfig) -> "SearchConfig":
        """The configuration for a robot whose steps and turns differ from the paper's."""
        return self.model_copy(
            update={
                "patience_steps": motion.actions_for(self.patience_steps),
                "endurance_steps": motion.actions_for(self.endurance_steps),
                "reconsider_steps": self.reconsider_steps
                and motion.actions_for(self.reconsider_steps),
            }
        )
