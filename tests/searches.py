"""Whole searches in small worlds."""

from collections.abc import Callable

from hypernav.core.embodiment import Action
from hypernav.core.episode import Episode
from hypernav.core.observation import Observation
from hypernav.core.trace import StepTrace
from hypernav.search.agents.search import SearchAgent
from hypernav.simulator.worlds.simulation import SimulatedWorld


def searched(
    agent: SearchAgent,
    world: SimulatedWorld,
    episode: Episode,
    *,
    most_steps: int,
    sees: Callable[[Observation], Observation] = lambda one: one,
) -> list[StepTrace]:
    """The trace of a search without earlier memory, which may be cut short.

    Args:
        agent: Who searches.
        world: Where.
        episode: Start and goal.
        most_steps: Number of steps after which it is cut short.
        sees: What of the world's observation the agent is shown.
    """
    agent.reset(episode.goal)
    observation = world.reset(episode)
    trace = list[StepTrace]()
    while len(trace) < most_steps:
        action = agent.act(sees(observation))
        trace.append(agent.last_step)
        if action is None or action is Action.STOP:
            break
        observation = world.step(action)
    return trace
