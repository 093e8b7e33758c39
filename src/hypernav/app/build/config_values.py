"""What can be configured: every value with its default, unit, range, meaning and source.

Nothing is said here a second time: defaults and ranges are those of the models, meanings are the
entries of their docstrings, units are in the names of fields or in these meanings.
"""

import difflib
import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin

from annotated_types import Ge, Gt, Le, Lt
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from hypernav.app.build.presets import HyPerNavConfig, preset
from hypernav.core.config import UNITS, meanings
from hypernav.core.errors import ConfigError

Source = Literal["paper", "measured", "ours", "VLFM", "NavVLM", "VLMnav"]

_UNIT_WORDS = {
    "pixels": "px",
    "cells": "cells",
    "in (?:any|the same) currency": "currency",
    "tokens": "tokens",
    "share of": "share",
    r"[Pp]robabilit(?:y|ies)": "probability",
    r"[Ss]cores?": "score",
    r"[Cc]ost factor|cost factor": "factor",
    "[Ff]actor": "factor",
    r"standard deviations": "standard deviations",
    r"[Ss]eed": "seed",
    "metres": "m",
    "Threads": "threads",
    "temperature": "temperature",
    "quality": "quality",
    "Evidence": "evidence",
    "[Nn]umber of (?:points|images|dilations|questions|boxes|blocks|moves|actions)": "",
}
"""Units by the words of a meaning; the first of these words counts. Empty: the noun itself."""
_UNIT = re.compile("|".join(f"({word})" for word in _UNIT_WORDS))
_PAPER = re.compile(r"\(paper\b")
_RELEASED = re.compile(r"\(?(VLFM|NavVLM|VLMnav)(?:'s(?: code)?)?\)")


@dataclass(frozen=True)
class ConfigValue:
    """One value of the configuration.

    Attributes:
        key: Its name for ``--set``, such as ``search.endurance_steps``.
        default: Its value in the preset ``default``.
        paper: Its value in the preset ``paper``.
        unit: Its unit; empty for choices, texts and what is on or off.
        range: The possible values, in words.
        meaning: What it is.
        source: Where the default comes from: "measured" where it differs from the preset ``paper``,
            since ``default`` as a whole was measured to be better; else "paper", a published method
            whose value it is, or "ours".
    """

    key: str
    default: Any
    paper: Any
    unit: str
    range: str
    meaning: str
    source: Source

    @property
    def section(self) -> str:
        """The section that it belongs to."""
        return self.key.partition(".")[0]


@dataclass(frozen=True)
class _Field:
    key: str
    info: FieldInfo
    meaning: str


def config_values(name: str | None = None) -> list[ConfigValue]:
    """The values of the configuration, in its order.

    Args:
        name: A section, a section within one, or a single value; None for all values.

    Raises:
        ConfigError: There is no such section or value.
    """
    fields = list(_fields(HyPerNavConfig))
    chosen = [one for one in fields if name is None or f"{one.key}.".startswith(f"{name}.")]
    if not chosen:
        raise ConfigError(
            f"the configuration has no '{name!s:.60}'; {_hint(str(name), fields)}"
            f"sections: {', '.join(HyPerNavConfig.model_fields)}"
        )
    return [_value(one) for one in chosen]


def _hint(name: str, fields: Sequence[_Field]) -> str:
    """The section or value whose own name holds a name, or else the most similar one."""
    known = [each for one in fields for each in accumulate(one.key.split("."), "{}.{}".format)]
    holding = [one for one in known if name in one.rpartition(".")[2]]
    close = holding or difflib.get_close_matches(name, known, n=1)
    closest = min(close, key=lambda one: len(one.rpartition(".")[2]), default="")
    return f"did you mean '{closest}'? " if closest else ""


def section_meanings() -> dict[str, str]:
    """What each section holds, by its name."""
    return meanings(HyPerNavConfig)


def config_schema() -> dict[str, Any]:
    """The JSON schema of configuration files, by which editors complete and check YAML."""
    schema = HyPerNavConfig.model_json_schema()
    for model in {HyPerNavConfig, *_models(HyPerNavConfig)}:
        part = schema if model is HyPerNavConfig else schema["$defs"][model.__name__]
        part.pop("description", None)  # the docstring, which speaks of Python
        for field, meaning in meanings(model).items():
            part["properties"][field]["description"] = meaning
    return schema


