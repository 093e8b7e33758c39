"""The record of what an agent did and why, one `StepTrace` per step, and the contract of views.

Videos, pages, logs, failure analysis and the operator's screen all read this stream. The loop of a
search gives the same to each of its views: every step when it is taken, and the result. A view
changes nothing, and agents and worlds do not know of views.
"""

import math
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from enum import StrEnum
from typing import Annotated, Any, ClassVar, Protocol, runtime_checkable

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    model_serializer,
)

from hypernav.core.embodiment import Action
from hypernav.core.exploring.insight import Insight
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.observation import Observation

_UNEVEN_M = 0.05
"""Height, metres, from which a robot is off the level of the start."""


class Mode(StrEnum):
    """Modes of an agent."""

    LOOK_AROUND = "look around"
    RECALL = "recall"
    EXPLORE = "explore"
    APPROACH = "approach"
    VERIFY = "verify"
    CLIMB = "climb"
    STOP = "stop"


class Ending(StrEnum):
    """Endings of a search, by the agent's claim."""

    FOUND = "found"
    """The agent says that the goal is here."""
    GAVE_UP = "gave up"
    """The agent has nothing left to try."""

    @staticmethod
    def of(action: Action | None) -> "Ending | None":
        """The ending that an agent's answer means; None if its search goes on."""
        return {Action.STOP: Ending.FOUND, None: Ending.GAVE_UP}.get(action)


class _Record(BaseModel):
    model_config: ClassVar[ConfigDict] = ConfigDict(frozen=True, extra="forbid")


class DetectionRecord(_Record):
    """One detection, and whether it was accepted.

    Attributes:
        box: Bounding box ``(x_min, y_min, x_max, y_max)``, pixels.
        score: Confidence, 0 to 1.
        label: The detector's word for the object.
        outlines: Polygons around the refined mask, pixels; empty if there is none.
        accepted: Whether the detection gave the goal area.
        reason: Reason for the rejection; empty if accepted.
    """

    box: tuple[float, float, float, float]
    score: float
    label: str
    outlines: list[list[tuple[int, int]]] = Field(default_factory=list)
    accepted: bool = False
    reason: str = ""


class BlockRecord(_Record):
    """A block on the drawn map: number and square in the ``map`` frame, metres."""

    number: int
    x_min: float
    y_min: float
    size_m: float


