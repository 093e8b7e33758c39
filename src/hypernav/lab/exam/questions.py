"""One question of the exam with its true answer, and the record of what was answered."""

import math
from dataclasses import dataclass, field
from typing import Annotated, Literal

import numpy as np
from jaxtyping import Bool
from pydantic import BaseModel, ConfigDict, Field, model_validator

from hypernav.core.exploring.guidance import ArrowView, GuideView
from hypernav.core.exploring.overview import Overview
from hypernav.core.geometry.boxes import Box
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import Exchange

Kind = Literal["block", "boxes", "mask", "presence", "near", "arrow", "direction", "images"]

Role = Literal["goal", "alike", "other"]

KINDS: dict[Kind, str] = {
    "block": "Which block of the map to go to",
    "boxes": "Where is it in this image",
    "mask": "Which pixels of the box are it",
    "presence": "Is it really there",
    "near": "Is it likely close by",
    "arrow": "Which arrow to follow",
    "direction": "Which direction to take",
    "images": "In which of these images is it",
}
"""The types of questions, in the words of the page."""

STRATA: dict[tuple[Kind, str], str] = {
    ("boxes", "near"): "the goal is at most 2.5 m away",
    ("boxes", "far"): "the goal is farther away",
    ("boxes", "absent"): "the goal is not in the image",
    ("boxes", "look-alike"): "something alike is in the image, not the goal",
    ("mask", "near"): "the goal is at most 2.5 m away",
    ("presence", "there"): "the goal is there",
    ("presence", "not there"): "something else is there",
    ("presence", "look-alike"): "something alike is there",
    ("near", "near"): "the goal is at most 4 m away",
    ("near", "far"): "the goal is 10 m away or more",
    ("images", "shown"): "one or more of the images show the goal",
    ("images", "none"): "none of the images shows the goal",
}
"""Parts of the types that have some, in the words of the page."""

EQUAL_M = 0.5
"""Difference in length up to which two paths are equally good, metres."""

NO_IMAGE = "none"
"""The option that none of the images shows the goal."""

RIGHT_IOU = 0.5
"""Overlap (IoU) with a true box or mask from which an answer is right."""


@dataclass(frozen=True, eq=False)
class ExamQuestion:
    """A question with its true answer.

    Attributes:
        id: Name that is unique in the bank: building, sheet, kind, stratum, goal, number.
        kind: Type of the question.
        stratum: Part of the type, such as "absent" or "look-alike".
        scene: Name of the building; answers about one building are not independent.
        goal: Goal that is asked about.
        subject: What the component of the search is given to decide on; several frames where it
            is asked in which of them the goal is.
        costs: For a choice, the true length of the path to the goal by way of each option, metres.
        right: Options that are right; empty where boxes or a mask are asked for. Of images all that
            show the goal, of which an answer may name some.
        rule: Answer of the geometric rule, for comparison; empty if there is none.
        boxes: True boxes of the goal, pixels, the largest first; none where it isn't in the image.
        mask: True pixels of the goal in the first box, where a mask is asked for.
        conditions: "distance_m" to the goal, "clutter" (number of things in the image) and "light"
            (mean brightness, 0 to 1), as far as they are known.
    """

    id: str
    kind: Kind
    stratum: str
    scene: str
    goal: Goal
    subject: Overview | ArrowView | GuideView | Observation | tuple[Observation, ...]
    costs: dict[str, float] = field(default_factory=dict)
    right: frozenset[str] = frozenset()
    rule: str = ""
    boxes: tuple[Box, ...] = ()
    mask: Bool[np.ndarray, "height width"] | None = None
    conditions: dict[str, float] = field(default_factory=dict)


def best_of(costs: dict[str, float]) -> frozenset[str]:
    """The options whose paths are at most `EQUAL_M` longer than the shortest."""
    shortest = min(costs.values())
    return frozenset(option for option, cost in costs.items() if cost <= shortest + EQUAL_M)


