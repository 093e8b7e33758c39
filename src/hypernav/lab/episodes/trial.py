"""The state of one episode while it runs, independent of who chooses the actions."""

import numpy as np

from hypernav.core.embodiment import Action
from hypernav.core.episode import Episode, EpisodeMetrics
from hypernav.core.errors import WorldError
from hypernav.core.observation import Observation
from hypernav.core.trace import Ending
from hypernav.core.world import GoesOn, World
from hypernav.lab.episodes.referee import Referee


class Trial:
    """The state of one episode: its steps, its ending, and its measures if the truth is known.

    Attributes:
        world: The world that the episode takes place in.
        episode: Goal, start and limits.
        observation: The latest observation.
        referee: Referee that measures the episode; None in a world without ground truth.
        steps: Number of actions so far; STOP and giving up count.
        ending: Claim of the agent at the end; None before, and if the steps ran out.
    """

    def __init__(
        self,
        world: World,
        episode: Episode,
        rng: np.random.Generator | None = None,
        *,
        goes_on: bool = False,
    ) -> None:
        """Place the robot.

        Args:
            world: The world that the episode takes place in.
            episode: Goal, start and limits.
            rng: Generator of the world's noise.
            goes_on: Whether the robot stays where it is, with its map frame, as in a life.

        Raises:
            StartError: The robot cannot stand at the start.
            WorldError: The robot shall stay, and the world can't do that.
        """
        self.world = world
        self.episode = episode
        self.observation: Observation = (
            _stays(world, episode) if goes_on else world.reset(episode, rng)
        )
        self.referee: Referee | None = _referee_of(world, episode)
        self.steps: int = 0
        self.ending: Ending | None = None

    @property
    def is_over(self) -> bool:
        """Whether the episode takes no further action."""
        out_of_steps = self.steps >= self.episode.max_steps
        return self.ending is not None or out_of_steps or self.world.is_over

    @property
    def holds_goal(self) -> bool:
        """Whether the scene or the data set holds something that satisfies the goal."""
        goal = None if self.referee is None else self.referee.goal
        return goal is not None and (len(goal.instances) > 0 or len(goal.view_points) > 0)

    def take(self, action: Action | None) -> Observation:
        """Take an action and observe.

        Args:
            action: The action; STOP claims that the goal is here, None gives up.

        Returns:
            The new observation; after giving up the latest one.

        Raises:
            WorldError: The episode is over.
        """
        if self.is_over:
            raise WorldError("the episode is over; begin another one")
        self.steps += 1
        self.ending = Ending.of(action)
        if action is not None:
            self.observation = self.world.step(action)
        if self.referee is not None and self.world.truth is not None:
            self.referee.watch(self.world.truth.position)
        return self.observation

    def measure(self) -> EpisodeMetrics:
        """The measures so far.

        Raises:
            WorldError: The world has no ground truth to measure by.
        """
        if self.referee is None:
            raise WorldError(
                "nothing can be measured: this world has no ground truth about its scene; use "
                "ending instead, the agent's claim"
            )
        return self.referee.measure(
            stopped=self.ending is Ending.FOUND, success_distance_m=self.episode.success_distance_m
        )


def _stays(world: World, episode: Episode) -> Observation:
    if not isinstance(world, GoesOn):
        raise WorldError(
            f"{type(world).__name__} has no go_on, which begins another search where the robot "
            "stands; run each goal by itself"
        )
    return world.go_on(episode)


def _referee_of(world: World, episode: Episode) -> Referee | None:
    if world.truth is None:
        return None
    truth = world.truth.goal_truth(episode.goal, episode.view_points)
    return Referee(truth, world.truth.position)
