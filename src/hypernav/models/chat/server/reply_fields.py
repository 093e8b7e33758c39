"""Reads fields of a server's reply, checking their types and sizes."""

import math
from typing import Any

from hypernav.core.chat import Usage

_MOST_TOKENS = 10_000_000
"""More than any model's context; a larger count is an error of the server."""


def finite_number(value: object) -> float | None:
    """A JSON number as a float; None if it is not a number, not finite, or too large."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if math.isfinite(number) else None


def read_usage(value: object) -> Usage:
    """Token counts by the names of either API; 0 if missing or impossible."""
    if not isinstance(value, dict):
        return Usage()
    return Usage(
        _tokens(value.get("prompt_tokens", value.get("input_tokens"))),
        _tokens(value.get("completion_tokens", value.get("output_tokens"))),
    )


def _tokens(value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        return 0
    return value if 0 <= value <= _MOST_TOKENS else 0


def read_content(content: Any) -> str:
    """Text of a message: a string, or a list of parts of which those with text are joined."""
    if isinstance(content, str):
        return content
    parts = content if isinstance(content, list) else []
    texts = [part.get("text") for part in parts if isinstance(part, dict)]
    return "".join(text for text in texts if isinstance(text, str))
