"""The terminal, on which no text from a stranger can do more than be read."""

from collections.abc import Iterable

from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment

from hypernav.core.visible_text import visible


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

    def render(
        self, renderable: RenderableType, options: ConsoleOptions | None = None
    ) -> Iterable[Segment]:
        """The parts of whatever is printed; rich adds its own colours after this."""
        for segment in super().render(renderable, options):
            if segment.control:
                yield segment
            else:
                yield Segment(visible(segment.text), segment.style)
