"""Refuses a limit of the address space in which libraries don't even load."""

import sys

from hypernav.core.errors import ConfigError

_LEAST_MB = 1500


def check_address_space() -> None:
    """Refuse to begin under a small ``ulimit -v``.

    Some libraries end the process by a signal where memory is refused while they load, and OpenBLAS
    tries again for ever, in a loop that no signal interrupts.

    Raises:
        ConfigError: The limit is too small.
    """
    if sys.platform == "win32":
        return
    import resource

    most, _ = resource.getrlimit(resource.RLIMIT_AS)
    if most != resource.RLIM_INFINITY and most < _LEAST_MB * 2**20:
        raise ConfigError(
            f"this process may take {most / 2**20:.0f} MB of addresses (ulimit -v), and libraries "
            f"need {_LEAST_MB} to load, a search twice that; raise the limit"
        )
