"""What a test is sure of."""

from typing import TypeVar

Value = TypeVar("Value")


def certain(value: Value | None) -> Value:
    """The value, which is there; a test that finds none fails here."""
    assert value is not None
    return value
