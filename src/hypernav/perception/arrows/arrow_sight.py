"""What the arrow methods share: free directions in an image, marked moves, and destinations."""

import math
from collections.abc import Sequence
from functools import partial

import numpy as np

from hypernav.core.arrows import Arrow, ArrowView
from hypernav.core.destination import Destination
from hypernav.core.embodiment import Embodiment
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.insight import ImageMark, Insight
from hypernav.core.observation import Observation
from hypernav.perception.arrows.config import ArrowsConfig
from hypernav.perception.arrows.free_range import all_headings, free_ranges
from hypernav.perception.arrows.marks import mark_of
from hypernav.perception.arrows.proposals import FreeDirections, Move
from hypernav.perception.arrows.ray_memory import RayMemory
from hypernav.show.drawing.arrows import ArrowStyle, draw_arrows, foot_pixel

_SPARE_STEPS = 2
"""Actions that a move may take beyond those of a straight one; ours."""
_TURN_REST = 3
"""Number of choices after a turn around before the next may be offered (VLMnav's code)."""
_ARRIVAL_M = 0.25
"""Distance from the end of a move within which it is done; ours: the original moves through walls
of no simulator at all, and exactly."""


class ArrowSight:
    """The latest image, where its floor is free, and the moves in it."""

    def __init__(self, embodiment: Embodiment, config: ArrowsConfig, style: ArrowStyle) -> None:
        """Create it.

        Args:
            embodiment: Camera, step and turn of the robot.
            config: Marks, and the step of an answer that names nothing.
            style: Style of the arrows.
        """
        self._embodiment = embodiment
        self._config = config
        self._style = style
        self._headings = all_headings(embodiment.camera)
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        self._memory = RayMemory()
        self._observation: Observation | None = None
        self._rested = _TURN_REST
        self._asked = 0
        self._offered: tuple[Arrow, ...] = ()
        self._taken: Arrow | None = None

    @property
    def observation(self) -> Observation:
        """The latest frame."""
        assert self._observation is not None  # the search lets an explorer watch before it asks
        return self._observation

    @observation.setter
    def observation(self, observation: Observation) -> None:
        self._observation = observation

    @property
    def may_turn(self) -> bool:
        """Whether turning around may be offered: not soon after the last time."""
        return self._rested >= _TURN_REST

    def look(self) -> FreeDirections:
        """Where the floor of the latest image is free; it counts as explored from now on."""
        free_m = free_ranges(self.observation, self._headings, self._embodiment.camera)
        is_explored = self._memory.look(self.observation.robot, self._headings, free_m)
        fov = self.observation.camera.hfov
        return FreeDirections(self._headings, free_m, is_explored, fov)

    def marked(self, moves: Sequence[Move], directions: FreeDirections) -> tuple[Arrow, ...]:
        """The moves whose ends can be marked in the image, numbered from 1.

        Of moves whose marks would lie on each other the first is kept (ours).
        """
        arrows: list[Arrow] = []
        apart = 2.0 * self._style.radius_px(self.observation.camera.height)
        for move in moves:
            pixel = mark_of(
                self.observation, move.heading, move.length_m, slide=self._config.slide_marks
            )
            if pixel is not None and all(
                math.dist(pixel, other.pixel) >= apart for other in arrows
            ):
                arrows.append(self.arrow(len(arrows) + 1, move, pixel, directions))
        return tuple(arrows)

    def arrow(
        self, number: int, move: Move, pixel: tuple[float, float], directions: FreeDirections
    ) -> Arrow:
        """A move with its number and mark."""
        robot = self.observation.robot
        free_m, is_explored = directions.at(move.heading)
        return Arrow(
            number=number,
            heading=move.heading,
            length_m=move.length_m,
            end=_ahead(robot, move.heading, move.length_m),
            pixel=pixel,
            free_m=free_m,
            is_explored=is_explored,
        )

    def view(
        self,
        arrows: tuple[Arrow, ...],
        *,
        may_turn: bool,
        wanted: int = 1,
        facts: tuple[str, ...] = (),
    ) -> ArrowView:
        """The question about some arrows."""
        self._offered = arrows
        marks = {arrow.number: arrow.pixel for arrow in arrows}
        draw = partial(
            draw_arrows, self.observation.rgb, marks, self._foot, self._style, may_turn=may_turn
        )
        asked, self._asked = self._asked, self._asked + 1
        return ArrowView(draw, arrows, may_turn, wanted, asked, facts)

    def take_insight(self) -> Insight | None:
        """The arrows of the latest question and the chosen one, once; None if none was asked."""
        offered, self._offered = self._offered, ()
        if not offered:
            return None
        marks = [
            ImageMark(number=one.number, pixel=one.pixel, chosen=one is self._taken)
            for one in offered
        ]
        return Insight(marks=marks, foot=self._foot if self._style.shafts else None)

    @property
    def _foot(self) -> tuple[float, float]:
        seen = self.observation
        to_base = seen.robot.to_transform().inverse() @ seen.camera_to_map
        return foot_pixel(seen.camera, to_base)

    def along(self, arrow: Arrow, reason: str) -> Destination:
        """The destination at the end of an arrow."""
        self._rested += 1
        self._taken = arrow
        motion = self._embodiment.motion
        turns = math.ceil(abs(math.degrees(arrow.heading)) / motion.turn_angle_deg)
        steps = math.ceil(arrow.length_m / motion.forward_m)
        return self._move_to(arrow.end, reason, steps + turns)

    def around(self, reason: str) -> Destination:
        """The destination that turns the robot around."""
        self._rested = 0
        robot = self.observation.robot
        turns = self._embodiment.motion.turns_of_a_circle
        return Destination(
            *robot.xy,
            reason=reason,
            holds=True,
            arrival_m=_ARRIVAL_M,
            face=robot.yaw + math.pi,
            most_steps=turns,
        )

    def step_ahead(self, reason: str) -> Destination:
        """The destination one step ahead, for an answer that names nothing."""
        self._rested += 1
        length_m = self._config.blind_step_m or self._embodiment.motion.forward_m
        end = _ahead(self.observation.robot, 0.0, length_m)
        return self._move_to(end, reason, 1)

    def _move_to(self, end: tuple[float, float], reason: str, steps: int) -> Destination:
        return Destination(
            *end,
            reason=reason,
            holds=True,
            arrival_m=_ARRIVAL_M,
            most_steps=steps + _SPARE_STEPS,
        )


class MoveExplorer:
    """What explorers share that choose one move after the other from the image in view."""

    def __init__(self, sight: ArrowSight) -> None:
        """Take the sight.

        Args:
            sight: Images, and moves in them.
        """
        self._sight = sight

    def remember_visit(self, x: float, y: float) -> None:
        """Nothing: where a move ended says nothing about the next one."""

    def watch(self, observation: Observation, grid: OccupancyGrid) -> None:
        """Keep the image, in case that a move is to be chosen."""
        self._sight.observation = observation

    def take_insight(self) -> Insight | None:
        """The arrows of the latest choice; see `hypernav.core.components.abilities.Explains`."""
        return self._sight.take_insight()


def _ahead(robot: Pose2, heading: float, length_m: float) -> tuple[float, float]:
    angle = robot.yaw + heading
    return robot.x + length_m * float(np.cos(angle)), robot.y + length_m * float(np.sin(angle))
