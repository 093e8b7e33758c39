"""The warm-up of compiled kernels on the first run on a machine.

Numba compiles a kernel on its first call, once on a machine, and keeps it on disk. It holds
Python's global lock meanwhile, so only other processes can compile at the same time. Each does an
exercise (`hypernav.warmup.exercises`) that calls a third of the kernels. This process loads its
scene meanwhile, and then waits: if it went on, it would compile each kernel shortly after another
process began to, and gain nothing.
"""

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from numba.extending import is_jitted

from hypernav.mapping import integrate_kernels

FIRST_RUN = "first run: compiling for this machine, once, takes a quarter of a minute or more …"
FIND = ("drawing", "searching", "walking")
"""The exercises whose kernels a search in a simulated building needs."""
SERVE = ("searching",)
"""Those of a server of robots."""
_SPARE = "scans"
"""The exercise for scans with a navigation mesh, done where there is a processor core to spare."""


def is_compiled() -> bool:
    """Whether the kernels are compiled on this machine, judged by the first of them.

    Files of an older version of the source or another version of Python don't count.
    """
    source = Path(integrate_kernels.__file__)
    kernel = integrate_kernels.integrate_frame
    if not is_jitted(kernel):
        return True  # with NUMBA_DISABLE_JIT nothing is compiled
    folder = kernel.stats.cache_path
    if folder is None:
        return False
    python = f"py{sys.version_info.major}{sys.version_info.minor}"
    indices = Path(folder).glob(f"{source.stem}.{kernel.__name__}-*.{python}.nbi")
    return any(index.stat().st_mtime >= source.stat().st_mtime for index in indices)


@contextmanager
def warm_up_in_background(
    say: Callable[[str], object], exercises: tuple[str, ...] = FIND
) -> Iterator[Callable[[], None]]:
    """Compile kernels in other processes while the block runs, unless they are compiled already.

    These processes are optional: kernels that they have not compiled are compiled here.

    Args:
        say: Function that is called with the message that this run takes longer.
        exercises: Names of the exercises whose kernels this run needs.

    Yields:
        A function that waits until the kernels of these exercises are compiled.
    """
    if is_compiled():
        yield lambda: None
        return
    say(FIRST_RUN)
    cores = os.cpu_count() or 1
    if cores < 2:
        yield lambda: None
        return
    with ExitStack() as started:
        processes = [started.enter_context(_exercising(name)) for name in exercises]
        if cores > len(FIND):
            started.enter_context(_exercising(_SPARE))

        def wait() -> None:
            for process in processes:
                process.wait()

        yield wait


@contextmanager
def _exercising(name: str) -> Iterator[subprocess.Popen[bytes]]:
    """A process that does an exercise, killed at the end of the block."""
    silent = subprocess.DEVNULL
    command = [sys.executable, "-m", "hypernav.warmup.exercises", name]
    with subprocess.Popen(command, stdin=silent, stdout=silent, stderr=silent) as process:
        try:
            yield process
        finally:
            process.kill()
