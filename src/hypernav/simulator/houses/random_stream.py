"""Random numbers that are the same on every machine and with every version of NumPy.

NumPy guarantees that the bit stream of a bit generator never changes, but not the results of
``Generator.choice`` and the other methods. Houses must stay the same for years, so every draw here
is computed from the raw stream with arithmetic that IEEE 754 defines exactly.
"""

from collections.abc import Sequence
from typing import TypeVar
from zlib import crc32

import numpy as np
from jaxtyping import Float64

_T = TypeVar("_T")
_TO_UNIT = 2.0**-53


class RandomStream:
    """A stream of random numbers, seeded by numbers and words.

    Args:
        key: Seed of the stream, such as ``(1234, "layout")``. Equal keys give equal
            streams, so a word that is part of a key must never change.
    """

    def __init__(self, *key: int | str) -> None:
        """Seed the stream."""
        words = [k if isinstance(k, int) else crc32(k.encode()) for k in key]
        self._key = key
        self._bits = np.random.PCG64(np.random.SeedSequence(words))

    def fork(self, *name: int | str) -> "RandomStream":
        """Independent stream, seeded by this stream's key and a name, not by its earlier draws."""
        return RandomStream(*self._key, *name)

    def unit(self) -> float:
        """Uniform number in [0, 1)."""
        return int(self._bits.random_raw() >> 11) * _TO_UNIT

    def uniform(self, low: float, high: float, step: float = 0.0) -> float:
        """Uniform number between two bounds; with a step, whole steps above ``low``."""
        value = low + (high - low) * self.unit()
        return low + round((value - low) / step) * step if step else value

    def integer(self, low: int, high: int) -> int:
        """Uniform integer between two bounds, both included."""
        return low + int(self.unit() * (high - low + 1))

    def chance(self, probability: float) -> bool:
        """Whether an event of this probability happens."""
        return self.unit() < probability

    def choice(self, options: Sequence[_T]) -> _T:
        """One of the options, all equally likely."""
        return options[int(self.unit() * len(options))]

    def weighted(self, options: Sequence[tuple[_T, float]]) -> _T:
        """One of the options, with probabilities in proportion to the weights."""
        left = self.unit() * sum(weight for _, weight in options)
        for option, weight in options:
            left -= weight
            if left < 0.0:
                return option
        return options[-1][0]

    def shuffled(self, options: Sequence[_T]) -> list[_T]:
        """All options in random order."""
        result = list(options)
        for i in range(len(result) - 1, 0, -1):
            j = self.integer(0, i)
            result[i], result[j] = result[j], result[i]
        return result

    def array(self, *shape: int) -> Float64[np.ndarray, "..."]:
        """Array of uniform numbers in [0, 1)."""
        count = int(np.prod(shape))
        return ((self._bits.random_raw(count) >> np.uint64(11)) * _TO_UNIT).reshape(shape)

    def near(self, middle: float, spread: float) -> float:
        """Bell-shaped random number, never farther from the middle than three times the spread."""
        return middle + spread * (self.unit() + self.unit() + self.unit() - 1.5) * 2.0
