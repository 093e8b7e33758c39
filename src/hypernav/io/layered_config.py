"""The settings of a user in layers: a file, the environment, the command line; later ones win."""

import difflib
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar, get_args

import yaml
from pydantic import BaseModel, ValidationError

from hypernav.core.errors import ConfigError
from hypernav.io.parsing import MOST_CHARACTERS, MOST_LEVELS, parse_yaml
from hypernav.io.reading import read_file, text_of

ENVIRONMENT_PREFIX = "HYPERNAV_"

_REASONS = {
    ("width", "height", "_px", "_pixels", "_mb"): "images must fit into memory",
    ("cell_m", "cell_size_m", "voxel_height_m"): "maps must fit into memory",
    ("_m", "_m2"): "metres, within the sizes of robots and rooms",
    ("_deg",): "degrees, at most a turn",
    ("_s",): "seconds, at most a day",
    ("_steps",): "steps of a search",
}
"""Reasons for the bounds, by suffixes of field names."""
_EXPLAINED = frozenset(
    {
        "finite_number",
        "float_parsing",
        "int_parsing",
        "greater_than",
        "greater_than_equal",
        "less_than",
        "less_than_equal",
    }
)
"""Pydantic's error types to which these reasons apply."""
_MOST_KEYS = 12
"""Largest number of keys of a section that a message lists."""

ConfigT = TypeVar("ConfigT", bound=BaseModel)


def layered(
    base: ConfigT,
    *,
    file: Path | None = None,
    environment: Mapping[str, str] = os.environ,
    assignments: Sequence[str] = (),
) -> ConfigT:
    """The configuration of a preset with all settings of the user laid over it.

    Args:
        base: Preset to start from.
        file: YAML file with the same sections; only values that differ need to be in it.
        environment: Environment variables, such as ``HYPERNAV_MAPPING__CELL_SIZE_M=0.1``.
        assignments: Assignments from the command line, such as ``mapping.cell_size_m=0.1``.

    Raises:
        ConfigError: A file that cannot be read, a wrong key or an impossible value.
    """
    values: dict[str, Any] = base.model_dump()
    if file is not None:
        _merge(type(base), values, _read_yaml(file), source=str(file))
    for name, text in sorted(environment.items()):
        key = name.removeprefix(ENVIRONMENT_PREFIX)
        if key != name and "__" in key:
            _assign(type(base), values, key.lower().split("__"), text, source=name)
    for assignment in assignments:
        key, equals, text = assignment.partition("=")
        if not equals:
            raise ConfigError(
                f"--set {assignment}: expected SECTION.KEY=VALUE, for example "
                "--set embodiment.camera.hfov_deg=60"
            )
        _assign(type(base), values, key.split("."), text, source=f"--set {assignment:.80}")
    return _validated(type(base), values)


def with_values(base: ConfigT, changes: Mapping[str, Any], *, source: str) -> ConfigT:
    """A configuration with other values.

    Args:
        base: Configuration to start from.
        changes: Values that differ, by section: mappings like the sections of a YAML file, or whole
            sections.
        source: Where the changes come from, for messages.

    Raises:
        ConfigError: A wrong key or an impossible value.
    """
    values: dict[str, Any] = base.model_dump()
    _merge(type(base), values, changes, source=source)
    return _validated(type(base), values)


def read_section(model: type[ConfigT], values: dict[str, Any], *, section: str) -> ConfigT:
    """Values of a section whose model is defined by a package outside hypernav.

    Args:
        model: Model of the section.
        values: Values that differ from the model's defaults.
        section: Name of the section in the whole configuration.

    Raises:
        ConfigError: A wrong key or an impossible value.
    """
    _merge(model, dict(values), values, source=section)
    return _validated(model, values, section=section)


def _validated(model: type[ConfigT], values: dict[str, Any], *, section: str = "") -> ConfigT:
    try:
        return model.model_validate(values)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in (section, *first["loc"]) if part != "")
        why = _reason(str(first["loc"][-1])) if first["type"] in _EXPLAINED else ""
        raise ConfigError(f"{where}: {first['msg']}, got {_shown(first['input'])}{why}") from error


