"""The run-time type checker of the tests: beartype, and jaxtyping where shapes are named.

jaxtyping's own import hook gives every function a scope of axis names and checks all arguments
twice, which took two fifths of the time of the tests. Most functions name no axis: beartype alone
checks these as strictly. The others get a scope and no more: jaxtyping's decorator sorts the
arguments of every call for the message of an error, too.
"""

import ast
import sys
from collections.abc import Callable, Collection, Sequence
from dataclasses import is_dataclass
from functools import wraps
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from inspect import isgeneratorfunction
from types import ModuleType
from typing import Any, get_args

from beartype import BeartypeConf, beartype
from jaxtyping import AbstractArray, jaxtyped

_typed = beartype(conf=BeartypeConf(is_pep484_tower=True))  # int is accepted for float
_AXIS_NAMES = jaxtyped("context")
_DECORATOR = "runtime_checks.checked"


def check_modules(names: Collection[str]) -> None:
    """Check each call of the functions and data classes of these modules, once imported."""
    sys.meta_path.insert(0, _Finder(frozenset(names)))


def checked(subject: Any) -> Any:
    """Decorate a function or a class; of classes, data classes are checked as they are made."""
    if isinstance(subject, type):
        if is_dataclass(subject) and "__init__" in vars(subject):
            subject.__init__ = checked(subject.__init__)
        return subject
    for name, hint in subject.__annotations__.items():
        if isinstance(hint, str):  # a class that is defined later, or for type checkers alone
            subject.__annotations__[name] = Any
    if isgeneratorfunction(subject):
        # The other form stops checking every shape that a generator function yields, everywhere.
        return jaxtyped(typechecker=_typed)(subject)
    if any(_names_axes(hint) for hint in subject.__annotations__.values()):
        return _in_scope_of_its_own(_typed(subject))
    return _typed(subject)


def _in_scope_of_its_own(function: Callable[..., Any]) -> Callable[..., Any]:
    """A function whose axis names stand for the same sizes throughout one call."""

    @wraps(function)
    def scoped(*args: Any, **kwargs: Any) -> Any:
        __tracebackhide__ = True
        with _AXIS_NAMES:
            return function(*args, **kwargs)

    return scoped


def _names_axes(hint: Any) -> bool:
    """Whether a type hint is, or holds, an array whose shape is named."""
    if isinstance(hint, type) and issubclass(hint, AbstractArray):
        return True
    return any(map(_names_axes, hint if isinstance(hint, list) else get_args(hint)))


class _Finder(MetaPathFinder):
    """Finds the modules to be checked, for a loader that decorates them."""

    def __init__(self, names: frozenset[str]) -> None:
        self._names = names

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if fullname not in self._names:
            return None
        spec = PathFinder.find_spec(fullname, path, target)
        if spec is not None and spec.origin is not None:
            spec.loader = _DecoratingLoader(fullname, spec.origin)
        return spec


class _DecoratingLoader(SourceFileLoader):
    """Loads a module with `checked` on its functions and classes, with bytecode of its own."""

    def source_to_code(self, data: Any, path: Any, *, _optimize: int = -1) -> Any:
        tree = ast.parse(data, path)
        for node in list(ast.walk(tree)):
            # On classes it stands outermost, after `dataclass`.
            if isinstance(node, ast.ClassDef):
                node.decorator_list.insert(0, _located(node))
            elif isinstance(node, ast.FunctionDef):
                node.decorator_list.append(_located(node))
        is_documented = ast.get_docstring(tree, clean=False) is not None
        tree.body.insert(int(is_documented), ast.parse("import runtime_checks").body[0])
        return compile(tree, path, "exec", dont_inherit=True, optimize=_optimize)

    def get_data(self, path: str) -> bytes:
        return super().get_data(_checked_bytecode(path))

    def set_data(self, path: str, data: Any, *, _mode: int = 0o666) -> None:
        super().set_data(_checked_bytecode(path), data, _mode=_mode)


def _located(node: ast.stmt) -> ast.expr:
    """The decorator as an expression where a definition begins."""
    decorator = ast.parse(_DECORATOR, mode="eval").body
    return ast.fix_missing_locations(ast.copy_location(decorator, node))


def _checked_bytecode(path: str) -> str:
    """The file for the bytecode of a checked module; a source file stays what it is."""
    return path.removesuffix("pyc") + "checked.pyc" if path.endswith(".pyc") else path
