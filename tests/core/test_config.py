import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import TypeAdapter, ValidationError

from hypernav.core.config import Curve, along

numbers = st.floats(-100.0, 100.0)
curves = st.dictionaries(numbers, numbers, min_size=1, max_size=6).map(
    lambda points: tuple(sorted(points.items()))
)


@given(curves, numbers)
def test_a_curve_passes_its_points_and_stays_between_them(curve, x):
    assert all(along(curve, at) == pytest.approx(y) for at, y in curve)
    lowest, highest = min(y for _, y in curve), max(y for _, y in curve)
    assert lowest - 1e-9 <= along(curve, x) <= highest + 1e-9


def test_points_out_of_order_are_refused():
    with pytest.raises(ValidationError, match="must rise"):
        TypeAdapter(Curve).validate_python(((1.0, 0.0), (1.0, 1.0)))
