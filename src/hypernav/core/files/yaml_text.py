"""Parses YAML from outside: plain values, no repeated keys, limited depth, limited size."""

from typing import Any

import yaml
from yaml.composer import ComposerError
from yaml.constructor import ConstructorError

MOST_CHARACTERS = 200_000
"""Largest length of a text; PyYAML takes up to three seconds for it."""
MOST_LEVELS = 32
_MOST_DIGITS = 40


def parse_yaml(text: str) -> Any:
    """The value of a YAML text.

    Aliases are refused, since a few lines of them can expand to more than memory holds, and so are
    tags, since a value's type follows from its form.

    Raises:
        yaml.YAMLError: The text is too long, nested too deeply, not valid, or repeats a key.
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
