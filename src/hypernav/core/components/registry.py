"""Components found by name: built in, from an installed package, or ``package.module:Name``.

Nothing is imported before it is needed: a built-in entry names the module of its target, an
installed package names it in an entry point, and ``package.module:Name`` names it directly.
"""

import difflib
import importlib
import os
import re
import sys
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from importlib.metadata import entry_points
from pathlib import Path
from types import ModuleType
from typing import Any, Generic, TypeVar, cast

from hypernav.core.components.door import calling
from hypernav.core.errors import ConfigError, ImportTargetError, MissingExtraError

T = TypeVar("T")

_MODULE = re.compile(r"[^\W\d]\w*(\.[^\W\d]\w*)*")


def require(module: str, *, extra: str) -> ModuleType:
    """Import an optional module; if it is missing, raise an error that says how to install it.

    Args:
        module: Import name, for example ``"onnxruntime"``.
        extra: The extra of this package that brings it.

    Raises:
        MissingExtraError: The module is not installed.
    """
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        raise MissingExtraError(
            f"this needs the package '{module}', which is not installed; "
            f"try: pip install 'hypernav[{extra}]'"
        ) from error


@dataclass(frozen=True)
class Entry(Generic[T]):
    """One named component.

    Attributes:
        name: Name for options.
        target: The component itself, or where it is imported from: ``package.module:name``.
        form: Full form of a specification: ``yolox:PATH.onnx``, ``mine[:ARGUMENT]``; by default
            the name alone. Its commas give the number of arguments.
        words: Description for people; by default the name. ``{files}`` stands for the file names
            after the name; other fields are filled in by the caller of `Choice.words`.
        section: Section of the configuration; empty for none, and for components of other packages.
        is_foreign: Whether the component comes from another package.
    """

    name: str
    target: T | str
    form: str = ""
    words: str = ""
    section: str = ""
    is_foreign: bool = False

    @property
    def full_form(self) -> str:
        """Full form of a specification, for people."""
        return self.form or self.name

    def load(self) -> T:
        """The component, imported if necessary.

        Raises:
            ImportTargetError: The component cannot be imported.
        """
        if isinstance(self.target, str):
            return import_target(self.target)
        return cast("T", self.target)


@dataclass(frozen=True)
class Choice(Generic[T]):
    """An entry with the arguments of a specification.

    Attributes:
        entry: Entry of the name.
        arguments: Arguments after the name; with parts all of theirs.
        parts: Components that are used together, if the specification joins several by "+"; the
            entry is then what joins them.
    """

    entry: Entry[T]
    arguments: tuple[str, ...] = ()
    parts: "tuple[Choice[T], ...]" = ()

    def load(self) -> T:
        """The named component, imported by `Entry.load`."""
        return self.entry.load()

    @property
    def spec(self) -> str:
        """The specification of the choice."""
        if self.parts:
            return "+".join(one.spec for one in self.parts)
        name = self.entry.name
        return f"{name}:{','.join(self.arguments)}" if self.arguments else name

    def words(self, **fields: str) -> str:
        """Description for people.

        Args:
            **fields: Values of fields other than ``files`` that the entry's words may contain.
        """
        if self.parts:
            return " + ".join(one.words(**fields) for one in self.parts)
        files = " + ".join(Path(argument).name for argument in self.arguments)
        words = self.entry.words or f"{self.entry.name} {{files}}"
        return words.format(files=files, **fields).strip()


