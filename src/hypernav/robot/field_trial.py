"""One trial of a field study: a finished search of a robot, and what people measured beside it."""

import math
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import yaml
from pydantic import Field, ValidationError

from hypernav.core.config import RoomConfig
from hypernav.core.episode import EpisodeMetrics, measure
from hypernav.core.errors import RunFolderError
from hypernav.io.parsing import parse_yaml
from hypernav.io.reading import read_file, text_of
from hypernav.robot.server.searches.journal import Journal
from hypernav.robot.wire.frames import first_mistake, unpack_observation
from hypernav.robot.wire.replies import SearchEnding

TRIAL_FILE = "trial.yaml"
_MOST_BYTES = 10_000


class HandMeasures(RoomConfig):
    """What people measured, in the file ``trial.yaml`` of a search's folder.

    Attributes:
        shortest_m: Length of the shortest path from the start to the goal, metres.
        success: Whether the robot really stopped at the goal; None takes the robot's own claim.
        method: Name of the method in the table; None takes that of the agent.
        goal: Name of the goal in the table; None takes that of the search.
    """

    shortest_m: float = Field(gt=0.0, le=10_000.0)
    success: bool | None = None
    method: str | None = Field(default=None, min_length=1, max_length=60)
    goal: str | None = Field(default=None, min_length=1, max_length=60)


@dataclass(frozen=True)
class FieldTrial:
    """One trial.

    Attributes:
        folder: Folder of the search.
        goal: What was searched for.
        method: Agent that searched, or its name in the table.
        ending: How the search ended.
        metrics: Success, SPL and lengths; the path is that of the odometry.
    """

    folder: Path
    goal: str
    method: str
    ending: SearchEnding
    metrics: EpisodeMetrics

    @property
    def counts(self) -> bool:
        """Whether it says something about the method: outages and other failures do not."""
        return self.ending not in (
            SearchEnding.MODEL_UNAVAILABLE,
            SearchEnding.FAILED,
            SearchEnding.ROBOT_FAILED,
        )


def read_trial(folder: Path) -> FieldTrial:
    """Read a trial.

    Args:
        folder: Folder of a finished search in ``--state`` of `hypernav serve`, with `TRIAL_FILE`.

    Raises:
        RunFolderError: The folder holds no search, the search is not finished, or `TRIAL_FILE` is
            missing or wrong.
    """
    by_hand = _by_hand(folder / TRIAL_FILE)
    journal = Journal(folder, to_read=True)
    try:
        end, record = journal.end, journal.record
        if end is None:
            raise RunFolderError(f"{folder}: the search is not finished")
        positions = [
            unpack_observation(journal.observation(number)).header.base_to_odom
            for number in range(journal.observation_count)
        ]
    finally:
        journal.close()
    length_m = sum(math.dist((a.x, a.y), (b.x, b.y)) for a, b in pairwise(positions))
    found = end.ending is SearchEnding.FOUND
    success = found if by_hand.success is None else found and by_hand.success
    metrics = measure(
        stopped=found,
        distance_to_goal_m=0.0 if success else math.inf,
        shortest_path_m=by_hand.shortest_m,
        path_length_m=length_m,
        success_distance_m=1.0,
    )
    method = by_hand.method or record.specs.agent
    return FieldTrial(folder, by_hand.goal or record.request.goal, method, end.ending, metrics)


def _by_hand(path: Path) -> HandMeasures:
    try:
        text = text_of(read_file(path, most=_MOST_BYTES))
        return HandMeasures.model_validate(parse_yaml(text))
    except OSError as error:
        raise RunFolderError(
            f"{path}: {error.strerror}; write it beside the search: 'shortest_m: 7.4', the length "
            "of the shortest path to the goal in metres"
        ) from error
    except ValidationError as error:
        raise RunFolderError(f"{path}: {first_mistake(error)}") from error
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise RunFolderError(f"{path}: {error}") from error
