"""A thread beside a ``with`` block."""

import threading
from abc import ABC, abstractmethod


class SideThread(ABC):
    """Does its work in a thread of its own while a ``with`` block runs, and ends with it.

    The block may wait for the network, or hang; the thread goes on.
    """

    def __enter__(self) -> None:
        """Start the thread."""
        self._block_ended = threading.Event()
        self._thread = threading.Thread(
            target=self._work_until, args=(self._block_ended,), daemon=True
        )
        self._thread.start()

    def __exit__(self, *error: object) -> None:
        """Wait until the work has ended."""
        self._block_ended.set()
        self._thread.join()

    @abstractmethod
    def _work_until(self, block_ended: threading.Event) -> None:
        """Do the work; return soon after the block has ended."""
