"""Checks by a chat model that answers yes or no: of a detection's crop, and at the goal.

The check at the goal comes before the robot declares success (paper: Termination).
"""

from dataclasses import dataclass, field

import numpy as np

from hypernav.core.chat import Image, Question
from hypernav.core.config import along
from hypernav.core.geometry.boxes import Box
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import same_name
from hypernav.core.observation import Observation
from hypernav.search.perception.config import CROP_WORDS, PresenceConfig
from hypernav.search.perception.exchanges import YesNoAsker, yes_no_question

_CONFUSIONS: tuple[tuple[str, ...], ...] = (
    ("shower curtain", "window curtain"),
    ("chair", "armchair", "stool"),
    ("sofa", "armchair", "bed"),
    ("tv", "mirror", "picture"),
    ("desk", "dining table"),
    ("dining table", "coffee table"),
    ("nightstand", "cabinet", "dresser"),
    ("sink", "bathtub"),
    ("refrigerator", "wardrobe"),
    ("washing machine", "oven", "dishwasher"),
    ("potted plant", "vase"),
    ("toilet", "bidet"),
)


def confusions(goal: Goal) -> tuple[str, ...]:
    """Names of things that are easily confused with a goal."""
    return tuple(
        other
        for group in _CONFUSIONS
        if any(same_name(name, goal.thing) for name in group)
        for other in group
        if not same_name(other, goal.thing)
    )


def crop_question(crop: Image, goal: Goal) -> Question:
    """Question whether a crop (RGB) shows the goal; things confused with it are alternatives."""
    wanted = goal.with_article
    others = "".join(f", {Goal(other).with_article}" for other in confusions(goal))
    text = CROP_WORDS.format(wanted=wanted, others=others)
    return yes_no_question("crop", text, crop)


def crop_of(image: Image, box: Box, margin: float) -> Image:
    """The part of an image around a box.

    Args:
        image: RGB.
        box: Box, pixels; a part of it lies in the image.
        margin: Width of what is shown around the box, as a share of its sides.
    """
    dx, dy = margin * (box.x_max - box.x_min), margin * (box.y_max - box.y_min)
    around = Box(box.x_min - dx, box.y_min - dy, box.x_max + dx, box.y_max + dy)
    height, width = image.shape[:2]
    x_min, y_min, x_max, y_max = around.clipped(width, height).pixels()
    return np.ascontiguousarray(image[y_min:y_max, x_min:x_max])


def presence_question(config: PresenceConfig, image: Image, goal: Goal) -> Question:
    """Question to a model whether an image (RGB) shows the goal."""
    return yes_no_question("verify", goal.named_in(config.prompt), image)


@dataclass(eq=False)
class VlmPresenceCheck(YesNoAsker):
    """Asks a vision-language model whether the goal is really in the image.

    Attributes:
        config: Configuration of the question.
    """

    config: PresenceConfig = field(default_factory=PresenceConfig)

    count_name = "unsure_presence_checks"

    def is_present(self, observation: Observation, goal: Goal) -> bool:
        """Whether the model says yes.

        Raises:
            ModelUnavailableError: The model did not answer within the configured patience.
        """
        question = presence_question(self.config, observation.rgb, goal)
        yes = self.ask(question, f"taken for {self.config.unsure}")
        if yes is None:
            return self.config.unsure == "yes"
        if self.config.calibration:
            yes = along(self.config.calibration, yes)
        return yes >= self.config.min_probability
