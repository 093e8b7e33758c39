"""The loop of one episode: an agent, a world, and a referee with the ground truth."""

import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hypernav.core.components.abilities import BuiltForRobot, check_remembers, remembers
from hypernav.core.components.protocols import Agent, ExplainsItself
from hypernav.core.embodiment import Action
from hypernav.core.episode import Episode, EpisodeMetrics, EpisodeTruth, Outcome
from hypernav.core.errors import (
    ConfigError,
    MemoryStartError,
    ModelSetupError,
    ModelUnavailableError,
)
from hypernav.core.events import Event
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Transform
from hypernav.core.observation import Observation
from hypernav.core.trace import Ending, Mode, ModuleClock, StepTrace
from hypernav.core.world import World
from hypernav.lab.episodes.goal_sight import GoalSight, PathParts
from hypernav.lab.episodes.memory_frame import building_of, find_start, map_frame_of
from hypernav.lab.episodes.trial import Trial
from hypernav.lab.episodes.true_paths import true_paths
from hypernav.search.memory.memory import Memory
from hypernav.search.memory.start.relocalization import FoundStart
from hypernav.search.memory.store.memory_folder import MemoryFolder

if TYPE_CHECKING:
    from hypernav.lab.episodes.search_record import SearchRecord


@dataclass(frozen=True, eq=False)
class EpisodeStep:
    """One step, for views and recorders of the episode.

    Attributes:
        observation: The observation that the agent was given.
        trace: The action, with its reason if the agent gives one.
        grid: The agent's map; None if it has none.
        goal_in_view: Whether the observation shows the goal, as far as the truth is known.
    """

    observation: Observation
    trace: StepTrace
    grid: OccupancyGrid | None
    goal_in_view: bool = False


@dataclass(frozen=True)
class EpisodeResult:
    """The result of an episode.

    Attributes:
        outcome: How the episode ended.
        metrics: Success, SPL, SoftSPL and lengths.
        steps: Number of actions, STOP included.
        model_calls: Number of questions that a model was asked.
        seconds: Wall-clock time: "total", "world" (the simulator's share) and per module.
        detail: Why a model was not available, or why the robot had nowhere to go at the end; empty
            otherwise.
        parts: The path before and after the first sight of the goal; None if it was never in the
            image, or the world has no labels.
    """

    outcome: Outcome
    metrics: EpisodeMetrics
    steps: int
    model_calls: int
    seconds: dict[str, float]
    detail: str = ""
    parts: PathParts | None = None

    def measures(self) -> dict[str, Any]:
        """All measures by name: those of `EpisodeMetrics`, and of `PathParts` if there are any."""
        parts = {} if self.parts is None else asdict(self.parts)
        return asdict(self.metrics) | parts

    def as_dict(self) -> dict[str, Any]:
        """The result as ``result.json`` has it, with seconds to the millisecond."""
        return {
            "outcome": self.outcome.value,
            "detail": self.detail,
            "steps": self.steps,
            "model_calls": self.model_calls,
            **self.measures(),
            "seconds": {module: round(value, 3) for module, value in self.seconds.items()},
        }


