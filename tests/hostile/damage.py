"""Damage to files, thousands of times and always the same."""

from hypothesis import HealthCheck, settings
from hypothesis import strategies as st

hostile = settings(
    max_examples=2000,
    derandomize=True,
    database=None,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)


@st.composite
def damaged(draw: st.DrawFn, content: bytes) -> bytes:
    """Bytes of which some are others, or missing."""
    damage = bytearray(content)
    for _ in range(draw(st.integers(1, 4))):
        damage[draw(st.integers(0, len(damage) - 1))] = draw(st.integers(0, 255))
    return bytes(damage[: draw(st.integers(0, len(damage)) | st.just(len(damage)))])
