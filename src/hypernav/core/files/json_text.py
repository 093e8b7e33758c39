"""Parses JSON from outside: no NaN, limited depth, limited size."""

import json
from typing import Annotated, Any, NoReturn, TypeVar

from pydantic import FailFast

from hypernav.core.files.allowance import Allowance

_Item = TypeVar("_Item")
Items = Annotated[list[_Item], FailFast()]
"""A list that reports only its first wrong item, because a file may hold millions."""

_MEMORY = {b"{": 400, b"[": 200, b",": 50, b":": 50}
"""Memory that a parsed text takes for each of these characters, bytes."""


def parse_json(text: bytes, allowance: Allowance | None = None) -> Any:
    """The value of a JSON text.

    Args:
        text: The text, UTF-8.
        allowance: Memory that the file may still take; by default that of a file of its own.

    Raises:
        ValueError: The text is no JSON (NaN and infinity are not allowed), is nested too deeply, or
            holds half of a surrogate pair.
        OSError: Its values would take too much memory.
    """
    check_json_size(text, allowance or Allowance())
    try:
        value = json.loads(text, parse_constant=_refuse_constant)
    except RecursionError as error:
        raise ValueError("it is nested too deeply") from error
    if b"\\ud" in text or b"\\uD" in text:  # half of a surrogate pair cannot be encoded
        json.dumps(value, ensure_ascii=False).encode("utf-8")
    return value


def check_json_size(text: bytes, allowance: Allowance) -> None:
    """Refuse a text whose values would take too much memory, before it is parsed.

    Raises:
        OSError: They would take too much.
    """
    size = 2 * len(text) + sum(text.count(mark) * memory for mark, memory in _MEMORY.items())
    allowance.take(size, "what its JSON says")


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is not a number of JSON")