class Registry(Generic[T]):
    """The components of one kind.

    Examples:
        >>> detectors = Registry("detector", "hypernav.detectors")  # doctest: +SKIP
        >>> detectors.find("yolox:net.onnx").arguments  # doctest: +SKIP
        ('net.onnx',)
    """

    def __init__(
        self,
        kind: str,
        group: str,
        entries: Iterable[Entry[T]] = (),
        *,
        together: Entry[T] | None = None,
    ) -> None:
        """Fill the registry.

        Args:
            kind: Name of the kind, in the singular.
            group: Group of entry points, by which components of installed packages are found; empty
                if other packages cannot add any.
            entries: Built-in components.
            together: What makes one of several, joined by "+"; None where one alone can be named.
        """
        self._together = together
        self.kind = kind
        self.group = group
        self._entries: dict[str, Entry[T]] = {entry.name: entry for entry in entries}

    def add(self, entry: Entry[T]) -> None:
        """Register one more component.

        Raises:
            ConfigError: The name is taken.
        """
        if entry.name in self._entries:
            raise ConfigError(f"there is a {self.kind} '{entry.name}' already; choose another name")
        self._entries[entry.name] = entry

    @property
    def forms(self) -> list[str]:
        """Full forms of everything built in, in the order of registration."""
        return [entry.full_form for entry in self._entries.values()]

    @property
    def names(self) -> list[str]:
        """Names of everything built in or from an installed package."""
        return [*self._entries, *(point.name for point in entry_points(group=self.group))]

    @property
    def sections(self) -> set[str]:
        """Sections of the configuration for built-in components."""
        return {entry.section for entry in self._entries.values() if entry.section}

    def knows(self, name: str) -> bool:
        """Whether a component has this name, built in or from an installed package."""
        return name in self._entries or self._installed(name) is not None

    def find(self, spec: str) -> Choice[T]:
        """The component that a specification names.

        Args:
            spec: ``NAME``, ``NAME:ARGUMENTS`` or ``package.module:Name[:ARGUMENTS]``; where several
                can be used together, these joined by ``+``.

        Raises:
            ConfigError: There is no such component, or the specification does not have its form.
            ImportTargetError: The component of another package cannot be imported.
        """
        specs = self._joined(spec)
        if self._together is not None and len(specs) > 1:
            if len(set(specs)) < len(specs):
                raise ConfigError(f"{self.kind} '{spec}' names one twice; name different ones")
            parts = tuple(self.find(one) for one in specs)
            arguments = tuple(text for one in parts for text in one.arguments)
            return Choice(self._together, arguments, parts)
        name, _, rest = spec.partition(":")
        entry = self._entries.get(name) or self._installed(name)
        if entry is None:
            attribute, _, rest = rest.partition(":")
            if not (attribute.isidentifier() and _MODULE.fullmatch(name)):
                raise ConfigError(f"unknown {self.kind} '{spec}'; {self._advice(name)}")
            entry = self._imported(name, attribute)
        return Choice(entry, self._arguments(entry, spec, rest))

    def _joined(self, spec: str) -> list[str]:
        """The specifications that "+" joins; one in a file's name has no component's behind it."""
        first, *others = spec.split("+")
        specs = [first]
        for text in others:
            if self.knows(text.partition(":")[0]):
                specs.append(text)
            else:
                specs[-1] += f"+{text}"
        return specs

    def _installed(self, name: str) -> Entry[T] | None:
        """Entry that an installed package registers under a name."""
        for point in entry_points(group=self.group):
            if point.name == name:
                return Entry(name, point.value, form=f"{name}[:ARGUMENT]", is_foreign=True)
        return None

    def _imported(self, module: str, attribute: str) -> Entry[T]:
        """Entry of a component that is named by its module."""
        target = f"{module}:{attribute}"
        _make_current_folder_importable()
        try:
            thing = import_target(target)
        except ImportTargetError as error:
            raise ImportTargetError(
                f"{self.kind} '{target}': {error}; or {self._advice(module)}"
            ) from error
        return Entry(
            target,
            thing,
            form=f"{target}[:ARGUMENT]",
            words=f"{attribute} of {module} {{files}}",
            is_foreign=True,
        )

    def _arguments(self, entry: Entry[T], spec: str, text: str) -> tuple[str, ...]:
        """Arguments after the name; checks their number."""
        form = entry.full_form
        if not text and not form.startswith(f"{entry.name}:"):
            return ()
        commas = form.count(",")
        arguments = tuple(text.split(",", commas))
        if not form.startswith((f"{entry.name}:", f"{entry.name}[:")):
            raise ConfigError(f"{self.kind} '{spec}': nothing follows this name; write {form}")
        if len(arguments) != commas + 1 or not all(arguments):
            raise ConfigError(f"{self.kind} '{spec}': expected {form}")
        return arguments

    def _advice(self, name: str) -> str:
        names = self.names
        close = difflib.get_close_matches(name, names, n=1)
        hint = f"did you mean '{close[0]}'? " if close else ""
        installed = [name for name in names if name not in self._entries]
        forms = ", ".join([*self.forms, *installed])
        return f"{hint}use {forms} or one of your own, package.module:Name"


def import_target(target: str) -> Any:
    """The object at ``package.module:name``.

    Raises:
        ComponentError: The module fails while it is imported.
        ImportTargetError: There is no such module, it needs a package that is not installed, or it
            holds no such name.
    """
    with calling(target, "its import"):
        return _imported_target(*target.split(":"))


def _imported_target(module_name: str, attribute: str) -> Any:
    try:
        module = importlib.import_module(module_name)
    except ModuleNotFoundError as error:
        missing = error.name or module_name
        if module_name == missing or module_name.startswith(f"{missing}."):
            remedy = "run this in its folder, install its package or name its folder in PYTHONPATH"
            if module_name.endswith(".py"):
                remedy = "leave out .py"
            raise ImportTargetError(f"there is no module '{missing}'; {remedy}") from error
        raise ImportTargetError(
            f"{module_name} needs the module '{missing}', which is not installed"
        ) from error
    except ImportError as error:
        raise ImportTargetError(f"{module_name} cannot be imported: {error}") from error
    if not hasattr(module, attribute):
        public = [name for name in vars(module) if not name.startswith("_")]
        close = difflib.get_close_matches(attribute, public, n=1)
        hint = f", but '{close[0]}'" if close else ""
        raise ImportTargetError(f"{module_name} ({module.__file__}) has no '{attribute}'{hint}")
    return getattr(module, attribute)


def _make_current_folder_importable() -> None:
    """Allow imports from the current folder, so that a user's file need not be installed.

    The folder comes last, so that no file in it accidentally replaces an installed package.
    """
    with suppress(FileNotFoundError):  # the folder has been removed
        folder = os.getcwd()
        if folder not in sys.path and "" not in sys.path:
            sys.path.append(folder)
