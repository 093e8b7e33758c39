"""The lines at the end of an evaluation."""

from pathlib import Path

from eval_runs import apart, record
from hypernav.cli.eval_table import outcome_lines
from hypernav.evaluation.runner import RunProgress


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
