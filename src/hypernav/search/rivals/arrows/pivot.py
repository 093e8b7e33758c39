"""Exploration by marks drawn at random, then by marks drawn around the best of them (PIVOT).

Source: Nasiriany et al., "PIVOT: Iterative Visual Prompting Elicits Actionable Knowledge for VLMs",
2024, as VLMnav's released code runs it for navigation.
"""

import math
import zlib
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float64

from hypernav.core.components.protocols import ArrowReasoner
from hypernav.core.embodiment import Embodiment
from hypernav.core.exploring.exploration import Destination, ExplorationView
from hypernav.core.exploring.guidance import TURN_AROUND, Arrow
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.search.drawing.shapes import ArrowStyle
from hypernav.search.rivals.arrows.arrow_sight import ArrowSight
from hypernav.search.rivals.arrows.proposals import MOST_MOVE_M, FreeDirections, Move
from hypernav.search.rivals.config import ArrowsConfig

_KEY = "pivot"
"""Key of this explorer's notes."""
_LINES = 1080.0
_TRIES = 50
"""Largest number of samples per wanted mark, after which there are fewer marks; ours."""


_ROUNDS = ((8, 4), (6, 3), (4, 2))
"""Number of marks drawn in each round, and number of best ones asked for (VLMnav's code)."""
_CALLS = 3
"""Number of times that each round is asked; the answers are united (VLMnav's code)."""
_INNER = 0.9
"""Share of the image's sides within which marks lie (VLMnav's code)."""
_APART_PX = 100.0
"""Least distance between marks at an image height of 1080 pixels (VLMnav's code)."""


class GaussianProposer:
    """Draws marks from a normal distribution over the image, and fits it to the best of them."""

    def __init__(self, camera: PinholeCamera, rng: np.random.Generator) -> None:
        """Begin with the middle of the image as mean, and a quarter of its sides as deviations.

        Args:
            camera: Size of the image.
            rng: Generator of the marks.
        """
        self._rng = rng
        self._size = np.array([camera.width, camera.height], dtype=np.float64)
        self._apart = _APART_PX * camera.height / _LINES
        self._rim = self._size * (1.0 - _INNER) / 2.0
        self.mean = self._size / 2.0
        self.deviation = self._size / 4.0

    def draw(self, number: int) -> Float64[np.ndarray, "n 2"]:
        """At most so many marks ``(u, v)``, pixels, apart from the edges and from each other."""
        marks: list[Float64[np.ndarray, 2]] = []
        for _ in range(number * _TRIES):
            if len(marks) == number:
                break
            one = self._rng.normal(self.mean, self.deviation)
            inside = (one >= self._rim).all() and (one <= self._size - self._rim).all()
            if inside and all(np.hypot(*(one - other)) > self._apart for other in marks):
                marks.append(one)
        return np.array(marks).reshape(-1, 2)

    def fit(self, best: Float64[np.ndarray, "n 2"]) -> None:
        """Fit the distribution to the best marks ``(u, v)``, pixels; without any it stays."""
        if len(best):
            self.mean = best.mean(axis=0)
            self.deviation = best.std(axis=0)


@dataclass(frozen=True, eq=False)
class PivotExplorer:
    """Asks for the best of random marks, draws new ones around these, and goes to the last best.

    Its 10 questions a move are 9 here: the tenth, whether to stop, is the presence check that all
    agents share.

    Attributes:
        arrow_reasoner: Reasoner that chooses marks.
        embodiment: Camera, step and turn of the robot.
        config: Seed of the marks, and configuration of the question.
    """

    arrow_reasoner: ArrowReasoner
    embodiment: Embodiment
    config: ArrowsConfig = field(default_factory=ArrowsConfig)

    def next_destination(self, view: ExplorationView) -> Destination:
        """The end of the next move, whose length is always the same: depth is not used for it.

        Raises:
            ModelUnavailableError: The reasoner's model did not answer.
        """
        sight = ArrowSight(view, self.embodiment, self.config, ArrowStyle())
        directions = sight.look()
        seed = [self.config.seed, zlib.crc32(view.goal.text.encode())]
        rng: np.random.Generator = view.notes.setdefault(_KEY, np.random.default_rng(seed))
        proposer = GaussianProposer(sight.observation.camera, rng)
        named: list[Arrow] = []
        for samples, best in _ROUNDS:
            may_turn = sight.may_turn
            arrows = self._arrows(sight, proposer.draw(samples), directions)
            question = sight.view(arrows, may_turn=may_turn, wanted=best)
            numbers: dict[int, None] = {}
            for _ in range(_CALLS if arrows else 0):
                choice = self.arrow_reasoner.choose(question, view.goal)
                chosen = choice.numbers
                if self.config.zero_is_last:
                    chosen = tuple(one or arrows[-1].number for one in chosen)
                if TURN_AROUND in chosen[:1]:
                    return sight.around(choice.reason)
                numbers |= dict.fromkeys(chosen)
            named = [question.arrow(number) for number in numbers if number != TURN_AROUND]
            proposer.fit(np.array([arrow.pixel for arrow in named]).reshape(-1, 2))
        if not named:
            return sight.step_ahead("a step ahead: no mark was named in the last round")
        angle = round(math.degrees(named[0].heading))
        side = "left" if angle > 0 else "right"
        reason = f"mark {named[0].number} of the last round, {abs(angle)}° to the {side}"
        return sight.along(named[0], reason)

    def _arrows(
        self,
        sight: ArrowSight,
        marks: Float64[np.ndarray, "n 2"],
        directions: FreeDirections,
    ) -> tuple[Arrow, ...]:
        camera = sight.observation.camera
        return tuple(
            sight.arrow(
                number,
                Move(camera.bearing_of(float(u)), MOST_MOVE_M),
                (float(u), float(v)),
                directions,
            )
            for number, (u, v) in enumerate(marks, start=1)
        )