class Exchange(_Record):
    """One question and its answer.

    Attributes:
        kind: "ground", "crop", "verify", "stop", "score view", "summarise", "choose block",
            "choose arrow", "choose direction", "choose frontier", "choose images" or "rank images".
        asked: Name of the component that was asked: a model's name, "geometric", "ground truth".
        by_model: Whether a chat model answered.
        question: Text of the question.
        answer: Text of the answer.
        chosen: Number of the chosen block or arrow, where one was asked for.
        excluded: Numbers of the blocks that were excluded beforehand.
        probabilities: Probabilities of the allowed answers, if the model gives them.
        tokens_in: Number of prompt tokens; 0 where there is no model.
        tokens_out: Number of answer tokens.
        seconds: Time from the question to the answer.
        fault: Reason why the answer could not be used: "refused", "unparsable", "invalid" or "cut
            while thinking"; empty if it could.
        remarks: Oddities of the answer ("1 box inverted", "fell back to geometric").
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


def _height(z: float) -> float:
    return 0.0 if abs(z) < _UNEVEN_M else round(z, 3)


class StepTrace(_Record):
    """Knowledge, decision and action of an agent in one step. Metres, radians, ``map`` frame.

    Attributes:
        step: Number of the step, from 0.
        pose: Pose of the robot ``(x, y, yaw)`` before the action.
        z: Height of the robot then; 0, and left out of the JSON, less than 5 cm above or below the
            level of the start, as on rugs and sills. Traces from before have none.
        action: Action of the step; None in the last step of a search that was given up.
        mode: Mode of the agent.
        reason: Reason for the action, in one short sentence for people.
        floor: Number of the floor that the robot is on, from 1 in the order in which it came to
            know them; None, and left out of the JSON, as long as it knows of one only.
        destination: Position ``(x, y)`` that the robot is going to.
        path: Remaining path there.
        goal_area: Polygons around the goal area.
        detections: Detections of this step.
        blocks: Blocks as drawn in this step's map question; empty if none was asked.
        exchanges: Questions and answers of this step.
        events: Events worth finding again: those of `hypernav.core.events.Event`, and others.
        insight: What the explorer looked at when it chose in this step; left out of the JSON if
            there is none.
        ending: End of the search, in its last step; None as long as it goes on.
        seconds: Time per module, seconds.
    """

    step: int
    pose: tuple[float, float, float]
    z: Annotated[float, AfterValidator(_height)] = 0.0
    action: Action | None
    mode: Mode
    reason: str = ""
    floor: int | None = None
    destination: tuple[float, float] | None = None
    path: list[tuple[float, float]] = Field(default_factory=list)
    goal_area: list[list[tuple[float, float]]] = Field(default_factory=list)
    detections: list[DetectionRecord] = Field(default_factory=list)
    blocks: list[BlockRecord] = Field(default_factory=list)
    exchanges: list[Exchange] = Field(default_factory=list)
    events: list[str] = Field(default_factory=list)
    insight: Insight | None = None
    ending: Ending | None = None
    seconds: dict[str, float] = Field(default_factory=dict)

    @model_serializer(mode="wrap")
    def _without_empty_parts(self, content: Callable[[Any], dict[str, Any]]) -> dict[str, Any]:
        values = content(self)
        if self.insight is None:
            values.pop("insight", None)
        if not self.z:
            values.pop("z", None)
        if self.floor is None:
            values.pop("floor", None)
        return values


def floor_of(step: StepTrace) -> int:
    """Number of the floor that the robot is on; 1 as long as it knows of one only."""
    return step.floor or 1


def on_floor(steps: Sequence[StepTrace], floor: int) -> list[StepTrace]:
    """The steps made on a floor."""
    return [one for one in steps if floor_of(one) == floor]


def on_last_floor(steps: Sequence[StepTrace]) -> list[StepTrace]:
    """The steps made on the floor of the last one, whose map was the last one shown."""
    return on_floor(steps, floor_of(steps[-1])) if steps else []


class ExchangeLog:
    """Exchanges of detectors and reasoners, until the agent drains them into its trace."""

    def __init__(self) -> None:
        """Begin empty."""
        self._exchanges: list[Exchange] = []

    def record(self, exchange: Exchange) -> None:
        """Add one question and answer."""
        self._exchanges.append(exchange)

    def note(
        self,
        kind: str,
        asked: str,
        question: str,
        answer: str,
        *,
        chosen: int | None = None,
        excluded: Iterable[int] = (),
        seconds: float = 0.0,
    ) -> None:
        """Add a question that no chat model answered; see `Exchange` for the values."""
        self.record(
            Exchange(
                kind=kind,
                asked=asked,
                question=question,
                answer=answer,
                chosen=chosen,
                excluded=sorted(excluded),
                seconds=seconds,
            )
        )

    def drain(self) -> list[Exchange]:
        """All exchanges since the last call, oldest first."""
        drained, self._exchanges = self._exchanges, []
        return drained


class ModuleClock:
    """Adds up wall-clock seconds by name."""

    def __init__(self) -> None:
        """Begin with nothing measured."""
        self.seconds: dict[str, float] = {}

    @contextmanager
    def __call__(self, module: str) -> Iterator[None]:
        """Measure a block of code, also when it raises."""
        start = time.perf_counter()
        try:
            yield
        finally:
            elapsed = time.perf_counter() - start
            self.seconds[module] = self.seconds.get(module, 0.0) + elapsed


def without_timings(value: Any) -> Any:
    """A copy of JSON data without its ``seconds``; two runs of one seed agree in the rest."""
    if isinstance(value, dict):
        return {key: without_timings(item) for key, item in value.items() if key != "seconds"}
    if isinstance(value, list):
        return [without_timings(item) for item in value]
    return value


@runtime_checkable
class View(Protocol):
    """A file or a screen on which a search is shown."""

    def add(
        self, step: StepTrace, grid: OccupancyGrid | None, observation: Observation | None
    ) -> None:
        """Show a step.

        Args:
            step: Trace of the step.
            grid: The agent's map, which changes with the next step; None if it has none.
            observation: What the agent was given; None if it was not kept.

        Raises:
            OutputError: It cannot be written; what was shown before is kept.
        """
        ...

    def finish(self, result: Mapping[str, Any]) -> None:
        """Show how the search ended.

        Args:
            result: Content of ``result.json``; lengths may be infinite, see `json_values`.

        Raises:
            OutputError: It cannot be written.
        """
        ...

    def close(self) -> None:
        """Close files and connections, however the search ended; then the files can be read."""
        ...


@runtime_checkable
class WatchedView(View, Protocol):
    """A view that others connect to while this program runs."""

    @property
    def address(self) -> str:
        """What to open, in words that can follow "open"."""
        ...

    def has_watcher(self) -> bool:
        """Whether anybody has connected yet."""
        ...


def json_values(result: Mapping[str, Any]) -> dict[str, Any]:
    """The content of ``result.json``, where an infinite length is null."""
    return {
        key: None if isinstance(value, float) and not math.isfinite(value) else value
        for key, value in result.items()
    }
