"""Running one episode: an agent, a world, and a referee who knows the truth."""

import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from hypernav.core.actions import Action
from hypernav.core.clock import ModuleClock
from hypernav.core.errors import ModelUnavailableError
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.metrics import EpisodeMetrics
from hypernav.core.observation import Observation
from hypernav.core.protocols import Agent, ExplainsItself
from hypernav.core.trace import Ending, Mode, StepTrace
from hypernav.evaluation.outcome import Outcome
from hypernav.worlds.referee import Referee
from hypernav.worlds.simulation import SimulatedWorld


@dataclass(frozen=True, eq=False)
class EpisodeStep:
    """One step as a watcher sees it.

    Attributes:
        observation: What the agent saw.
        trace: What it did, and why if it explains itself.
        grid: Its map, if it has one.
    """

    observation: Observation
    trace: StepTrace
    grid: OccupancyGrid | None


@dataclass(frozen=True)
class EpisodeResult:
    """What came of an episode.

    Attributes:
        outcome: How it ended.
        metrics: How well it went.
        steps: Actions taken, STOP included.
        model_calls: Questions that were put to a model.
        seconds: Wall-clock time: "total", "world" (the simulator's share) and per module.
        detail: Why a model was not available; empty otherwise.
    """

    outcome: Outcome
    metrics: EpisodeMetrics
    steps: int
    model_calls: int
    seconds: dict[str, float]
    detail: str = ""


class EpisodeRun:
    """One search, step by step, so that it can be watched, recorded and interrupted.

    It also ends when a model stays away longer than the configured patience: the steps up to then
    stand, and the outcome says so.

    Example:
        >>> episode = Episode(agent, world, Goal("bed"), start)  # doctest: +SKIP
        >>> for step in episode:  # doctest: +SKIP
        ...     print(step.trace.reason)
        >>> episode.result().outcome  # doctest: +SKIP
        <Outcome.FOUND: 'found'>
    """

    def __init__(
        self,
        agent: Agent,
        world: SimulatedWorld,
        goal: Goal,
        start: Pose2,
        *,
        rng: np.random.Generator | None = None,
        max_steps: int = 500,
        success_distance_m: float = 0.1,
    ) -> None:
        """Place the robot and tell the agent what to find.

        Args:
            agent: Who searches.
            world: Where.
            goal: What.
            start: From where, scene frame.
            rng: Source of the world's noise.
            max_steps: Step limit; STOP counts as a step.
            success_distance_m: How near to a view point (geodesic) counts.

        Raises:
            StartError: The robot cannot stand at the start.
        """
        self._agent = agent
        self._world = world
        self._max_steps = max_steps
        self._success_distance_m = success_distance_m
        self._began = time.perf_counter()
        self._clock = ModuleClock()
        with self._clock("world"):
            self._observation = world.reset(start, rng)
            self._referee = Referee(world.regions.of(goal), world.position)
        self._steps = 0
        self._model_calls = 0
        self._gave_up = False
        self._outage = ""
        agent.reset(goal)

    @property
    def shortest_path_m(self) -> float:
        """Geodesic distance from the start to the goal; infinite if there is no way."""
        return self._referee.shortest_path_m

    def __iter__(self) -> Iterator[EpisodeStep]:
        """Run to the end, one step at a time."""
        while self._steps < self._max_steps and not self._world.stopped and not self._gave_up:
            try:
                step = self._step()
            except ModelUnavailableError as error:
                self._outage = str(error)
                return
            yield step

    def _step(self) -> EpisodeStep:
        observation = self._observation
        action = self._agent.act(observation)
        trace, grid = self._explanation(observation, action)
        self._steps += 1
        self._model_calls += sum(exchange.by_model for exchange in trace.exchanges)
        for module, seconds in trace.seconds.items():
            self._clock.seconds[module] = self._clock.seconds.get(module, 0.0) + seconds
        self._gave_up = action is None
        if action is not None:
            with self._clock("world"):
                self._observation = self._world.step(action)
                self._referee.watch(self._world.position)
        return EpisodeStep(observation, trace, grid)

    def _explanation(
        self, observation: Observation, action: Action | None
    ) -> tuple[StepTrace, OccupancyGrid | None]:
        if isinstance(self._agent, ExplainsItself):
            return self._agent.last_step, self._agent.grid
        robot = observation.robot
        mode = Mode.STOP if action in (Action.STOP, None) else Mode.EXPLORE
        pose = (robot.x, robot.y, robot.yaw)
        ending = {Action.STOP: Ending.FOUND, None: Ending.GAVE_UP}.get(action)
        return StepTrace(step=self._steps, pose=pose, action=action, mode=mode, ending=ending), None

    def result(self, *, interrupted: bool = False) -> EpisodeResult:
        """What came of the episode so far.

        Args:
            interrupted: Somebody stopped the program before the episode ended.
        """
        metrics = self._referee.measure(
            stopped=self._world.stopped, success_distance_m=self._success_distance_m
        )
        return EpisodeResult(
            outcome=Outcome.INTERRUPTED if interrupted else self._outcome(metrics),
            metrics=metrics,
            steps=self._steps,
            model_calls=self._model_calls,
            seconds={"total": time.perf_counter() - self._began, **self._clock.seconds},
            detail=self._outage,
        )

    def _outcome(self, metrics: EpisodeMetrics) -> Outcome:
        if self._outage:
            return Outcome.MODEL_UNAVAILABLE
        if metrics.success:
            return Outcome.FOUND
        if self._world.stopped:
            return Outcome.WRONG_PLACE
        region = self._referee.region
        if region.instances and not np.isfinite(metrics.shortest_path_m):
            return Outcome.UNREACHABLE
        return Outcome.NOT_FOUND
