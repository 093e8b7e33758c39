"""The truth about a running episode, for components that stand in for a model of known quality."""

from collections.abc import Callable

import numpy as np

from hypernav.core.errors import TruthMissingError

PathLeft = Callable[[float, float], float]
"""True length of the shortest path, metres, from a position ``(x, y)`` in the ``map`` frame to the
goal; infinite if none leads there."""


class EpisodeTruth:
    """The truth about the running episode for stand-ins, which no real model ever gets.

    A component asks for it by a constructor parameter ``truth``; the code that runs an episode sets
    it (`hypernav.episodes.episode_run.EpisodeRun`). On a robot nothing does, so a stand-in can't
    work there.
    """

    def __init__(self) -> None:
        """Create it without any truth."""
        self.tell()

    def tell(
        self, *, rng: np.random.Generator | None = None, path_left_m: PathLeft | None = None
    ) -> None:
        """Replace everything by the truth about the next episode.

        Args:
            rng: Generator of this episode, not shared; None if there is none.
            path_left_m: Lengths of true paths to the goal; None if they are unknown.
        """
        self._rng = rng
        self._path_left_m = path_left_m

    @property
    def rng(self) -> np.random.Generator:
        """Generator for all random numbers of this episode.

        Raises:
            TruthMissingError: None was set.
        """
        if self._rng is None:
            raise TruthMissingError(_missing("a generator of random numbers"))
        return self._rng

    def path_left_m(self, x: float, y: float) -> float:
        """True length of the shortest path to the goal, metres; infinite if none leads there.

        Args:
            x: x of the position where the path begins, ``map`` frame, metres.
            y: y of the same position.

        Raises:
            TruthMissingError: It was not set.
        """
        if self._path_left_m is None:
            raise TruthMissingError(_missing("true paths to the goal"))
        return self._path_left_m(x, y)


def _missing(what: str) -> str:
    return (
        "a stand-in for a model (noisy, random) works only in a simulated world with ground truth: "
        f"it expected {what} for the episode and got none; choose a real model, or run the "
        "episode with `hypernav find`, `hypernav eval` or EpisodeRun(…, told=parts.truth, rng=…)"
    )
