"""Damage to files, thousands of times and always the same, and bounds to what reading takes."""

import resource
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from hypothesis import HealthCheck, settings
from hypothesis import strategies as st

hostile = settings(
    max_examples=2000,
    derandomize=True,
    database=None,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)

MOST_BYTES = 2_000_000_000
MOST_SECONDS = 10.0
"""Of processor time; a sound file of this size takes milliseconds."""


@contextmanager
def bounded() -> Iterator[None]:
    """Let the block have `MOST_BYTES` more memory than the process has, and `MOST_SECONDS`.

    What asks for more fails with a `MemoryError`, as nothing of ours may. Memory is bounded where
    the system can (Linux), whoever asks for it: numpy, OpenCV or compiled code.
    """
    before = resource.getrlimit(resource.RLIMIT_AS)
    if sys.platform == "linux":
        pages = int(Path("/proc/self/statm").read_text().split()[0])
        most = pages * resource.getpagesize() + MOST_BYTES
        resource.setrlimit(resource.RLIMIT_AS, (most, before[1]))
    began_s = time.process_time()
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)
        spent_s = time.process_time() - began_s
        assert spent_s < MOST_SECONDS, f"a damaged file took {spent_s:.0f} s"


@st.composite
def damaged(draw: st.DrawFn, content: bytes) -> bytes:
    """Bytes of which some are others, or missing."""
    damage = bytearray(content)
    for _ in range(draw(st.integers(1, 4))):
        damage[draw(st.integers(0, len(damage) - 1))] = draw(st.integers(0, 255))
    return bytes(damage[: draw(st.integers(0, len(damage)) | st.just(len(damage)))])
