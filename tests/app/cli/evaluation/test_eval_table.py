"""The lines at the end of an evaluation."""

from pathlib import Path

import pytest

from eval_runs import apart, record
from hypernav.app.cli.evaluation.eval import outcome_lines, progress_table, result_line
from hypernav.lab.evaluation.runner import RunProgress
from hypernav.lab.evaluation.statistics import interval, summarise


def lines(*records):
    progress = RunProgress(total=len(records), records=list(records))
    return list(outcome_lines(progress, Path("runs/x")))


def test_why_episodes_do_not_count_is_said_once_for_each_reason():
    reasons = ["no scene here", "no scene here", "[b]no model[/b]", "third", "fourth"]
    broken = [apart(str(k)).model_copy(update={"why": why}) for k, why in enumerate(reasons)]
    said = [line for line in lines(record("9"), *broken) if "doesn't count" in line]
    assert [line.rpartition("[/]: ")[2] for line in said] == [
        "no scene here",
        r"\[b]no model\[/b]",
        "third",
    ]


def test_nothing_is_said_where_all_count():
    assert not any("count" in line for line in lines(record("0"), record("1")))


def test_the_interval_is_that_of_the_report_whatever_the_order():
    goals = [record(str(k), "scene", path_length_m=4.0 + k) for k in range(8)]
    expected = interval(
        summarise(goals).spl, words="({} to {} with 95 % confidence, over episodes)"
    )
    for order in (goals, goals[::-1]):
        (line,) = [line for line in lines(*order) if "SPL" in line]
        assert line.endswith(expected)


@pytest.mark.parametrize(("scenes", "said"), [(5, 2), (2, 0)])
def test_the_interval_is_over_scenes_where_there_are_several_and_needs_five(scenes, said):
    goals = [record(str(k), f"scene {k % scenes}") for k in range(10)]
    assert "".join(lines(*goals)).count("over scenes)") == said


def test_so_few_episodes_have_no_interval_on_the_screen_either():
    assert "confidence" not in "".join(lines(*[record(str(k)) for k in range(4)]))


def test_where_none_counts_there_is_no_rate():
    said = lines(apart("0"), apart("1"))
    assert not any("nan" in line or "SR" in line for line in said)
    progress = RunProgress(total=2, records=[apart("0"), apart("1")])
    assert result_line(progress) == "2 of 2 episodes done, none of them counts"
    assert progress_table(progress, 1.0).row_count == 2
