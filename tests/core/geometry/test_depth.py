import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.core.geometry.depth import is_measured
from hypernav.search.mapping.top_down_kernels import is_measured as compiled

depths = st.floats()


@pytest.mark.parametrize("depth", [0.0, -1.0, math.nan, math.inf, -math.inf])
def test_what_is_no_return_is_never_a_measurement(depth):
    assert not is_measured(depth)
    assert not is_measured(depth, 0.5, 5.0)


@pytest.mark.parametrize(
    ("depth", "answer"), [(0.49, False), (0.5, False), (0.51, True), (4.99, True), (5.0, False)]
)
def test_a_limit_of_the_range_is_no_measurement(depth, answer):
    assert is_measured(depth, 0.5, 5.0) == answer


@given(st.lists(depths), st.floats(0.0, 2.0), st.floats(2.0, 20.0))
def test_numbers_and_arrays_follow_one_rule(values, nearest_m, farthest_m):
    measured = is_measured(np.array(values, dtype=np.float64), nearest_m, farthest_m)
    assert measured.tolist() == [is_measured(depth, nearest_m, farthest_m) for depth in values]


def test_the_map_s_kernels_compile_that_rule():
    values = [0.0, 0.5, 0.51, 4.99, 5.0, 9.0, math.nan, math.inf]
    assert [compiled(d, 0.5, 5.0) for d in values] == [is_measured(d, 0.5, 5.0) for d in values]
