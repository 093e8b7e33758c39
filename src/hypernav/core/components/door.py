"""The one door for components of a user's own: what they return is checked, and failures named.

A component of this package passes unchanged, so the door costs it nothing. All others get a shell
that forwards everything: what the component raises, `SystemExit` included, becomes one error with
its name, and so does the first value that its protocol does not allow.
"""

import importlib
import json
import math
import os
import sys
import traceback
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import is_dataclass, replace
from functools import lru_cache, partial, update_wrapper
from numbers import Integral, Real
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, TypeVar, Union, cast, get_args, get_origin, get_type_hints

import numpy as np
from pydantic import TypeAdapter, ValidationError

from hypernav.core.config import Curve
from hypernav.core.embodiment import Action, Embodiment
from hypernav.core.errors import (
    CameraError,
    ComponentError,
    ContractError,
    HyPerNavError,
    SceneError,
    StartError,
    WorldError,
)
from hypernav.core.exploring.exploration import (
    Chosen,
    Destination,
    ExplorationView,
    StairsDestination,
)
from hypernav.core.exploring.floors import KnownFloor, SeenThing, WayOut
from hypernav.core.exploring.guidance import (
    TURN_AROUND,
    ArrowChoice,
    ArrowView,
    GuideChoice,
    GuideView,
)
from hypernav.core.exploring.overview import BlockChoice, FloorBlocks, Overview
from hypernav.core.geometry.boxes import Detection
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.interruptions import interruptions_of_kernels
from hypernav.core.observation import Observation
from hypernav.core.trace import StepTrace

_CURVE: TypeAdapter[Curve] = TypeAdapter(Curve)
Check = Callable[..., Any]
"""Checks what a method returned, given its arguments, and gives it in the form of its type."""

_ROUNDING = 1e-6
_FARTHEST_M = 10_000.0
_FARTHEST_PIXELS = 1e6
_LARGEST = sys.float_info.max
_LENGTHS = (1e-30, 1e30)
"""Lengths of vectors whose numbers single precision holds."""
_MOST_DETECTIONS = 1_000
_MOST_CHARACTERS = 32_768
"""Length of a text, as of a model's answer."""
_ENDLESS = ("travel_m",)
"""Fields that are infinite where there is no path."""

T = TypeVar("T")

SIMULATOR_ERRORS = (SceneError, StartError, WorldError, CameraError)
"""Errors by which a simulator fails. Raised by a component, they are the component's."""

_NOT_ITS_OWN = (f"{Path(__file__).parents[2]}{os.sep}", importlib.__file__, "<")
"""What stands between a call and the component; an import goes through files of Python, too."""
_MISSING = object()
_MOST_WORDS = 300


class ValueFault(HyPerNavError):
    """A value that no component may return; the message goes on after "returned"."""


def _expect(holds: bool, value: object, expected: str, where: str = "") -> None:
    if not holds:
        raise ValueFault(f"{where}{_shown(value)}; expected {expected}")


def _shown(value: object) -> str:
    if isinstance(value, np.ndarray):
        return f"an array of {value.dtype} with the shape {value.shape}"
    try:
        return f"{value!r:.80}"
    except Exception:  # a repr of the user's own may raise anything
        return f"a {type(value).__name__}"


def _is_number(value: Any, low: float = -_LARGEST, high: float = _LARGEST) -> bool:
    number: Any = value if isinstance(value, Real) and not isinstance(value, bool) else math.nan
    if isinstance(number, np.generic):  # beside one, other numbers would lose digits
        number = number.item()
    return bool(low <= number <= high)


def _expect_text(value: Any, where: str) -> None:
    """Expect a text that files and pages can hold."""
    is_text = isinstance(value, str) and len(value) <= _MOST_CHARACTERS
    fits = is_text and value == value.encode(errors="replace").decode()
    expected = f"a text of valid Unicode, of up to {_MOST_CHARACTERS:,} characters"
    _expect(fits, value, expected, where)


def _is_whole(value: Any) -> bool:
    return isinstance(value, Integral) and not isinstance(value, bool)


@lru_cache
def _fields_of(kind: type) -> dict[str, Any]:
    """The fields of a dataclass with their types, apart from arrays."""
    hints = get_type_hints(kind)
    return {name: hint for name, hint in hints.items() if name not in ("mask", "xy")}


def checked(value: Any, kind: type, where: str = "") -> Any:
    """A dataclass of this package with every field in the form of its type.

    What a field may hold follows from its annotation, so the checks are those of today's fields.
    """
    a = "an" if kind.__name__[0] in "AI" else "a"
    _expect(isinstance(value, kind), value, f"{a} {kind.__name__}", where)
    inside = f"{where}{a} {kind.__name__} with the "
    given = {name: getattr(value, name) for name in _fields_of(kind)}
    made = {
        name: _in_form(given[name], hint, f"{inside}{name} ", endless=name in _ENDLESS)
        for name, hint in _fields_of(kind).items()
    }
    return value if all(made[name] is given[name] for name in made) else replace(value, **made)


