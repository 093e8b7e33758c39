"""The assignment of lives to workers, with as few loads of scenes as possible."""

from collections import Counter, deque
from collections.abc import Iterable

from hypernav.core.episode import Life

ATTEMPTS = 3
"""Number of lost workers after which a life is not tried again."""


class Schedule:
    """Assigns every life once, and the life of a lost worker again.

    A worker keeps to its scene as long as that has lives left. Then it takes the scene with most
    lives among those without a worker, or, if there is none, among all.
    """

    def __init__(self, lives: Iterable[Life]) -> None:
        """Take the lives to run."""
        self._waiting: dict[str, deque[Life]] = {}
        for life in lives:
            self._waiting.setdefault(life.scene_id, deque()).append(life)
        self._scene_of: dict[int, str] = {}
        self._running: dict[int, Life] = {}
        self._losses: Counter[tuple[str, str]] = Counter()

    @property
    def left(self) -> int:
        """Number of unfinished lives, those in flight included."""
        return sum(len(queue) for queue in self._waiting.values()) + len(self._running)

    @property
    def is_finished(self) -> bool:
        """Whether all lives are done."""
        return self.left == 0

    @property
    def has_waiting(self) -> bool:
        """Whether some lives wait for a worker."""
        return any(self._waiting.values())

    def next_for(self, worker: int) -> Life | None:
        """The next life for an idle worker; None if none waits (others may be in flight)."""
        scene = self._scene_for(worker)
        if scene is None:
            return None
        self._scene_of[worker] = scene
        self._running[worker] = self._waiting[scene].popleft()
        return self._running[worker]

    def is_running(self, worker: int) -> bool:
        """Whether a worker has a life in flight."""
        return worker in self._running

    def done(self, worker: int) -> Life:
        """Mark the life of a worker as done, and return it."""
        return self._running.pop(worker)

    def lost(self, worker: int) -> Life | None:
        """Mark a worker as lost.

        Returns:
            Its life if that is not tried again; None if it is, or if the worker was idle.
        """
        self._scene_of.pop(worker, None)
        life = self._running.pop(worker, None)
        if life is None:
            return None
        self._losses[life.key] += 1
        if self._losses[life.key] >= ATTEMPTS:
            return life
        self._waiting[life.scene_id].appendleft(life)
        return None

    def _scene_for(self, worker: int) -> str | None:
        own = self._scene_of.get(worker)
        if own is not None and self._waiting[own]:
            return own
        taken = {scene for other, scene in self._scene_of.items() if other != worker}
        waiting = {scene: len(queue) for scene, queue in self._waiting.items() if queue}
        free = {scene: count for scene, count in waiting.items() if scene not in taken}
        candidates = free or waiting
        # Ties go to the first in the data set, so that the result is deterministic.
        return max(candidates, key=lambda scene: candidates[scene]) if candidates else None
