"""The fields of a configuration as switches: their values, names and descriptions.

The descriptions are read from the docstrings, so that nothing is explained twice.
"""

import inspect
import json
import re
from functools import cache
from typing import Any

from pydantic import BaseModel

from hypernav.build.presets import HyPerNavConfig

_UNITS = {"_m": "m", "_m2": "m²", "_px": "px", "_deg": "°", "_s": "s"}
_ENTRY = re.compile(r"^ {4}(\w+): (.*(?:\n {8}.*)*)", re.MULTILINE)


def values_by_field(config: BaseModel, prefix: str = "") -> dict[str, Any]:
    """All values of a configuration by the full names of their fields."""
    values: dict[str, Any] = {}
    for key in type(config).model_fields:
        value, name = getattr(config, key), f"{prefix}{key}"
        if isinstance(value, BaseModel):
            values |= values_by_field(value, f"{name}.")
        else:
            values[name] = value
    return values


def differing_fields(a: HyPerNavConfig, b: HyPerNavConfig) -> list[str]:
    """Full names of the fields in which two configurations differ."""
    before, after = values_by_field(a), values_by_field(b)
    return [name for name, value in before.items() if value != after[name]]


def assignment(field: str, value: Any) -> str:
    """The assignment that gives a field its value, as ``--set`` takes it."""
    return f"{field}={json.dumps(value)}"


def switch_name(field: str, value: Any) -> str:
    """Short name of a field with a value, for people: "bump sensor: off", "margin: 0.12 m"."""
    section, _, key = field.rpartition(".")
    ending = next((end for end in _UNITS if key.endswith(end)), "")
    words = key.removesuffix(ending)
    if _names_of_fields().count(key) > 1:
        words = f"{section.rpartition('.')[2]} {words}"
    unit = f" {_UNITS[ending]}" if ending and value is not None else ""
    return f"{words.replace('_', ' ')}: {_shown(value)}{unit}"


@cache
def words_of(field: str) -> str:
    """The sentence of the docstring that says what a field is.

    Args:
        field: Full name of the field.
    """
    *sections, key = field.split(".")
    model: type[BaseModel] = HyPerNavConfig
    for section in sections:
        model = _section(model, section)
    entries = dict(_ENTRY.findall(inspect.cleandoc(model.__doc__ or "")))
    return " ".join(entries[key].split())


@cache
def _names_of_fields() -> list[str]:
    return [name.rpartition(".")[2] for name in values_by_field(HyPerNavConfig())]


def _section(model: type[BaseModel], name: str) -> type[BaseModel]:
    section = model.model_fields[name].annotation
    assert isinstance(section, type)
    assert issubclass(section, BaseModel)
    return section


def _shown(value: Any) -> str:
    match value:
        case None:
            return "none"
        case bool():
            return "on" if value else "off"
        case float():
            return f"{value:g}"
    return str(value)
