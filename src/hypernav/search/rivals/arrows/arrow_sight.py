"""What the arrow methods share: free directions in an image, marked moves, and destinations."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from jaxtyping import Float64

from hypernav.core.embodiment import Embodiment
from hypernav.core.exploring.exploration import Destination, ExplorationView
from hypernav.core.exploring.guidance import Arrow, ArrowView
from hypernav.core.exploring.insight import ImageMark, Insight
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.observation import Observation
from hypernav.search.drawing.shapes import ArrowStyle, draw_arrows, foot_pixel
from hypernav.search.rivals.arrows.proposals import (
    FreeDirections,
    Move,
    RayMemory,
    all_headings,
    free_ranges,
)
from hypernav.search.rivals.config import ArrowsConfig

_KEY = "arrows"
"""Key of the notes."""
_SPARE_STEPS = 2
"""Actions that a move may take beyond those of a straight one; ours."""
_TURN_REST = 3
"""Number of choices after a turn around before the next may be offered (VLMnav's code)."""
_ARRIVAL_M = 0.25
"""Distance from its end within which a move counts as done, metres; ours: in the original a move
ends exactly where it was drawn."""
_STEP_M = 0.05  # step along the floor when a mark is slid into the image
_FARTHEST_M = 20.0  # distance up to which it is slid
_MARGIN = 0.04
"""Distance of a mark from the edges of the image, as a share of its sides (VLMnav's code)."""


@dataclass
class _Notes:
    """What arrow explorers note in the search for one goal.

    Attributes:
        explored: Strips of floor that count as explored.
        rested: Number of choices since the robot turned around.
        asked: Number of questions so far.
    """

    explored: RayMemory
    rested: int
    asked: int = 0


class ArrowSight:
    """The free directions of one image and the moves marked in it; made for one choice."""

    def __init__(
        self,
        view: ExplorationView,
        embodiment: Embodiment,
        config: ArrowsConfig,
        style: ArrowStyle,
    ) -> None:
        """Begin a choice.

        Args:
            view: View of the explorer, with its notes.
            embodiment: Camera, step and turn of the robot.
            config: Rule for the marks, and length of the step where an answer names nothing.
            style: Style of the arrows.
        """
        self.observation = view.observation
        self._embodiment = embodiment
        self._config = config
        self._style = style
        self._headings = all_headings(embodiment.camera)
        fresh = _Notes(RayMemory(), _TURN_REST)
        self._notes: _Notes = view.notes.setdefault(_KEY, fresh)
        self._offered: tuple[Arrow, ...] = ()

    @property
    def may_turn(self) -> bool:
        """Whether turning around may be offered: not soon after the last time."""
        return self._notes.rested >= _TURN_REST

    def look(self) -> FreeDirections:
        """Where the floor of this image is free; it counts as explored from now on."""
        free_m = free_ranges(self.observation, self._headings, self._embodiment.camera)
        is_explored = self._notes.explored.look(self.observation.robot, self._headings, free_m)
        fov = self.observation.camera.hfov
        return FreeDirections(self._headings, free_m, is_explored, fov)

    def marked(
        self, moves: Sequence[Move], directions: FreeDirections, *, may_overlap: bool
    ) -> tuple[Arrow, ...]:
        """The moves whose ends can be marked in the image, numbered from 1.

        Args:
            moves: Moves in the order of their numbers.
            directions: What the image shows of the floor.
            may_overlap: Whether marks may overlap, as in VLMnav's code; else the first of those
                that would is kept.
        """
        arrows: list[Arrow] = []
        apart = 0.0 if may_overlap else 2.0 * self._style.radius_px(self.observation.camera.height)
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
        asked, self._notes.asked = self._notes.asked, self._notes.asked + 1
        return ArrowView(draw, arrows, may_turn, wanted, asked, facts)

    def _insight(self, taken: Arrow | None = None) -> Insight | None:
        """The arrows of the latest question and the chosen one; None if none was asked."""
        if not self._offered:
            return None
        marks = [
            ImageMark(number=one.number, pixel=one.pixel, chosen=one is taken)
            for one in self._offered
        ]
        return Insight(marks=marks, foot=self._foot if self._style.shafts else None)

    @property
    def _foot(self) -> tuple[float, float]:
        seen = self.observation
        to_base = seen.robot.to_transform().inverse() @ seen.camera_to_map
        return foot_pixel(seen.camera, to_base)

    def along(self, arrow: Arrow, reason: str) -> Destination:
        """The destination at the end of an arrow."""
        self._notes.rested += 1
        motion = self._embodiment.motion
        turns = math.ceil(abs(math.degrees(arrow.heading)) / motion.turn_angle_deg)
        steps = math.ceil(arrow.length_m / motion.forward_m)
        return self._move_to(arrow.end, reason, steps + turns, self._insight(arrow))

    def around(self, reason: str) -> Destination:
        """The destination that turns the robot by half a circle on the spot."""
        self._notes.rested = 0
        robot = self.observation.robot
        turns = self._embodiment.motion.turns_of_a_circle
        return Destination(
            *robot.xy,
            reason=reason,
            insight=self._insight(),
            holds=True,
            arrival_m=_ARRIVAL_M,
            face=robot.yaw + math.pi,
            most_steps=turns,
        )

    def step_ahead(self, reason: str) -> Destination:
        """The destination one step ahead, for an answer that names nothing."""
        self._notes.rested += 1
        length_m = self._config.blind_step_m or self._embodiment.motion.forward_m
        end = _ahead(self.observation.robot, 0.0, length_m)
        return self._move_to(end, reason, 1, self._insight())

    def _move_to(
        self, end: tuple[float, float], reason: str, steps: int, insight: Insight | None
    ) -> Destination:
        return Destination(
            *end,
            reason=reason,
            insight=insight,
            holds=True,
            arrival_m=_ARRIVAL_M,
            most_steps=steps + _SPARE_STEPS,
        )


def _ahead(robot: Pose2, heading: float, length_m: float) -> tuple[float, float]:
    angle = robot.yaw + heading
    return robot.x + length_m * float(np.cos(angle)), robot.y + length_m * float(np.sin(angle))


def mark_of(
    observation: Observation, heading: float, length_m: float, *, slide: bool
) -> tuple[float, float] | None:
    """Pixel ``(u, v)`` of the end of a move over the floor; None if it can't be marked.

    Args:
        observation: Frame whose image is marked.
        heading: Direction of the move from the robot's heading, radians, positive to the left.
        length_m: Length of the move, metres.
        slide: Whether the mark of an end outside the image is slid along its direction into it.
    """
    farthest = _FARTHEST_M if slide else length_m
    distances = np.arange(length_m, farthest + _STEP_M / 2.0, _STEP_M)
    pixels = floor_pixels(observation, heading, distances)
    camera = observation.camera
    inner = np.array([camera.width, camera.height]) * _MARGIN
    outer = np.array([camera.width, camera.height]) - inner
    inside = ((pixels >= inner) & (pixels <= outer)).all(axis=1)
    if not inside.any():
        return None
    u, v = pixels[int(inside.argmax())]
    return float(u), float(v)


def floor_pixels(
    observation: Observation, heading: float, distances_m: Float64[np.ndarray, "n"]
) -> Float64[np.ndarray, "n 2"]:
    """Pixels ``(u, v)`` of points on the floor; NaN behind the camera.

    Args:
        observation: Frame whose camera sees them.
        heading: Direction from the robot's heading, radians, positive to the left.
        distances_m: Distances from the robot, metres.
    """
    robot = observation.robot
    angle = robot.yaw + heading
    x = robot.x + distances_m * math.cos(angle)
    y = robot.y + distances_m * math.sin(angle)
    points = np.stack([x, y, np.zeros_like(x)], axis=1)
    return observation.camera.project(observation.camera_to_map.inverse().apply(points))