def _in_form(value: Any, hint: Any, where: str, *, endless: bool = False) -> Any:
    """A value in the form of a type as dataclasses of this package are annotated."""
    if get_origin(hint) in (Union, UnionType):
        first, *others = (one for one in get_args(hint) if one is not NoneType)
        kind = next((one for one in others if type(value) is one), first)
        return None if value is None else _in_form(value, kind, where)
    if get_origin(hint) is tuple:
        return _tuple_in_form(value, get_args(hint), where)
    if hint is str:
        _expect_text(value, where)
        return value
    if isinstance(hint, type) and is_dataclass(hint):
        return checked(value, hint, where)
    if hint is float:
        _expect(_is_number(value) or (endless and value == math.inf), value, "a number", where)
        return value if isinstance(value, float | int) else float(value)
    if hint is int:
        _expect(_is_whole(value), value, "a whole number", where)
        return int(value)
    if hint is bool:
        return _yes_or_no(value, where=where)
    _expect(isinstance(value, hint), value, f"{hint.__name__}", where)
    return value


def _tuple_in_form(value: Any, kinds: tuple[Any, ...], where: str) -> tuple[Any, ...]:
    many = kinds[-1] is Ellipsis
    fits = isinstance(value, tuple) and (many or len(value) == len(kinds))
    _expect(fits, value, "a tuple" if many else f"a tuple of {len(kinds)}", where)
    each = kinds[:1] * len(value) if many else kinds
    made = tuple(_in_form(one, kind, where) for one, kind in zip(value, each, strict=True))
    return value if all(a is b for a, b in zip(made, value, strict=True)) else made


def _action(value: Any, *_: Any) -> Action | None:
    known = value is None or (_is_whole(value) and int(value) in set(Action))
    names = ", ".join(action.name for action in Action)
    _expect(known, value, f"an Action ({names}), or None to give up")
    return None if value is None else Action(int(value))


def _detections(value: Any, *given: Any) -> list[Detection]:
    _expect(isinstance(value, list | tuple), value, "a list of Detection")
    most = f"at most {_MOST_DETECTIONS:,} of an image"
    _expect(len(value) <= _MOST_DETECTIONS, f"{len(value):,} detections", most)
    observation = next(one for one in given if isinstance(one, Observation))
    return [_detection(one, observation.depth.shape) for one in value]


def _detection(value: Any, shape: tuple[int, ...]) -> Detection:
    where = "a Detection with "
    value = checked(value, Detection, "a list with ")
    box = value.box
    corners = (box.x_min, box.y_min, box.x_max, box.y_max)
    finite = all(_is_number(one, -_FARTHEST_PIXELS, _FARTHEST_PIXELS) for one in corners)
    _expect(finite, box, "finite numbers of pixels, up to a million", f"{where}the box ")
    in_order = box.x_min <= box.x_max and box.y_min <= box.y_max
    _expect(in_order, box, "x_min <= x_max and y_min <= y_max", f"{where}the box ")
    sure = _is_number(value.score, -_ROUNDING, 1.0 + _ROUNDING)
    _expect(sure, value.score, "a number from 0 to 1", f"{where}the score ")
    if value.mask is not None:
        _mask_of(value.mask, shape, f"{where}the mask ")
    return value


def _mask(value: Any, *given: Any) -> np.ndarray:
    observation = next(one for one in given if isinstance(one, Observation))
    return _mask_of(value, observation.depth.shape)


def _mask_of(value: Any, shape: tuple[int, ...], where: str = "") -> np.ndarray:
    # Of these types exactly: a matrix and a masked array mean something else by their items.
    fits = type(value) in (np.ndarray, np.memmap) and value.dtype == bool and value.shape == shape
    _expect(fits, value, f"an array of bool with the image's shape {shape}", where)
    return value


def _things(value: Any, *_: Any) -> Mapping[int, SeenThing]:
    _expect(isinstance(value, Mapping), value, "a mapping of numbers to SeenThing")
    things = dict[int, SeenThing]()
    for number, thing in value.items():
        _expect(_is_whole(number), number, "whole numbers as keys", "a mapping with the key ")
        things[int(number)] = checked(thing, SeenThing, "a mapping with ")
        _expect(_is_near(thing.position), thing, "a position on the map", "a mapping with ")
    return things


def _is_near(position: tuple[float, float]) -> bool:
    return all(abs(one) <= _FARTHEST_M for one in position)


def _destination(value: Any, view: ExplorationView | None = None, *_: Any) -> Chosen | None:
    if value is None:
        return None
    takes_stairs = isinstance(value, StairsDestination)
    value = one = checked(value, StairsDestination if takes_stairs else Destination)
    stairs = sorted({way.connector for way in _stairs_of(view)}) if view is not None else []
    while one is not None:
        _expect(_is_near(one.xy), one, f"x and y within {_FARTHEST_M:,.0f} m")
        if isinstance(one, Destination):
            break
        where = "a StairsDestination with the connector "
        _expect(one.connector in stairs, one.connector, f"one of the view's, {stairs}", where)
        one = one.then
    return value


