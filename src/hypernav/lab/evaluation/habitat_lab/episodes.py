"""Order and categories of episodes, as in habitat-lab.

Source: habitat-lab, ``habitat/core/dataset.py`` (``EpisodeIterator``).
"""

import random
from collections.abc import Iterable, Iterator

from hypernav.core.episode import Episode


def passes(episodes: Iterable[Episode], *, shuffle: bool, seed: int) -> Iterator[list[Episode]]:
    """The orders of endless passes through all episodes; those of a scene stay together.

    Args:
        episodes: The episodes in the data set's order.
        shuffle: Whether each pass has an order of its own.
        seed: Seed of these orders.
    """
    # habitat-lab shuffles with Python's generator too, so the same seed gives the same order.
    rng = random.Random(seed)
    order = list(episodes)
    while True:
        if shuffle:
            rng.shuffle(order)
        scenes: dict[str, list[Episode]] = {}
        for episode in order:
            scenes.setdefault(episode.scene_id, []).append(episode)
        order = [episode for group in scenes.values() for episode in group]
        yield list(order)


def category_of(episode: Episode) -> str:
    """The category that an episode asks for."""
    return episode.object_category or episode.goal.text


def category_numbers(episodes: Iterable[Episode]) -> dict[str, int]:
    """The data set's numbers of categories; without any, their numbers in alphabetical order.

    Args:
        episodes: All episodes of the environment.
    """
    episodes = list(episodes)
    asked = {category_of(episode) for episode in episodes}
    numbers = {name: n for episode in episodes for name, n in episode.category_ids.items()}
    if asked <= set(numbers):
        return numbers
    return {name: number for number, name in enumerate(sorted(asked))}
