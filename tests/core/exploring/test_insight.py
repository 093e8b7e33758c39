"""What an explorer looked at, in the trace."""

import json

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from hypernav.core.embodiment import Action
from hypernav.core.exploring.insight import ImageMark, Insight, ValueImage
from hypernav.core.trace import Mode, StepTrace


@given(st.lists(st.one_of(st.just(float("nan")), st.floats(0.0, 1.0)), min_size=6, max_size=6))
def test_values_come_back_to_one_part_in_254(numbers):
    values = np.array(numbers, dtype=np.float32).reshape(2, 3)
    grades = ValueImage.of(values, (0.0, 0.0), 0.2).grades
    assert ((grades == 0) == np.isnan(values)).all()
    known = grades > 0
    np.testing.assert_allclose((grades[known] - 1.0) / 254.0, values[known], atol=0.5 / 254 + 1e-6)


def traced(**values) -> StepTrace:
    return StepTrace(
        step=0, pose=(0.0, 0.0, 0.0), action=Action.TURN_LEFT, mode=Mode.EXPLORE, **values
    )


def test_a_trace_without_insight_is_written_as_if_there_were_no_such_field():
    assert "insight" not in traced().model_dump()
    assert "insight" not in json.loads(traced().model_dump_json(exclude={"seconds"}))


def test_a_trace_with_insight_is_read_as_it_was_written():
    shown = ValueImage.of(np.array([[0.5]], np.float32), (1.0, 2.0), 0.2)
    marks = [ImageMark(number=1, pixel=(3.0, 4.0), chosen=True)]
    step = traced(insight=Insight(marks=marks, values=shown))
    assert StepTrace.model_validate_json(step.model_dump_json()) == step
