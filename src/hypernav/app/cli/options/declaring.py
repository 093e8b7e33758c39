"""How options are declared and read, so that their help says no more than a reader needs."""

from collections.abc import Callable
from dataclasses import dataclass, is_dataclass, replace
from functools import partial
from types import NoneType
from typing import Annotated, Any, TypeVar, dataclass_transform, get_args

import tyro
from tyro.constructors import (
    ConstructorRegistry,
    PrimitiveConstructorSpec,
    PrimitiveTypeInfo,
    StructConstructorSpec,
    StructTypeInfo,
    UnsupportedTypeAnnotationError,
)

T = TypeVar("T")

READING = ConstructorRegistry()
"""How texts become values: ``X | None`` is written like ``X``, and left out for None."""
_asking: list[type] = []
"""Classes whose fields tyro itself is being asked for."""


@dataclass_transform(frozen_default=True)
def options(declared: type[T]) -> type[T]:
    """A frozen dataclass of options, whose help shows only defaults that say something."""
    hint = tyro.conf.arg(help_behavior_hint=_hint)
    declared.__annotations__ = {
        name: Annotated[kind, hint] for name, kind in declared.__annotations__.items()
    }
    return dataclass(frozen=True)(declared)


def _hint(default: str) -> str:
    """What help says of a default; what is off or None is what happens without the option."""
    return "" if default in ("", "None", "False") else f"(default: {default})"


@READING.primitive_rule
def _optional(
    info: PrimitiveTypeInfo,
) -> PrimitiveConstructorSpec[Any] | UnsupportedTypeAnnotationError | None:
    kinds = [kind for kind in get_args(info.type) if kind is not NoneType]
    if len(kinds) != 1 or NoneType not in get_args(info.type):
        return None
    inner = ConstructorRegistry.get_primitive_spec(
        PrimitiveTypeInfo.make(kinds[0], parent_markers=info.markers)
    )
    if isinstance(inner, UnsupportedTypeAnnotationError):
        return inner
    return replace(
        inner,
        is_instance=lambda value: value is None or inner.is_instance(value),
        str_from_instance=lambda value: (
            ["None"] if value is None else inner.str_from_instance(value)
        ),
    )


@READING.struct_rule
def _with_whole_lines(info: StructTypeInfo) -> StructConstructorSpec | None:
    """The options as tyro reads them, but without the line breaks of their docstrings."""
    if not is_dataclass(info.type) or info.type in _asking:
        return None
    _asking.append(info.type)
    try:
        spec = ConstructorRegistry.get_struct_spec(info)
    finally:
        _asking.remove(info.type)
    if not isinstance(spec, StructConstructorSpec):
        return None
    fields = [replace(each, helptext=partial(_line, each.helptext)) for each in spec.fields]
    return replace(spec, fields=tuple(fields))


def _line(helptext: str | Callable[[], str | None] | None) -> str:
    text = helptext() if callable(helptext) else helptext
    return " ".join((text or "").split())