class Shown(BaseModel):
    """A thing in the image of a question, and whether the answer marks it.

    Attributes:
        number: Number of the thing in its building.
        name: What it is.
        role: "goal", "alike" if it is easily taken for the goal, or "other".
        boxed: Whether it is the thing that some box of the answer fits best.
        view: Side from which it is seen, size, and whether the image cuts it off
            (`hypernav.search.perception.local.stand_ins.systematic_detector.view_of`).
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    number: int
    name: str
    role: Role
    boxed: bool
    view: tuple[int, int, bool]


_Share = Annotated[float, Field(ge=0.0, le=1.0 + 1e-6)]
"""A share or a probability; sums of the latter may exceed 1 by rounding."""


class Answered(BaseModel):
    """One question, its truth and its answer: a line of ``answers.jsonl``.

    Attributes:
        id: Name of the question.
        kind: Its type.
        stratum: Part of the type.
        scene: Building.
        goal: What was asked about.
        conditions: See `ExamQuestion`.
        options: The options, in the order in which they were shown.
        right: Options that are right.
        costs: True length of the path by way of each option, metres; absent if there is no path.
        travel: Length of the known path to each block, metres; empty for other questions.
        chosen: The option that was answered, of images all with commas; None if the answer can't
            be used.
        rule: Answer of the geometric rule; empty if there is none.
        true_boxes: True boxes ``(x_min, y_min, x_max, y_max)``, pixels.
        boxes: Boxes of the answer that were kept, in the same form, the best first.
        things: The things in the image, where boxes are asked for, the largest first.
        raw_boxes: Whether the model's text held any box, before the questions about crops.
        image_size: Width and height of the question's image, pixels; zeros where it has none.
        score: 1 if the answer is right, else 0.
        chance: Expected score of a random answer; 0 where there are no options.
        rule_score: Score of the rule; None if there is none.
        overlap: IoU of box or mask with the truth; None where there is none to compare with.
        probability: Probability or score that the answer was given with; None if none was told.
        unusable: Reason why the answer can't be used; empty if it can.
        exchanges: Every question to the model and its answer.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    id: str
    kind: Kind
    stratum: str
    scene: str
    goal: str
    conditions: dict[str, float] = Field(default_factory=dict)
    options: list[str] = Field(default_factory=list)
    right: list[str] = Field(default_factory=list)
    costs: dict[str, float] = Field(default_factory=dict)
    travel: dict[str, float] = Field(default_factory=dict)
    chosen: str | None = None
    rule: str = ""
    true_boxes: list[tuple[float, float, float, float]] = Field(default_factory=list)
    boxes: list[tuple[float, float, float, float]] = Field(default_factory=list)
    things: list[Shown]
    raw_boxes: bool = False
    image_size: tuple[int, int] = (0, 0)
    score: _Share
    chance: _Share = 0.0
    rule_score: _Share | None = None
    overlap: _Share | None = None
    probability: _Share | None = None
    unusable: str = ""
    exchanges: list[Exchange] = Field(default_factory=list)

    @model_validator(mode="after")
    def _shows_its_goal(self) -> "Answered":
        """What predictions reckon with: the goal's true boxes are in the image, some way off."""
        width, height = self.image_size
        for x_min, y_min, x_max, y_max in self.true_boxes if self.kind == "boxes" else ():
            if not (0.0 <= x_min < x_max <= width and 0.0 <= y_min < y_max <= height):
                raise ValueError("a true box is not in the image")
            if all(thing.role != "goal" for thing in self.things):
                raise ValueError("no thing in the image is the goal")
            if self.conditions.get("distance_m", math.inf) <= 0.0:
                raise ValueError("the goal is at no distance")
        return self

    @property
    def regret_m(self) -> float | None:
        """How much longer the chosen option's path is than the shortest, metres; None without."""
        if self.chosen is None or self.chosen not in self.costs:
            return None
        return self.costs[self.chosen] - min(self.costs.values())

    @property
    def calls(self) -> int:
        """Number of calls of a chat model that it took."""
        return sum(exchange.by_model for exchange in self.exchanges)
