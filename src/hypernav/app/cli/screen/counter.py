"""A line that says how far something long is, and whose clock shows that it goes on."""

import threading
import time

from rich.markup import escape

from hypernav.app.cli.screen.terminal import Terminal
from hypernav.app.show.captions import duration

_TICK_S = 0.5
_LINE_EVERY_S = 60.0


class Counter:
    """The line, from the start of a ``with`` block to its end.

    On a terminal it is drawn anew twice a second; into a file or pipe goes a line a minute.
    """

    def __init__(
        self, console: Terminal, text: str, *, line_every_s: float = _LINE_EVERY_S
    ) -> None:
        """Begin with a text.

        Args:
            console: The terminal.
            text: What it says at first.
            line_every_s: Time between two lines where there is no terminal, seconds.
        """
        self._console = console
        self._text = text
        self._every_s = _TICK_S if console.is_terminal else line_every_s
        self._status = console.status(escape(text)) if console.is_terminal else None
        self._began = time.monotonic()
        self._is_over = threading.Event()
        self._clock = threading.Thread(target=self._run, daemon=True)

    def __enter__(self) -> "Counter":
        """Show it."""
        if self._status is not None:
            self._status.start()
        self._clock.start()
        return self

    def __exit__(self, *error: object) -> None:
        """Take it away."""
        self._is_over.set()
        self._clock.join()
        if self._status is not None:
            self._status.stop()

    def update(self, text: str) -> None:
        """Say something else, from the next tick on."""
        self._text = text

    def _run(self) -> None:
        while not self._is_over.wait(self._every_s):
            line = f"{self._text} ({duration(time.monotonic() - self._began)})"
            if self._status is not None:
                self._status.update(escape(line))
            else:
                self._console.print(line, markup=False)
