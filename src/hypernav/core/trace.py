"""The one record of what an agent did and why, a `StepTrace` a step.

Videos, pages, logs, failure analysis and the operator's screen all read this stream.
"""

from enum import StrEnum
from typing import Any

from pydantic import BaseModel, ConfigDict, Field

from hypernav.core.actions import Action


class Mode(StrEnum):
    """What the agent is doing."""

    LOOK_AROUND = "look around"
    EXPLORE = "explore"
    APPROACH = "approach"
    VERIFY = "verify"
    STOP = "stop"


class Ending(StrEnum):
    """How an agent ended its search."""

    FOUND = "found"
    """It says that the goal is here."""
    GAVE_UP = "gave up"
    """It knows of nothing left to try."""

    @staticmethod
    def of(action: Action | None) -> "Ending | None":
        """What an agent says by its answer; None if its search goes on."""
        return {Action.STOP: Ending.FOUND, None: Ending.GAVE_UP}.get(action)


class _Record(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class DetectionRecord(_Record):
    """One detection and what became of it.

    Attributes:
        box: ``(x_min, y_min, x_max, y_max)``, pixels.
        score: 0 to 1.
        label: The detector's own word.
        outlines: Polygons around the refined mask, pixels; empty if there is none.
        accepted: Whether it gave the goal area.
        reason: Why not, if not.
    """

    box: tuple[float, float, float, float]
    score: float
    label: str
    outlines: list[list[tuple[int, int]]] = Field(default_factory=list)
    accepted: bool = False
    reason: str = ""


class BlockRecord(_Record):
    """A block as it was drawn: number and square in the ``map`` frame, metres."""

    number: int
    x_min: float
    y_min: float
    size_m: float


class Exchange(_Record):
    """One question and its answer.

    Attributes:
        kind: "ground", "choose block" or "verify".
        asked: Who was asked: a model's name, "geometric", "ground truth".
        by_model: Whether that was a chat model.
        question: The text.
        answer: The text.
        chosen: The block, for a map question.
        excluded: Blocks that were ruled out beforehand.
        probabilities: Of the allowed answers, where the model tells them.
        tokens_in: Prompt tokens, 0 where there is no model.
        tokens_out: Answer tokens.
        seconds: How long it took.
        fault: Why the answer could not be used: "refused", "unparsable" or "invalid"; empty if it
            could.
        remarks: What was odd about the answer ("1 box inverted", "fell back to geometric").
    """

    kind: str
    asked: str
    by_model: bool = False
    question: str
    answer: str
    chosen: int | None = None
    excluded: list[int] = Field(default_factory=list)
    probabilities: dict[str, float] = Field(default_factory=dict)
    tokens_in: int = 0
    tokens_out: int = 0
    seconds: float = 0.0
    fault: str = ""
    remarks: list[str] = Field(default_factory=list)


class StepTrace(_Record):
    """What an agent knew, decided and did in one step. Metres and radians, ``map`` frame.

    Attributes:
        step: From 0.
        pose: ``(x, y, yaw)`` before the action.
        action: What it did; None in the last step of a search that it gave up.
        mode: What it was doing.
        reason: Why, in one short sentence for people.
        destination: Where it is going.
        path: The rest of the way there.
        goal_area: Polygons around the goal area.
        detections: Of this step.
        blocks: As drawn in this step's map question; empty if none was asked.
        exchanges: Questions and answers of this step.
        events: Things worth finding again ("destination reached", "goal area rejected", …).
        ending: How the agent ended its search; None as long as it goes on.
        seconds: Time per module.
    """

    step: int
    pose: tuple[float, float, float]
    action: Action | None
    mode: Mode
    reason: str = ""
    destination: tuple[float, float] | None = None
    path: list[tuple[float, float]] = Field(default_factory=list)
    goal_area: list[list[tuple[float, float]]] = Field(default_factory=list)
    detections: list[DetectionRecord] = Field(default_factory=list)
    blocks: list[BlockRecord] = Field(default_factory=list)
    exchanges: list[Exchange] = Field(default_factory=list)
    events: list[str] = Field(default_factory=list)
    ending: Ending | None = None
    seconds: dict[str, float] = Field(default_factory=dict)


class ExchangeLog:
    """Where detectors and reasoners write what they asked; the agent drains it every step."""

    def __init__(self) -> None:
        """Begin empty."""
        self._exchanges: list[Exchange] = []

    def record(self, exchange: Exchange) -> None:
        """Add one question and answer."""
        self._exchanges.append(exchange)

    def drain(self) -> list[Exchange]:
        """All exchanges since the last call, oldest first."""
        drained, self._exchanges = self._exchanges, []
        return drained


def without_timings(value: Any) -> Any:
    """A copy of JSON data without its ``seconds``: what must be equal in two runs of one seed."""
    if isinstance(value, dict):
        return {key: without_timings(item) for key, item in value.items() if key != "seconds"}
    if isinstance(value, list):
        return [without_timings(item) for item in value]
    return value
