"""A search in one call: an agent looks for a goal in a simulated building."""

from typing import Any

import numpy as np

from hypernav.app.build.agents import build_agent
from hypernav.app.build.built_agent import BuiltAgent
from hypernav.app.build.our_worlds import in_our_own
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.app.build.worlds import open_world
from hypernav.core.components.door import through_door
from hypernav.core.components.protocols import Agent
from hypernav.core.config import MOST_SEED, MOST_STEPS, check_option
from hypernav.core.episode import MAX_STEPS, Episode
from hypernav.core.errors import ConfigError, GoalError
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.world import Simulator
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.search.memory.memory import Memory
from hypernav.search.memory.store.memory_folder import MemoryFolder
from hypernav.simulator.worlds.scenes.scene import Scene


def find(
    goal: Goal | str,
    scene: Scene | Simulator | str = "builtin",
    *,
    agent: Agent | BuiltAgent | None = None,
    config: HyPerNavConfig | None = None,
    start: Pose2 | None = None,
    seed: int = 0,
    max_steps: int = MAX_STEPS,
    memory: MemoryFolder | Memory | None = None,
    relocalize: bool = False,
) -> EpisodeRun:
    """Begin a search, like ``hypernav find``; iterating over it runs the steps.

    Args:
        goal: What to find.
        scene: A loaded scene, its name as `load_scene` understands it, or a world of your own.
        agent: Agent that searches; by default the one of this package, built from ``config``. An
            agent of your own must be built for the robot of ``config``.
        config: Values of the method, the robot and its simulation; the preset ``default`` unless
            given.
        start: Start pose, scene frame; by default a random one from which the goal can be reached.
        seed: Seed of the random start and of the world's noise.
        max_steps: Step limit; STOP counts as a step.
        memory: What is known of the building and gets what the search learns: a folder from
            `open_memory`, or, where the robot has not been moved, the ``memory`` that an agent left
            behind.
        relocalize: Whether the robot doesn't know where it stands in the folder's memory, and finds
            out by a turn on the spot; `EpisodeRun.found_start` says what it found.

    Returns:
        The search, placed at its start.

    Raises:
        GoalError: The goal names nothing, or the agent's detector can never see it.
        SceneError: The scene cannot be used, or the robot fits nowhere in it.
        StartError: The robot cannot stand at the start.
        ConfigError: The agent was built for another robot, or a value is impossible.
        ContractError: The agent is none.
        MemoryFolderError: The memory is that of another building.
        MemoryStartError: What the robot sees at the start contradicts the memory.

    Examples:
        >>> search = find("bed")  # doctest: +SKIP
        >>> for step in search:  # doctest: +SKIP
        ...     print(step.trace.reason)
        >>> search.result().outcome  # doctest: +SKIP
        <Outcome.FOUND: 'found'>
    """
    goal = Goal(goal) if isinstance(goal, str) else goal
    if not isinstance(goal, Goal):
        raise GoalError(f"the goal is {goal!r:.60}, expected a text such as 'bed', or a Goal")
    config = HyPerNavConfig() if config is None else config
    if not isinstance(config, HyPerNavConfig):
        raise ConfigError(f"config is {config!r:.60}, expected a HyPerNavConfig")
    check_option("max_steps", max_steps, (1, MOST_STEPS), "steps of a search")
    check_option("seed", seed, (0, MOST_SEED), "a whole number")
    agent = build_agent(config.for_steps(max_steps)) if agent is None else agent
    truth, words = None, dict[str, Any]()
    if isinstance(agent, BuiltAgent):
        agent.check_goal(goal)
        words = {
            "agent": agent.chosen.agent.spec,
            "detector": agent.detector_words,
            "reasoner": agent.reasoner_words,
            "segmenter": agent.segmenter.words,
            "model": agent.model_words,
        }
        agent, truth = agent.agent, agent.truth
    agent = through_door(agent, Agent)
    if isinstance(scene, Simulator):
        world, name = scene, scene.truth.name
    elif isinstance(scene, Scene):
        world, name = in_our_own(scene, config), scene.name
    else:
        world, name = open_world(scene, config), scene
    rng = np.random.default_rng(seed)
    start = start or world.truth.random_start(rng, goal)
    episode = Episode(name, "", goal, start, max_steps=max_steps)
    search = EpisodeRun(
        agent, world, episode, rng=rng, told=truth, memory=memory, relocalize=relocalize
    )
    search.described |= words | {"seed": seed, "config": config.model_dump(mode="json")}
    return search
