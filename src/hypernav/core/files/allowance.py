"""The limit on the memory that a file or a configuration may make this program allocate."""

import errno

MOST_BYTES = 2_000_000_000
"""The limit, bytes. A scan of a large house with a hundred textures of 2048² stays below."""


class Allowance:
    """The memory that one file may still make this program allocate."""

    def __init__(self) -> None:
        """Create it with the whole of `MOST_BYTES`."""
        self._left = MOST_BYTES

    def take(self, size: int, what: str) -> None:
        """Account for memory that is about to be allocated.

        Args:
            size: Size of the memory, bytes.
            what: Content of the memory, for the message.

        Raises:
            OSError: The file asks for more than it may (``EFBIG``).
        """
        self._left -= size
        if self._left < 0:
            raise OSError(
                errno.EFBIG,
                f"{what} would take {megabytes(size)}, all of a file at most "
                f"{megabytes(MOST_BYTES)}",
            )


def megabytes(size: int) -> str:
    """A size for people, such as "2,000 MB"."""
    return f"{size // 1_000_000:,} MB" if size >= 10_000_000 else f"{size / 1e6:.2g} MB"
