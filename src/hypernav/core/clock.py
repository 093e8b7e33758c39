"""Time per module of one step."""

import time
from collections.abc import Iterator
from contextlib import contextmanager


class ModuleClock:
    """Adds up wall-clock seconds by name."""

    def __init__(self) -> None:
        """Begin with nothing measured."""
        self.seconds: dict[str, float] = {}

    @contextmanager
    def __call__(self, module: str) -> Iterator[None]:
        """Measure a block of code, also when it raises."""
        start = time.perf_counter()
        try:
            yield
        finally:
            elapsed = time.perf_counter() - start
            self.seconds[module] = self.seconds.get(module, 0.0) + elapsed
