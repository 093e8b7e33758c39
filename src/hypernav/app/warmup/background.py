"""The warm-up of compiled kernels on the first run on a machine.

Numba compiles a kernel on its first call, once on a machine, and keeps it on disk. It holds
Python's global lock meanwhile, so only another process can compile at the same time. While this
process builds the world and its walkable surface, the warm-up process walks on an empty grid, draws
one triangle, lets an agent search an empty room and walks on a navigation mesh. So it compiles the
kernels of paths, drawing, mapping and planning, about half of all, in the order in which this
process needs them, and then those of scans, which are for the next run if this one has no scan.
"""

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from numba.extending import is_jitted

from hypernav.app.warmup.stale_kernels import forget_stale_kernels
from hypernav.io.cache_folder import kernels_are_kept, why_not_kept
from hypernav.search.mapping import top_down_kernels

FIRST_RUN = "first run: compiling for this machine, once, takes a quarter of a minute or more …"
"""What is said where the next run finds what this one compiles."""


def is_compiled() -> bool:
    """Whether the kernels are compiled on this machine, judged by the first of them.

    Files of an older version of the source or another version of Python don't count.
    """
    source = Path(top_down_kernels.__file__)
    kernel = top_down_kernels.integrate_frame
    if not is_jitted(kernel):
        return True  # with NUMBA_DISABLE_JIT nothing is compiled
    folder = kernel.stats.cache_path
    if folder is None:
        return False
    python = f"py{sys.version_info.major}{sys.version_info.minor}"
    indices = Path(folder).glob(f"{source.stem}.{kernel.__name__}-*.{python}.nbi")
    return any(index.stat().st_mtime >= source.stat().st_mtime for index in indices)


@contextmanager
def warm_up_in_background(say: Callable[[str], object]) -> Iterator[None]:
    """Compile kernels in another process while the block runs, unless they are compiled already.

    That process is optional: kernels that it has not compiled in time are compiled here.

    Args:
        say: Function that is called with the message that this run takes longer.
    """
    forget_stale_kernels()
    if is_compiled():
        yield
        return
    say(FIRST_RUN if kernels_are_kept() else why_not_kept())
    if (os.cpu_count() or 1) < 2:
        yield
        return
    silent = subprocess.DEVNULL
    command = [sys.executable, "-m", "hypernav.app.warmup.exercises"]
    with subprocess.Popen(command, stdin=silent, stdout=silent, stderr=silent) as process:
        try:
            yield
        finally:
            process.kill()
