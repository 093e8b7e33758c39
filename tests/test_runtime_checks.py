"""The tests check types at run time; what they would not notice is noted here."""

import importlib
import sys
from collections.abc import Callable, Iterator

import pytest
from beartype.roar import BeartypeCallHintViolation

from runtime_checks import check_modules

_MODULE = '''"""A module to be checked."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

Rows = Float64[np.ndarray, "n 3"]


def whole(number: int) -> int:
    return number


def real(number: float) -> float:
    return number


def wrong() -> int:
    return "text"


def joined(first: Rows, second: Float64[np.ndarray, "n"]) -> None:
    pass


def first(rows: list[Rows] | None) -> Float64[np.ndarray, "n"]:
    return np.zeros(5)


def cut(rows: Rows) -> Rows:
    return rows[1:]


def each(rows: Rows) -> Iterator[Rows]:
    yield rows[1:]


def outer():
    def inner(number: int) -> None:
        pass

    inner("text")


@dataclass(frozen=True)
class Point:
    x: float

    def moved(self, dx: float) -> "Point":
        return Point(self.x + dx)

    @property
    def label(self) -> str:
        return 5

    @staticmethod
    def at(x: float) -> float:
        return "text"


def later(known: "Nowhere", number: int) -> None:
    pass


@dataclass(frozen=True)
class Cloud:
    points: Rows
    weights: Float64[np.ndarray, "n"]
'''
_REFUSED: dict[str, Callable] = {
    "an argument": lambda m: m.whole("text"),
    "an argument beside one of an unknown type": lambda m: m.later(5, "text"),
    "a result": lambda m: m.wrong(),
    "two shapes that differ": lambda m: m.joined(m.np.zeros((2, 3)), m.np.zeros(3)),
    "a shape in a union": lambda m: m.first([m.np.zeros((2, 4))]),
    "a result of another shape than its argument": lambda m: m.cut(m.np.zeros((2, 3))),
    "a function in a function": lambda m: m.outer(),
    "a method": lambda m: m.Point(1.0).moved("text"),
    "a property": lambda m: m.Point(1.0).label,
    "a static method": lambda m: m.Point.at(1.0),
    "a field": lambda m: m.Point("text"),
    "two fields whose shapes differ": lambda m: m.Cloud(m.np.zeros((2, 3)), m.np.zeros(3)),
}


@pytest.fixture(scope="module")
def checked_module(tmp_path_factory: pytest.TempPathFactory) -> Iterator[object]:
    folder = tmp_path_factory.mktemp("modules")
    (folder / "module_to_be_checked.py").write_text(_MODULE)
    finders = list(sys.meta_path)
    sys.path.insert(0, str(folder))
    check_modules(["module_to_be_checked"])
    yield importlib.import_module("module_to_be_checked")
    sys.meta_path[:] = finders
    sys.path.remove(str(folder))
    del sys.modules["module_to_be_checked"]


@pytest.mark.parametrize("name", _REFUSED)
def test_what_does_not_fit_its_type_is_refused(checked_module, name):
    with pytest.raises(BeartypeCallHintViolation):
        _REFUSED[name](checked_module)


def test_what_fits_is_let_through(checked_module):
    zeros = checked_module.np.zeros
    assert checked_module.real(1) == 1  # an int is a float, as in Python's own rules
    assert checked_module.joined(zeros((2, 3)), zeros(2)) is None
    assert [rows.shape for rows in checked_module.each(zeros((2, 3)))] == [(1, 3)]
    assert checked_module.later(5, 5) is None
    assert checked_module.Point(1).moved(2.0).x == 3.0
    assert checked_module.Cloud(zeros((2, 3)), zeros(2)).weights.shape == (2,)
