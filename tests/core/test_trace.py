"""What is written of a step, and what is left out."""

import json

import pytest

from hypernav.core.trace import Mode, StepTrace


def step(z: float = 0.0) -> StepTrace:
    return StepTrace(step=0, pose=(1.0, 2.0, 0.5), z=z, action=None, mode=Mode.EXPLORE)


def test_a_height_reads_back_to_the_millimetre() -> None:
    written = step(z=1.23456).model_dump_json()
    assert json.loads(written)["z"] == 1.235
    assert StepTrace.model_validate_json(written).z == 1.235


@pytest.mark.parametrize("z", [0.0, 0.02, -0.04])
def test_a_step_on_the_level_of_the_start_is_written_as_if_there_were_no_heights(z: float) -> None:
    written = step(z=z).model_dump_json()
    assert written == step().model_dump_json()
    assert "z" not in json.loads(written)
    assert StepTrace.model_validate_json(written).z == 0.0