def _stairs_of(view: ExplorationView) -> list[WayOut]:
    """All stairs that an explorer is told of."""
    there = [way for floor in view.elsewhere for way in (*floor.way, *floor.stairs)]
    return [*view.ways_out, *there]


def _block(value: Any, overview: Overview, _goal: Any, excluded: frozenset[int]) -> BlockChoice:
    value = checked(value, BlockChoice)
    free = [block.number for block in overview.blocks if block.number not in excluded]
    if value.number is not None and value.number not in free:
        free = [block.number for block in overview.everywhere if block.number not in excluded]
    fits = value.number is None or value.number in free
    _expect(fits, value.number, f"None or one of {free}", "a BlockChoice of the number ")
    return value


def _arrows(value: Any, view: ArrowView, *_: Any) -> ArrowChoice:
    value = checked(value, ArrowChoice)
    numbers = [TURN_AROUND, *(arrow.number for arrow in view.arrows)]
    fits = all(one in numbers for one in value.numbers)
    _expect(fits, value.numbers, f"a tuple of some of {numbers}", "an ArrowChoice of ")
    return value


def _direction(value: Any, *_: Any) -> GuideChoice:
    return checked(value, GuideChoice)


def _score(value: Any, *_: Any) -> float:
    _expect(_is_number(value, -_ROUNDING, 1.0 + _ROUNDING), value, "a number from 0 to 1")
    return float(value)


def _vectors(value: Any, given: Any) -> np.ndarray:
    is_one = type(value) is np.ndarray and value.ndim == 2 and value.size > 0
    is_one = is_one and np.issubdtype(value.dtype, np.floating)
    _expect(is_one, value, "an array of floating-point numbers with the shape (vectors, numbers)")
    texts = None if isinstance(given, np.ndarray) else len(given)
    _expect(texts in (None, len(value)), value, f"a vector for each of {texts} texts")
    with np.errstate(over="ignore"):
        lengths = np.linalg.norm(value.astype(np.float64), axis=1)
    shortest, longest = _LENGTHS
    fits = bool(((lengths > shortest) & (lengths < longest)).all())
    _expect(fits, value, "finite vectors, none of length 0", "no direction in ")
    return value.astype(np.float32)


def _yes_or_no(value: Any, *_: Any, where: str = "") -> bool:
    _expect(isinstance(value, bool | np.bool_), value, "True or False", where)
    return bool(value)


def _curve(value: Any, *_: Any) -> Curve:
    try:
        return _CURVE.validate_python(value)
    except ValidationError:
        _expect(False, value, "points (score, weight), the scores rising")
        raise


def _weight(value: Any, *_: Any) -> float:
    _expect(_is_number(value, -10.0, 0.0), value, "a number from -10 to 0")
    return float(value)


def _report(value: Any, *_: Any) -> dict[str, Any]:
    _expect(isinstance(value, dict), value, "a dict of JSON values")
    try:
        json.dumps(value, allow_nan=False, ensure_ascii=False).encode()
    except (TypeError, ValueError, RecursionError) as error:
        raise ValueFault(f"{_shown(value)}; expected JSON values ({error})") from None
    return value


def _of(kind: type, *, or_none: bool = False) -> Check:
    """A check that a value is of a class."""

    def check(value: Any, *_: Any) -> Any:
        fits = isinstance(value, kind) or (or_none and value is None)
        _expect(fits, value, f"{kind.__name__}{' or None' if or_none else ''}")
        return value

    return check


_FLAGS = (
    *("looks_at_colours", "looks_closer", "gives_masks"),
    *("answers_at_once", "wants_named_things"),
)
_VALUES = frozenset({*_FLAGS, "warning", "last_step", "grid", "embodiment"})
"""Attributes that are no methods."""
_ALL: dict[str, Check] = {
    "take_report": _report,
    "warning": _of(str),
    **dict.fromkeys(_FLAGS, _yes_or_no),
}
_AGENT: dict[str, Check] = {
    "act": _action,
    "last_step": _of(StepTrace),
    "grid": _of(OccupancyGrid, or_none=True),
    "embodiment": _of(Embodiment),
}
CHECKS: dict[str, dict[str, Check]] = {
    "Agent": _ALL | _AGENT,
    "Detector": _ALL
    | {
        "detect": _detections,
        "name_things": _things,
        "things_in": _detections,
        "score_weights": _curve,
        "missed_weight": _weight,
    },
    "Segmenter": _ALL | {"segment": _mask, "segment_point": _mask},
    "Explorer": _ALL | {"next_destination": _destination},
    "BlockReasoner": _ALL | {"choose": _block},
    "ArrowReasoner": _ALL | {"choose": _arrows},
    "Guide": _ALL | {"direct": _direction},
    "SceneScorer": _ALL | {"score": _score},
    "ImageTextModel": _ALL | {"image_vectors": _vectors, "text_vectors": _vectors},
    "PresenceCheck": _ALL | {"is_present": _yes_or_no},
}
"""The checks of each protocol, by the names of its methods and of what else it may have."""


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
                elsewhere=[_copied(one) for one in given.elsewhere],
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
        if attribute in _VALUES or not callable(value):
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