def shown_value(value: Any) -> str:
    """A value as a YAML file and ``--set`` take it."""
    return json.dumps(value, ensure_ascii=False)


def _fields(model: type[BaseModel], prefix: str = "") -> Iterator[_Field]:
    for name, info in model.model_fields.items():
        inner = _section(info)
        if inner is not None:
            yield from _fields(inner, f"{prefix}{name}.")
        else:
            yield _Field(f"{prefix}{name}", info, meanings(model)[name])


def _models(model: type[BaseModel]) -> Iterator[type[BaseModel]]:
    for info in model.model_fields.values():
        if (inner := _section(info)) is not None:
            yield inner
            yield from _models(inner)


def _section(info: FieldInfo) -> type[BaseModel] | None:
    kind = info.annotation
    return kind if isinstance(kind, type) and issubclass(kind, BaseModel) else None


def _value(field: _Field) -> ConfigValue:
    default, paper = _at(preset("default"), field.key), _at(preset("paper"), field.key)
    kinds = _kinds(field.info.annotation)
    return ConfigValue(
        key=field.key,
        default=default,
        paper=paper,
        unit=_unit(field) if kinds & {int, float, tuple} else "",
        range=_range(field.info, kinds),
        meaning=field.meaning,
        source=_source(field, differs=default != paper),
    )


def _at(config: BaseModel, key: str) -> Any:
    value: Any = config
    for name in key.split("."):
        value = getattr(value, name)
    return value


def _kinds(annotation: Any) -> set[Any]:
    """The types of a field: those of an optional one without None, of generic ones the origin."""
    origin = get_origin(annotation)
    if origin in (Union, UnionType):
        return set().union(*(_kinds(one) for one in get_args(annotation)))
    return set() if annotation is NoneType else {origin or annotation}


def _unit(field: _Field) -> str:
    name = field.key.rpartition(".")[2]
    ending = next((end for end in UNITS if name.endswith(end)), "")
    if ending:
        return UNITS[ending]
    found = _UNIT.search(field.meaning)
    if found is None:
        return ""
    unit = list(_UNIT_WORDS.values())[(found.lastindex or 1) - 1]
    return unit or found[0].rpartition(" ")[2]


def _range(info: FieldInfo, kinds: set[Any]) -> str:
    if bool in kinds:
        words = "true or false"
    elif Literal in kinds:
        words = ", ".join(_choices(info.annotation))
    elif kinds & {int, float}:
        whole = "whole, " if int in kinds else ""
        words = f"{whole}{_bounds(info)}"
    elif dict in kinds:
        words = "keys with values"
    elif tuple in kinds:
        words = "list of texts" if str in get_args(info.annotation) else "list of points [x, y]"
    else:
        words = "text"
    return f"{words}; or null" if NoneType in get_args(info.annotation) else words


def _choices(annotation: Any) -> Iterator[str]:
    for one in get_args(annotation):
        if isinstance(one, str):
            yield one
        elif get_origin(one) is Literal:
            yield from get_args(one)


def _bounds(info: FieldInfo) -> str:
    low = high = ""
    for bound in info.metadata:
        match bound:
            case Ge(ge=number):
                low = _number(number)
            case Gt(gt=number):
                low = f"above {_number(number)}"
            case Le(le=number):
                high = _number(number)
            case Lt(lt=number):
                high = f"below {_number(number)}"
            case _:
                pass
    return f"{low} to {high}"


def _number(number: Any) -> str:
    return f"{number:,}" if isinstance(number, int) else f"{number:,.12g}"


def _source(field: _Field, *, differs: bool) -> Source:
    if field.key.rpartition(".")[2].startswith("published_"):
        return "paper"  # it names what the paper used, where the preset is the paper's
    if differs:
        return "measured"
    if _PAPER.search(field.meaning) and " ours" not in field.meaning:
        return "paper"
    released = _RELEASED.search(field.meaning)
    return released[1] if released else "ours"  # pyright: ignore[reportReturnType]
