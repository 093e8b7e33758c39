"""Parses JSON, YAML and XML from outside: plain values, limited depth, limited size.

JSON may hold no NaN, and YAML no repeated keys.
"""

import json
import xml.etree.ElementTree as ElementTree
from typing import Annotated, Any, NoReturn, TypeVar

import yaml
from pydantic import FailFast
from yaml.composer import ComposerError
from yaml.constructor import ConstructorError

from hypernav.io.reading import Allowance

_Item = TypeVar("_Item")
Items = Annotated[list[_Item], FailFast()]
"""A list that reports only its first wrong item, because a file may hold millions."""

_MEMORY = {b"{": 400, b"[": 200, b",": 50, b":": 50}
"""Memory that a parsed text takes for each of these characters, bytes."""

MOST_CHARACTERS = 200_000
"""Largest length of a text; PyYAML takes up to three seconds for it."""
MOST_LEVELS = 32
_MOST_DIGITS = 40

_BYTES_PER_TAG = 300


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
    allowance.spend(size, "what its JSON says")


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is not a number of JSON")


def parse_yaml(text: str) -> Any:
    """The value of a YAML text.

    Aliases are refused, since a few lines of them can expand to more than memory holds, and so are
    tags, since a value's type follows from its form.

    Raises:
        yaml.YAMLError: The text is too long, nested too deeply, not valid, repeats a key, or holds
            half of a surrogate pair.
    """
    if len(text) > MOST_CHARACTERS:
        raise yaml.YAMLError(
            f"it has {len(text):,} characters, at most {MOST_CHARACTERS:,} are read"
        )
    try:
        return yaml.load(text, _Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = f" in line {mark.line + 1}" if mark is not None else ""
        raise yaml.YAMLError(f"{error.problem or error.context}{line}") from error
    except ValueError as error:  # a date or a number that only looks like one
        raise yaml.YAMLError(f"a value is impossible: {error}") from error


class _Loader(yaml.SafeLoader):
    """PyYAML's safe loader, made stricter."""

    _level = 0

    def compose_node(self, parent: Any, index: Any) -> Any:
        event = self.peek_event()
        if isinstance(event, yaml.AliasEvent):
            raise ComposerError(
                None, None, "aliases (*name) are not read; write the value out", event.start_mark
            )
        if getattr(event, "tag", None) not in (None, "!"):
            raise ComposerError(None, None, "tags (!name) are not read", event.start_mark)
        self._level += 1
        if self._level > MOST_LEVELS:
            raise ComposerError(
                None, None, f"more than {MOST_LEVELS} levels are not read", event.start_mark
            )
        node = super().compose_node(parent, index)
        if isinstance(node, yaml.ScalarNode):
            node.value.encode()  # raises a ValueError for half of a surrogate pair
        self._level -= 1
        return node

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        seen: set[tuple[str, str]] = set()
        for key, _ in node.value:
            if isinstance(key, yaml.ScalarNode):
                if (key.tag, key.value) in seen:
                    raise ConstructorError(
                        None, None, f"the key '{key.value:.60}' is there twice", key.start_mark
                    )
                seen.add((key.tag, key.value))
        return super().construct_mapping(node, deep)

    def construct_yaml_int(self, node: yaml.ScalarNode) -> int:
        if len(node.value) > _MOST_DIGITS:
            raise ConstructorError(
                None, None, f"a whole number has at most {_MOST_DIGITS} digits", node.start_mark
            )
        return super().construct_yaml_int(node)


_Loader.add_constructor("tag:yaml.org,2002:int", _Loader.construct_yaml_int)


def parse_xml(content: bytes, allowance: Allowance) -> ElementTree.Element:
    """The root element of a document; names of elements come without their namespace.

    Args:
        content: The document. White space before it is no fault.
        allowance: Memory that it may take.

    Raises:
        ValueError: It is not well-formed, or defines entities.
        OSError: It would take too much memory.
    """
    if b"<!ENTITY" in content.replace(b"\0", b""):  # also in UTF-16
        raise ValueError("it defines entities, which are not read")
    allowance.spend(content.count(b"<") * _BYTES_PER_TAG, "its elements")
    try:
        root = ElementTree.fromstring(content.lstrip())
    except (ElementTree.ParseError, LookupError) as error:  # LookupError: an unknown encoding
        raise ValueError(f"is not well-formed XML: {error}") from error
    for element in root.iter():
        element.tag = element.tag.rpartition("}")[2]
    return root
