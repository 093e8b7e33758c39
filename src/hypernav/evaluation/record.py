"""What is kept of an episode: one line of ``episodes.jsonl``."""

import math
from typing import Annotated

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, PlainSerializer

from hypernav.core.episode import Outcome
from hypernav.evaluation.failures.classification import Failure

Length = Annotated[
    float,
    BeforeValidator(lambda value: math.inf if value is None else value),
    PlainSerializer(
        lambda value: value if math.isfinite(value) else None,
        return_type=float | None,
        when_used="json",
    ),
]
"""Metres; an infinite length is ``null`` in JSON, which knows no infinity."""

EpisodeKey = tuple[str, str]
"""Scene and episode: what no two lines of a run share."""


class EpisodeRecord(BaseModel):
    """What came of one episode. Everything but ``seconds`` is the same in every run of it.

    Attributes:
        scene_id: Where.
        episode_id: Unique within the scene.
        goal: What was to be found.
        group: Part of the data set that the episode belongs to ("unseen"); empty if there is none.
        outcome: How it ended.
        failure: Why it failed; None for a success.
        why: The rule that says so, in a sentence with this episode's numbers.
        success: Under the run's own protocol, as are `spl` and `soft_spl`.
        spl: Success weighted by path length.
        soft_spl: The same with progress in place of success.
        distance_to_goal_m: Geodesic, at the end, to the nearest view point.
        shortest_path_m: The same at the start.
        path_length_m: Summed displacement in space.
        stopped: Whether the robot said that it is there.
        steps: Actions taken.
        model_calls: Questions that were put to a model.
        questions: All questions by kind, those included that no model was needed for.
        tokens_in: Prompt tokens.
        tokens_out: Answer tokens.
        saved: Folder of the episode's page and video within the run's; empty if not kept.
        seconds: Wall-clock time: "total", "world" (the simulator) and by module of the agent.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    scene_id: str
    episode_id: str
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
    stopped: bool
    steps: int
    model_calls: int
    questions: dict[str, int] = Field(default_factory=dict)
    tokens_in: int = 0
    tokens_out: int = 0
    saved: str = ""
    seconds: dict[str, float] = Field(default_factory=dict)

    @property
    def key(self) -> EpisodeKey:
        """What no two lines of a run share."""
        return (self.scene_id, self.episode_id)

    @property
    def counts(self) -> bool:
        """Whether the episode says something about navigation."""
        return self.failure is None or not self.failure.is_apart
