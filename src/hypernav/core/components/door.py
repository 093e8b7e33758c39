"""The one door for components of a user's own: what they return is checked, and failures named.

A component of this package passes unchanged, so the door costs it nothing. All others get a shell
that forwards everything: what the component raises, `SystemExit` included, becomes one error with
its name, and so does the first value that its protocol does not allow.
"""

import importlib
import os
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from functools import partial, update_wrapper
from pathlib import Path
from typing import Any, TypeVar, cast

from hypernav.core.components.returned import CHECKS, Check, ValueFault
from hypernav.core.errors import (
    CameraError,
    ComponentError,
    ContractError,
    HyPerNavError,
    SceneError,
    StartError,
    WorldError,
)
from hypernav.core.exploring.exploration import ExplorationView
from hypernav.core.exploring.floors import KnownFloor
from hypernav.core.exploring.guidance import GuideView
from hypernav.core.exploring.overview import FloorBlocks, Overview
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.interruptions import interruptions_of_kernels
from hypernav.core.observation import Observation

T = TypeVar("T")

SIMULATOR_ERRORS = (SceneError, StartError, WorldError, CameraError)
"""Errors by which a simulator fails. Raised by a component, they are the component's."""

_NOT_ITS_OWN = (f"{Path(__file__).parents[2]}{os.sep}", importlib.__file__, "<")
"""What stands between a call and the component; an import goes through files of Python, too."""
_MISSING = object()
_MOST_WORDS = 300


def through_door(component: T, protocol: type, name: str = "") -> T:
    """A component as the rest of the package may use it.

    Args:
        component: What a user's code made.
        protocol: Protocol that it must have, of `hypernav.core.components.protocols`.
        name: Its name, as the user wrote it; by default that of its class.

    Raises:
        ComponentError: It cannot even be looked at.
        ContractError: It lacks methods of its protocol.
    """
    if isinstance(component, type):
        raise ContractError(f"{component.__name__} is a class; give an object of it")
    kind = type(component)
    name = name or kind.__name__
    if kind.__module__.partition(".")[0] == __name__.partition(".")[0]:
        return component
    with calling(name, "a look at it"):
        check_protocol(component, protocol, name=name)
        names = [one for one in dir(component) if not one.startswith("_")]
    # In the class, because there `isinstance` with a protocol looks for them.
    forwards = {one: property(partial(_Shell.__getattr__, attribute=one)) for one in names}
    shell = type(kind.__name__, (_Shell,), forwards)
    return cast("T", shell(component, name, CHECKS.get(protocol.__name__, {})))


def check_protocol(thing: object, protocol: type, *, name: str) -> None:
    """Make sure that an object has the methods of a protocol.

    Args:
        thing: Object made by a user's code.
        protocol: Protocol, such as those of `hypernav.core.components.protocols`.
        name: Name of the object, as the user wrote it.

    Raises:
        ContractError: Methods are missing; the message names them.
    """
    wanted = [member for member in dir(protocol) if not member.startswith("_")]
    missing = [
        member
        for member in wanted
        if not hasattr(thing, member)
        or (callable(getattr(protocol, member)) and not callable(getattr(thing, member)))
    ]
    if missing:
        raise ContractError(
            f"{name} is no {protocol.__name__}: it has no {' and no '.join(missing)}; "
            f"{protocol.__module__}.{protocol.__name__} says what is expected"
        )


@contextmanager
def calling(name: str, what: str) -> Iterator[None]:
    """Turn whatever a user's code raises in the block into an error with its name.

    Errors of this package that say what a user must do, such as a model outage, stay as they are.

    Args:
        name: Name of the component.
        what: What is called.

    Raises:
        ComponentError: The code raised something, or tried to end the program.
        KeyboardInterrupt: Ctrl-C or SIGTERM came.
    """
    try:
        with interruptions_of_kernels():
            yield
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # whatever it is, it is the component's
        if isinstance(error, HyPerNavError) and not isinstance(error, SIMULATOR_ERRORS):
            raise
        said = " ".join(traceback.format_exception_only(error)[-1].split())[:_MOST_WORDS]
        verb = "ended the program" if isinstance(error, SystemExit) else "raised"
        raise ComponentError(
            f"{name}: {what} {verb} ({said}{_line_of(error)})", traceback.format_exc()
        ) from error


def _line_of(error: BaseException) -> str:
    """Where in the component's own file an error arose; empty if that is unknown."""
    if isinstance(error, SyntaxError) and error.filename is not None:
        return f", {error.filename} line {error.lineno}"
    frames = traceback.extract_tb(error.__traceback__)
    others = [frame for frame in frames if not frame.filename.startswith(_NOT_ITS_OWN)]
    own = [frame for frame in others if frame.filename == others[0].filename]
    return f", {own[-1].filename} line {own[-1].lineno}" if own else ""


def _copied(given: Any) -> Any:
    """What a component is given: images and maps of its own, on which it may draw."""
    match given:
        case Observation():
            return replace(given, rgb=given.rgb.copy(), depth=given.depth.copy())
        case OccupancyGrid():
            return given.copy()
        case KnownFloor():
            return replace(given, grid=given.grid.copy())
        case FloorBlocks():
            return replace(given, known=_copied(given.known))
        case GuideView():
            return replace(given, observation=_copied(given.observation))
        case ExplorationView():
            return replace(
                given,
                observation=_copied(given.observation),
                grid=given.grid.copy(),
                elsewhere=[_copied(one) for one in given.elsewhere],
            )
        case Overview():
            image = given.camera_image
            return replace(
                given,
                camera_image=None if image is None else image.copy(),
                find_elsewhere=lambda: [_copied(one) for one in given.elsewhere],
            )
    return given


class _Shell:
    """Forwards everything to a component; its class is made anew for every component."""

    def __init__(self, component: object, name: str, checks: Mapping[str, Check]) -> None:
        self._component, self._name, self._checks = component, name, checks

    def __getattr__(self, attribute: str) -> Any:
        with calling(self._name, attribute):
            value = getattr(self._component, attribute, _MISSING)
        if value is _MISSING:
            raise AttributeError(f"{self._name} has no {attribute}")
        if not callable(value):
            return self._checked(attribute, value)
        return update_wrapper(partial(self._call, attribute), value)  # with its signature

    def _call(self, method: str, *given: Any, **named: Any) -> Any:
        own = [_copied(one) for one in given]
        with calling(self._name, method):
            value = getattr(self._component, method)(
                *own, **{name: _copied(one) for name, one in named.items()}
            )
        return self._checked(method, value, *given, *named.values())

    def _checked(self, attribute: str, value: Any, *given: Any) -> Any:
        if attribute not in self._checks:
            return value
        try:
            with calling(self._name, f"what {attribute} returned"):
                return self._checks[attribute](value, *given)
        except ValueFault as fault:
            raise ComponentError(f"{self._name}: {attribute} returned {fault}") from None