class EpisodeRun:
    """One search by one agent, step by step, so that it can be watched, recorded and interrupted.

    `hypernav find` and evaluations run episodes by this loop. It also ends when a model is
    unavailable for longer than the patience: the steps up to then are kept, and the outcome says
    so.

    Attributes:
        trial: The state of the episode.
        described: What pages say about the search: ``agent``, ``detector``, ``reasoner``, …
        found_start: Where the robot took itself to be in a memory; None if it knew that. If that is
            not sure, the search begins anew, and the folder stays as it was.

    Examples:
        >>> run = EpisodeRun(agent, world, episode)  # doctest: +SKIP
        >>> for step in run:  # doctest: +SKIP
        ...     print(step.trace.reason)
        >>> run.result().outcome  # doctest: +SKIP
        <Outcome.FOUND: 'found'>
    """

    def __init__(
        self,
        agent: Agent,
        world: World,
        episode: Episode,
        *,
        rng: np.random.Generator | None = None,
        told: EpisodeTruth | None = None,
        goes_on: bool = False,
        memory: Memory | MemoryFolder | None = None,
        relocalize: bool = False,
    ) -> None:
        """Place the robot and give the agent its goal.

        Args:
            agent: The agent that searches.
            world: The world that the agent acts in.
            episode: Goal, start and limits.
            rng: Generator of the world's noise.
            told: Holder of the truth for stand-ins in the agent, if it has any
                (`hypernav.BuiltAgent.truth`); their generator is spawned from ``rng``.
            goes_on: Whether this search goes on with a life: the robot stays where it is, and an
                agent that `Remembers` keeps its memory.
            memory: What is known of the building, which the agent changes: a memory in the world's
                ``map`` frame, or an open folder, in whose frame the world then gives observations,
                and to which the search is saved.
            relocalize: Whether the robot doesn't know where it stands in the folder's memory, and
                finds out by a turn on the spot; for a simulated world.

        Raises:
            ConfigError: The agent was built for another robot, or keeps no memory.
            MemoryFolderError: The folder is the memory of another building.
            MemoryStartError: What the robot sees at the start contradicts the memory, and it knew
                where it stands.
            StartError: The robot cannot stand at the start.
            WorldError: The robot shall stay, and the world can't do that.
        """
        _check_robot(agent, world)
        self._agent = agent
        self._folder = memory if isinstance(memory, MemoryFolder) else None
        if memory is not None:
            check_remembers(agent)
        self.described: dict[str, Any] = {"agent": type(agent).__name__}
        self._began = time.perf_counter()
        self._clock = ModuleClock()
        self.found_start: FoundStart | None = None
        self._found_frame: Transform | None = None
        if relocalize and self._folder is not None and self._folder.place is not None:
            self._folder.check_building(building_of(episode))
            known = self._folder.memory
            self.found_start, self._found_frame = find_start(known, world, episode, rng)
            if self.found_start.doubt:
                self._folder = memory = None
        self.trial: Trial = self._placed(world, episode, rng, goes_on=goes_on)
        if self._folder is not None:
            truth = world.truth
            try:
                memory = self._folder.begin(
                    episode.goal,
                    self.trial.observation,
                    building="" if truth is None else building_of(episode),
                    map_to_scene=None if truth is None else truth.map_to_scene,
                )
            except MemoryStartError:
                if self.found_start is None:
                    raise
                self.found_start = replace(self.found_start, is_refused=True)
                self._folder = memory = None
                self.trial = self._placed(world, episode, rng, goes_on=goes_on)
        referee = self.trial.referee
        self._sight = None if referee is None else GoalSight(referee)
        self._model_calls = 0
        self._outage = ""
        self._nowhere_to_go = ""
        if told is not None:
            told.tell(
                rng=None if rng is None else rng.spawn(1)[0], path_left_m=true_paths(self.trial)
            )
        if memory is None and goes_on and remembers(agent):
            memory = agent.memory
        if memory is not None and remembers(agent):
            agent.reset(episode.goal, memory)
        else:
            agent.reset(episode.goal)

    def _placed(
        self, world: World, episode: Episode, rng: np.random.Generator | None, *, goes_on: bool
    ) -> Trial:
        with self._clock("world"), map_frame_of(self._folder, world, episode, self._found_frame):
            return Trial(world, episode, rng, goes_on=goes_on)

    def __iter__(self) -> Iterator[EpisodeStep]:
        """Run the episode to its end, one step at a time.

        Raises:
            ModelSetupError: A model cannot be asked until its URL, key or name is corrected.
            MemoryStartError: What the robot has seen since the start contradicts the memory, which
                stays as it was.
            OutputError: The memory can't be saved.
        """
        try:
            while not self.trial.is_over:
                try:
                    step = self._step()
                except ModelUnavailableError as error:
                    self._outage = str(error)
                    return
                except ModelSetupError as error:
                    self._outage = str(error)
                    raise
                if self._folder is not None:
                    self._folder.keep()
                yield step
        finally:
            if self._folder is not None:
                self._folder.end(self._ending_words, steps=self.trial.steps)

    def _step(self) -> EpisodeStep:
        observation = self.trial.observation
        if self._folder is not None and self.trial.steps > 0:
            self._folder.check(observation)
        goal_in_view = (
            self._sight is not None
            and observation.truth is not None
            and self._sight.watch(observation.truth)
        )
        action = self._agent.act(observation)
        trace, grid = self._explanation(observation, action)
        is_stuck = trace.ending is Ending.GAVE_UP or Event.NOWHERE_TO_GO in trace.events
        self._nowhere_to_go = trace.reason if is_stuck else ""
        self._model_calls += sum(exchange.by_model for exchange in trace.exchanges)
        for module, seconds in trace.seconds.items():
            self._clock.seconds[module] = self._clock.seconds.get(module, 0.0) + seconds
        with self._clock("world"):
            self.trial.take(action)
        return EpisodeStep(observation, trace, grid, goal_in_view)

    def _explanation(
        self, observation: Observation, action: Action | None
    ) -> tuple[StepTrace, OccupancyGrid | None]:
        if isinstance(self._agent, ExplainsItself):
            return self._agent.last_step, self._agent.grid
        robot = observation.robot
        mode = Mode.STOP if action in (Action.STOP, None) else Mode.EXPLORE
        return StepTrace(
            step=self.trial.steps,
            pose=(robot.x, robot.y, robot.yaw),
            z=self.trial.world.embodiment.camera.base_z(observation.camera_to_map),
            action=action,
            mode=mode,
            ending=Ending.of(action),
        ), None

    def record(self, folder: str | Path | None = None) -> "SearchRecord":
        """Run the search to its end, and keep its film, maps and page.

        Args:
            folder: Folder of the files; None takes a temporary one that goes with the record.

        Returns:
            The record, which shows itself in a notebook.

        Raises:
            ConfigError: The search has begun already.
            MemoryStartError: See `__iter__`.
            ModelSetupError: See `__iter__`.
            OutputError: The files can't be written.
        """
        from hypernav.lab.episodes.search_record import record  # which imports this module

        return record(self, folder)

    def result(self, *, interrupted: bool = False) -> EpisodeResult:
        """The result of the episode so far.

        Args:
            interrupted: Whether the program was stopped before the episode ended.

        Raises:
            WorldError: The world has no ground truth to measure by.
        """
        metrics = self.trial.measure()
        outcome = Outcome.INTERRUPTED if interrupted else self._outcome(metrics)
        nowhere_to_go = self._nowhere_to_go if outcome is Outcome.NOT_FOUND else ""
        return EpisodeResult(
            outcome=outcome,
            metrics=metrics,
            steps=self.trial.steps,
            model_calls=self._model_calls,
            seconds={"total": time.perf_counter() - self._began, **self._clock.seconds},
            detail=self._outage or nowhere_to_go,
            parts=None if self._sight is None else self._sight.parts,
        )

    @property
    def _ending_words(self) -> str:
        """How the search ended as far as the robot knows, for the history of a memory."""
        if self._outage:
            return Outcome.MODEL_UNAVAILABLE.value
        if not self.trial.is_over:
            return Outcome.INTERRUPTED.value
        is_found = self.trial.ending is Ending.FOUND
        return (Outcome.FOUND if is_found else Outcome.NOT_FOUND).value

    def _outcome(self, metrics: EpisodeMetrics) -> Outcome:
        if self._outage:
            return Outcome.MODEL_UNAVAILABLE
        if metrics.success:
            return Outcome.FOUND
        if self.trial.ending is Ending.FOUND:
            return Outcome.WRONG_PLACE
        if self.trial.holds_goal and not np.isfinite(metrics.shortest_path_m):
            return Outcome.UNREACHABLE
        return Outcome.NOT_FOUND


def _check_robot(agent: Agent, world: World) -> None:
    """Refuse to let an agent drive a robot that it was not built for."""
    if not isinstance(agent, BuiltForRobot) or agent.embodiment == world.embodiment:
        return
    built_for, found = agent.embodiment.model_dump(), world.embodiment.model_dump()
    differences = [
        f"{part}.{name} {value} instead of {found[part][name]}"
        for part, values in built_for.items()
        for name, value in values.items()
        if value != found[part][name]
    ]
    raise ConfigError(
        f"the agent was built for another robot than this world has: {', '.join(differences)}; "
        "build both from one embodiment"
    )
