"""A life: several goals, one after the other, in one building with one memory."""

from collections.abc import Iterable
from dataclasses import dataclass

from hypernav.core.episodes.episode import Episode


@dataclass(frozen=True)
class Life:
    """Several goals, one after the other, in one building with one memory.

    The first search begins at the start of its episode, each other one where the robot stands. An
    episode that belongs to no life is a life of one.

    Attributes:
        episodes: One episode for each goal, in their order.
    """

    episodes: tuple[Episode, ...]

    @property
    def scene_id(self) -> str:
        """Name of the building."""
        return self.episodes[0].scene_id

    @property
    def key(self) -> tuple[str, str]:
        """Scene and name: no two lives of a data set share them."""
        first = self.episodes[0]
        return (first.scene_id, first.life or first.episode_id)

    @property
    def max_steps(self) -> int:
        """Greatest number of steps of all searches together."""
        return self.episodes[0].max_life_steps or sum(one.max_steps for one in self.episodes)


def lives_of(episodes: Iterable[Episode]) -> list[Life]:
    """The lives that episodes belong to, in the order of their first episodes."""
    found: dict[tuple[str, str, str], list[Episode]] = {}
    for episode in episodes:
        alone = "" if episode.life else episode.episode_id
        found.setdefault((episode.scene_id, episode.life, alone), []).append(episode)
    return [Life(tuple(group)) for group in found.values()]
