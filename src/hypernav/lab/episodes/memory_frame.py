"""A world in the ``map`` frame of a memory, for an episode in the same building.

A simulated robot that doesn't know its start turns once around and looks where it is.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from hypernav.core.embodiment import Action
from hypernav.core.episode import Episode
from hypernav.core.errors import ConfigError
from hypernav.core.geometry.transforms import Transform
from hypernav.core.world import KeepsMapFrame, World
from hypernav.search.memory.memory import Memory
from hypernav.search.memory.start.relocalization import FoundStart, found_by_turn
from hypernav.search.memory.store.memory_folder import MemoryFolder


def building_of(episode: Episode) -> str:
    """Name of an episode's building in a memory: of a file its name and that of its folder."""
    path = Path(episode.scene_id)
    return "/".join(path.resolve().parts[-2:]) if path.is_file() else episode.scene_id


@contextmanager
def map_frame_of(
    folder: MemoryFolder | None, world: World, episode: Episode, found: Transform | None
) -> Iterator[None]:
    """Let a world that is reset in the block begin in a memory's ``map`` frame, as far as known."""
    if folder is None or folder.place is None:
        yield
        return
    folder.check_building(building_of(episode))
    if not isinstance(world, KeepsMapFrame):
        raise ConfigError(
            f"{type(world).__name__} begins a map frame at every start; a memory needs a world "
            "with keep_map_frame"
        )
    world.keep_map_frame(folder.place.map_to_scene if found is None else found)
    try:
        yield
    finally:
        world.keep_map_frame(None)


def find_start(
    memory: Memory, world: World, episode: Episode, rng: np.random.Generator | None
) -> tuple[FoundStart, Transform]:
    """Let a robot turn once around at the start of an episode and find out where it is.

    It uses only what it sees, in a frame that begins where it stands. Afterwards the world is to be
    reset.

    Args:
        memory: What is known of the building; it is not changed.
        world: The simulated world.
        episode: Start of the robot.
        rng: Generator of the world's noise.

    Returns:
        Where it takes itself to be, and the memory's ``map`` frame in the scene if that is right;
        without a place, the robot's own frame.

    Raises:
        ConfigError: The world is not simulated.
        StartError: The robot cannot stand at the start.
    """
    frames = [world.reset(episode, rng)]
    if world.truth is None:
        raise ConfigError(
            f"{type(world).__name__} is not simulated; a robot finds its start with hypernav serve "
            "--relocalize"
        )
    own_to_scene = world.truth.map_to_scene
    turns = world.embodiment.motion.turns_of_a_circle - 1
    frames += [world.step(Action.TURN_LEFT) for _ in range(turns)]
    found = found_by_turn(memory, frames)
    if found.place is None:
        return found, own_to_scene
    return found, own_to_scene @ found.place.own_to_map.inverse()
