"""Which worker runs which episode next, so that scenes are loaded as seldom as possible."""

from collections import Counter, deque
from collections.abc import Iterable

from hypernav.core.episode import Episode
from hypernav.evaluation.record import EpisodeKey

ATTEMPTS = 3
"""An episode whose worker was lost this often is not tried again."""


class Schedule:
    """Hands out every episode once; those of a lost worker again.

    A worker keeps to its scene as long as that has episodes left. Then it takes the scene that
    nobody works in with most episodes, and when there is none, it joins where most are left.
    """

    def __init__(self, episodes: Iterable[Episode]) -> None:
        """Take what has to be done."""
        self._waiting: dict[str, deque[Episode]] = {}
        for episode in episodes:
            self._waiting.setdefault(episode.scene_id, deque()).append(episode)
        self._scene_of: dict[int, str] = {}
        self._running: dict[int, Episode] = {}
        self._losses: Counter[EpisodeKey] = Counter()

    @property
    def left(self) -> int:
        """Episodes that are not done, those in flight included."""
        return sum(len(queue) for queue in self._waiting.values()) + len(self._running)

    @property
    def is_finished(self) -> bool:
        """Whether nothing is left."""
        return self.left == 0

    @property
    def has_waiting(self) -> bool:
        """Whether some are not in flight."""
        return any(self._waiting.values())

    def next_for(self, worker: int) -> Episode | None:
        """What an idle worker shall run; None if nothing waits (others may still be running)."""
        scene = self._scene_for(worker)
        if scene is None:
            return None
        self._scene_of[worker] = scene
        self._running[worker] = self._waiting[scene].popleft()
        return self._running[worker]

    def is_running(self, worker: int) -> bool:
        """Whether a worker has an episode in hand."""
        return worker in self._running

    def done(self, worker: int) -> Episode:
        """Note that a worker has finished its episode."""
        return self._running.pop(worker)

    def lost(self, worker: int) -> Episode | None:
        """Note that a worker is gone.

        Returns:
            Its episode if that has been tried often enough; None if it will be tried again, or if
            the worker was idle.
        """
        self._scene_of.pop(worker, None)
        episode = self._running.pop(worker, None)
        if episode is None:
            return None
        self._losses[episode.key] += 1
        if self._losses[episode.key] >= ATTEMPTS:
            return episode
        self._waiting[episode.scene_id].appendleft(episode)
        return None

    def _scene_for(self, worker: int) -> str | None:
        own = self._scene_of.get(worker)
        if own is not None and self._waiting[own]:
            return own
        taken = {scene for other, scene in self._scene_of.items() if other != worker}
        waiting = {scene: len(queue) for scene, queue in self._waiting.items() if queue}
        free = {scene: count for scene, count in waiting.items() if scene not in taken}
        candidates = free or waiting
        # Of equally long ones the first of the data set, so that chance plays no part.
        return max(candidates, key=lambda scene: candidates[scene]) if candidates else None