def _reason(name: str) -> str:
    reasons = (reason for endings, reason in _REASONS.items() if name.endswith(endings))
    return next((f" ({reason})" for reason in reasons), "")


def _read_yaml(file: Path) -> dict[Any, Any]:
    try:
        content = parse_yaml(text_of(read_file(file, most=4 * MOST_CHARACTERS)))
    except OSError as error:
        raise ConfigError(f"cannot read the configuration {file}: {error.strerror}") from error
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        why = " ".join(str(error).split())
        raise ConfigError(f"{file} is not valid YAML: {why}") from error
    if content is None:
        return {}
    if not isinstance(content, dict):
        raise ConfigError(f"{file} must hold sections (mapping:, search:, …), got {content!r:.60}")
    return content


def _assign(
    model: type[BaseModel], values: dict[str, Any], keys: list[str], text: str, *, source: str
) -> None:
    try:
        nested: Any = parse_yaml(text)
    except yaml.YAMLError as error:
        why = " ".join(str(error).split())
        raise ConfigError(
            f"{source}: {_shown(text)} is not valid YAML ({why}); quote it, or check its brackets"
        ) from error
    if len(keys) > MOST_LEVELS:
        raise ConfigError(f"{source}: no option has a name of {len(keys)} parts")
    for key in reversed(keys):
        nested = {key: nested}
    _merge(model, values, nested, source=source)


def _merge(
    model: type[BaseModel],
    values: dict[str, Any],
    changes: Mapping[Any, Any],
    *,
    source: str,
) -> None:
    for key, change in changes.items():
        if key not in model.model_fields:
            here = f"keys here: {', '.join(model.model_fields)}"
            if len(model.model_fields) > _MOST_KEYS:
                here = "hypernav config lists all keys"
            raise ConfigError(
                f"{source}: unknown key '{key!s:.60}'; {_similar(model, str(key))}{here}"
            )
        inner = model.model_fields[key].annotation
        if isinstance(change, bool) and {int, float} & {inner, *get_args(inner)}:
            # Pydantic would take true for 1.
            raise ConfigError(f"{source}: '{key}' is a number, got {_shown(change)}")
        if isinstance(inner, type) and issubclass(inner, BaseModel):
            if isinstance(change, inner):
                values[key] = change.model_dump()
                continue
            if not isinstance(change, dict):
                raise ConfigError(
                    f"{source}: '{key}' is a section with the keys "
                    f"{', '.join(inner.model_fields)}, got {_shown(change)}"
                )
            _merge(inner, values[key], change, source=source)
        elif isinstance(change, dict) and isinstance(values[key], dict):
            values[key] = values[key] | change
        else:
            values[key] = change


def _similar(model: type[BaseModel], key: str) -> str:
    """A hint at a similar key of a model, or at one in its sections."""
    close = difflib.get_close_matches(key, model.model_fields, n=1)
    if close:
        return f"did you mean '{close[0]}'? "
    inside = dict(_names_inside(model))
    close = difflib.get_close_matches(key.rpartition(".")[2], inside, n=1)
    return f"did you mean '{close[0]}' in the section '{inside[close[0]]}'? " if close else ""


def _names_inside(model: type[BaseModel], outer: str = "") -> Iterator[tuple[str, str]]:
    """The keys in the sections of a model, at any depth, each with the section that holds it."""
    for name, field in model.model_fields.items():
        if isinstance(field.annotation, type) and issubclass(field.annotation, BaseModel):
            section = f"{outer}{name}"
            yield from _names_inside(field.annotation, f"{section}.")
            yield from ((inner, section) for inner in field.annotation.model_fields)


def _shown(value: Any) -> str:
    """A value for a message, shortened if it is long."""
    text = repr(value)
    return text if len(text) <= 80 else f"{text[:79]}…"
