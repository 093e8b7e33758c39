"""A start that a robot doesn't know: it turns once around and looks where it is in its memory."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from hypernav.core.actions import Action
from hypernav.core.episodes.episode import Episode
from hypernav.core.errors import ConfigError
from hypernav.core.geometry.transforms import Transform
from hypernav.core.world import World
from hypernav.mapping.memory.memory import Memory
from hypernav.mapping.memory.relocalization import Relocalization, relocalized


@dataclass(frozen=True)
class FoundStart:
    """Where a robot took itself to be in its memory.

    Attributes:
        place: The likeliest place; None if there was nothing to compare.
        map_to_scene: The memory's ``map`` frame in the scene, if that place is right.
        turns: Number of turns that it took to look around; they are no steps of the search.
        is_refused: Whether what it sees contradicts the map at that place.
    """

    place: Relocalization | None
    map_to_scene: Transform
    turns: int
    is_refused: bool = False

    @property
    def doubt(self) -> str:
        """The reason why the place may be wrong, for people; empty if it is sure."""
        if self.place is None:
            return "there is no obstacle to compare"
        if self.is_refused:
            return "what the robot sees contradicts the map at the likeliest place"
        return self.place.doubt

    def as_dict(self) -> dict[str, Any]:
        """Values for ``result.json``; floors count from 1."""
        place = self.place
        known = (
            {}
            if place is None
            else {
                "floor": place.floor + 1,
                "evidence": round(place.evidence, 3),
                "rival": round(place.rival, 3),
            }
        )
        return {"sure": not self.doubt, "doubt": self.doubt, "turns": self.turns, **known}


def find_start(
    memory: Memory, world: World, episode: Episode, rng: np.random.Generator | None
) -> FoundStart:
    """Let a robot turn once around at the start of an episode and find out where it is.

    It uses only what it sees, in a frame that begins where it stands. Afterwards the world is to be
    reset.

    Args:
        memory: What is known of the building; it is not changed.
        world: The simulated world.
        episode: Start of the robot.
        rng: Generator of the world's noise.

    Raises:
        ConfigError: The world is not simulated.
        StartError: The robot cannot stand at the start.
    """
    frames = [world.reset(episode, rng)]
    if world.truth is None:
        raise ConfigError(
            f"{type(world).__name__} is not simulated: on a robot, poses must be in the memory's "
            "map frame"
        )
    own_to_scene = world.truth.map_to_scene
    turns = world.embodiment.motion.turns_of_a_circle - 1
    frames += [world.step(Action.TURN_LEFT) for _ in range(turns)]
    place = relocalized(memory, frames)
    if place is None:
        return FoundStart(None, own_to_scene, turns)
    return FoundStart(place, own_to_scene @ place.own_to_map.inverse(), turns)
