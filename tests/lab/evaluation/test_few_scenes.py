"""What is said where there are few scenes or episodes."""

from pathlib import Path

import pytest

from eval_runs import record
from hypernav.lab.evaluation.report.report_text import lead, verdict
from hypernav.lab.evaluation.report.run_data import RunData
from hypernav.lab.evaluation.report.tables import Pair
from hypernav.lab.evaluation.statistics import compare, discordance, summarise


def said_of(scenes: int) -> str:
    """The verdict on a run that is better by far in every scene."""
    first, second = [0.1] * scenes, [0.9] * scenes
    names = [f"houses:{k}" for k in range(scenes)]
    gap = compare(first, second, names)
    pair = Pair(
        "a",
        "b",
        scenes,
        gap,
        gap,
        gap,
        gap,
        discordance([False] * scenes, [True] * scenes),
        "scenes",
    )
    return verdict(pair)


@pytest.mark.parametrize("scenes", [2, 3, 5])
def test_few_scenes_are_named_as_the_reason(scenes: int) -> None:
    said = said_of(scenes)
    assert "no difference in SPL is shown" in said
    assert "With so few scenes p is never below 0." in said


def test_six_are_enough() -> None:
    said = said_of(6)
    assert "its SPL is 0.800 higher" in said
    assert "few scenes" not in said


@pytest.mark.parametrize(
    ("count", "scenes", "is_said"), [(4, 1, False), (5, 1, True), (40, 2, False), (40, 5, True)]
)
def test_so_few_episodes_or_scenes_have_no_interval(count: int, scenes: int, is_said: bool) -> None:
    records = [record(str(number), f"houses:{number % scenes}") for number in range(count)]
    run = RunData(Path("runs/ours"), "ours", {}, records, [])
    assert ("interval" in lead([run], [summarise(records)])) == is_said
