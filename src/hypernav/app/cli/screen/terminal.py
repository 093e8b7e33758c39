"""The terminal, on which text from outside cannot act as control characters."""

import os
from collections.abc import Iterable
from typing import IO, Any

from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment

from hypernav.core.errors import OutputError
from hypernav.core.naming.words import visible


class Terminal(Console):
    """A console that shows control characters of any text, table or log instead of sending them.

    Numbers and paths are not coloured.
    """

    def __init__(
        self, *, stderr: bool = True, quiet: bool = False, soft_wrap: bool = False
    ) -> None:
        """Open the terminal.

        Args:
            stderr: Whether to write to standard error, as everything but a result does.
            quiet: Whether to write nothing.
            soft_wrap: Whether to leave the wrapping of long lines to the terminal.
        """
        super().__init__(stderr=stderr, quiet=quiet, soft_wrap=soft_wrap, highlight=False)

    @property
    def file(self) -> Any:
        """The stream; losing it does not end a search."""
        return _Stream(super().file, is_result=not self.stderr)

    @file.setter
    def file(self, new_file: IO[str]) -> None:
        self._file = new_file

    def render(
        self, renderable: RenderableType, options: ConsoleOptions | None = None
    ) -> Iterable[Segment]:
        """The segments of what is printed, made visible; rich adds its colours afterwards."""
        for segment in super().render(renderable, options):
            if segment.control:
                yield segment
            else:
                yield Segment(visible(segment.text), segment.style)


class _Stream:
    """A stream of the terminal. Once its reader is gone, output is dropped.

    Messages that cannot be written are dropped as well, because they matter less than the search. A
    result that cannot be written is an error.
    """

    def __init__(self, stream: Any, *, is_result: bool) -> None:
        self._stream = stream
        self._is_result = is_result

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        try:
            self._stream.write(text)
            self._stream.flush()
        except OSError as error:
            # Python writes the stream's buffer at its end, so it needs a destination that works.
            with open(os.devnull, "w") as nowhere:
                os.dup2(nowhere.fileno(), self._stream.fileno())
            if self._is_result and not isinstance(error, BrokenPipeError):
                raise OutputError(
                    f"standard output cannot be written ({error.strerror})"
                ) from error
        return len(text)

    def flush(self) -> None:
        """Do nothing: every text is flushed when it is written."""
