"""The record of an episode: one line of ``episodes.jsonl``."""

import math
from collections.abc import Callable
from dataclasses import asdict
from enum import Enum
from typing import Annotated, Any, ClassVar

from pydantic import (
    AllowInfNan,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainSerializer,
    model_serializer,
)

from hypernav.core.episode import Episode, Outcome, measure
from hypernav.lab.evaluation.failures import Facts, Failure, classify

Length = Annotated[
    float,
    AllowInfNan(True),
    BeforeValidator(lambda value: math.inf if value is None else value),
    PlainSerializer(
        lambda value: value if math.isfinite(value) else None,
        return_type=float | None,
        when_used="json",
    ),
]
"""A length in metres; an infinite one is ``null`` in JSON, which has no infinity."""

Count = Annotated[int, Field(ge=0, le=1_000_000_000_000)]
"""How many of something."""

EpisodeKey = tuple[str, str]
"""Scene and episode, which together identify a record of a run."""


class EpisodeLine(BaseModel):
    """Base of all records of one episode, a line of ``episodes.jsonl``.

    Attributes:
        scene_id: Name of the scene.
        episode_id: Name of the episode, unique within the scene.
    """

    model_config: ClassVar[ConfigDict] = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False
    )

    scene_id: str
    episode_id: str

    @property
    def key(self) -> EpisodeKey:
        """Scene and episode, which identify the record."""
        return (self.scene_id, self.episode_id)


class EpisodeRecord(EpisodeLine):
    """The result of one episode. Without a live model all but ``seconds`` is the same in every run.

    Attributes:
        goal: The object to find.
        group: Part of the data set that the episode belongs to ("unseen"); empty if there is none.
        outcome: How the episode ended.
        failure: Class of the failure; None for a success.
        why: The reason for that class, in a sentence with this episode's numbers.
        success: Whether the episode is a success under the run's own protocol.
        spl: Success weighted by path length, under the run's own protocol.
        soft_spl: Progress weighted by path length, under the run's own protocol.
        distance_to_goal_m: Geodesic distance from the end to the nearest view point.
        distance_to_object_m: Distance in the plane from the end to the surface of the nearest goal
            object on that storey; None if there is none, or in records of earlier versions.
        shortest_path_m: Geodesic distance from the start to the nearest view point.
        path_length_m: Sum of the displacements in space.
        explored_m: Length of the path until the goal was first in the image; None if it never was.
        approached_m: Length of the path from then to the end; None if it never was.
        shortest_from_sight_m: Geodesic distance from where it was first seen to the nearest view
            point; infinite if it never was.
        stopped: Whether the robot took STOP.
        steps: Number of actions.
        model_calls: Number of questions that a model was asked.
        questions: Number of questions by kind, those included that needed no model.
        unusable_answers: Number of the model's unusable answers, by reason.
        tokens_in: Number of prompt tokens.
        tokens_out: Number of answer tokens.
        saved: Folder of page and video, relative to the run's; empty if they are not kept.
        life: Name of the life that the goal belongs to; empty if there is none, and then the line
            has neither this nor the next field.
        goal_number: Number of the goal in its life, from 1.
        seconds: Wall-clock time: "total", "world" (the simulator) and by module of the agent.
    """

    goal: str
    group: str = ""
    outcome: Outcome
    failure: Failure | None
    why: str = ""
    success: bool
    spl: float
    soft_spl: float
    distance_to_goal_m: Length
    shortest_path_m: Length
    path_length_m: float
    explored_m: float | None = None
    approached_m: float | None = None
    shortest_from_sight_m: Length = math.inf
    distance_to_object_m: float | None = None
    stopped: bool
    steps: Count
    model_calls: Count
    questions: dict[str, Count] = Field(default_factory=dict)
    unusable_answers: dict[str, Count] = Field(default_factory=dict)
    tokens_in: Count = 0
    tokens_out: Count = 0
    saved: str = Field("", pattern=r"^(episodes/[a-z0-9-]{1,200})?$")
    life: str = ""
    goal_number: Count = 1
    seconds: dict[str, float] = Field(default_factory=dict)

    @model_serializer(mode="wrap")
    def _without_life(self, values_of: Callable[[Any], dict[str, Any]]) -> dict[str, Any]:
        values = values_of(self)
        if not self.life:
            del values["life"], values["goal_number"]
        return values

    def as_row(self) -> dict[str, Any]:
        """The record as a row of a table: plain values, infinite lengths as ``inf``."""
        values = {name: getattr(self, name) for name in type(self).model_fields}
        return {k: v.value if isinstance(v, Enum) else v for k, v in values.items()}

    @property
    def counts(self) -> bool:
        """Whether the episode counts in rates: model outages and simulator errors do not."""
        return self.failure is None or not self.failure.is_apart


def unmeasured_record(
    episode: Episode, outcome: Outcome, error: str, *, goal_number: int = 1
) -> EpisodeRecord:
    """The record of an episode that has no measures, and counts in no rate."""
    infinite = float("inf")
    nothing = measure(
        stopped=False,
        distance_to_goal_m=infinite,
        shortest_path_m=infinite,
        path_length_m=0.0,
        success_distance_m=0.0,
    )
    verdict = classify(Facts(outcome, error=error))
    return EpisodeRecord(
        scene_id=episode.scene_id,
        episode_id=episode.episode_id,
        goal=episode.goal.text,
        group=episode.group,
        outcome=outcome,
        failure=verdict.failure if verdict is not None else None,
        why=error,
        stopped=False,
        steps=0,
        model_calls=0,
        life=episode.life,
        goal_number=goal_number,
        **asdict(nothing),
    )
