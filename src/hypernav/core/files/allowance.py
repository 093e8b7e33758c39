"""The one limit on the memory that a file, or a configuration, may make this program allocate."""

import errno

MOST_BYTES = 2_000_000_000
"""The limit, bytes. A real scan of a large house, with a hundred textures of 2048², stays below."""


class Allowance:
    """The memory that one file may still make this program allocate."""

    def __init__(self) -> None:
        """Begin with the whole of `MOST_BYTES`."""
        self._left = MOST_BYTES

    def take(self, size: int, what: str) -> None:
        """Account for memory that is about to be allocated.

        Args:
            size: Size of the memory, bytes.
            what: Its content, for the message.

        Raises:
            OSError: The file asks for more than it may (``EFBIG``).
        """
        self._left -= size
        if self._left < 0:
            raise too_large(what, size, MOST_BYTES)


def too_large(what: str, size: int, most: int) -> OSError:
    """The error for something that is larger than allowed.

    Args:
        what: The thing that is too large.
        size: Size that it has or would take, bytes.
        most: Size that is allowed, bytes.
    """
    return OSError(
        errno.EFBIG, f"{what} would bring it to {megabytes(size)}, at most {megabytes(most)}"
    )


def megabytes(size: int) -> str:
    """A size for people, such as "2,000 MB"."""
    return f"{size // 1_000_000:,} MB" if size >= 10_000_000 else f"{size / 1e6:.2g} MB"
