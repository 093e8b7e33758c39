"""What episodes cost, in reports."""

import pytest

from eval_runs import record
from hypernav.app.build.components.registries import REASONERS, SCORERS
from hypernav.lab.evaluation.failures import Failure
from hypernav.lab.evaluation.report.report_page import write_report
from hypernav.lab.evaluation.report.report_text import warnings
from hypernav.lab.evaluation.report.run_data import call_axis, costs, load_runs
from hypernav.lab.evaluation.run_plan import RunPlan
from hypernav.lab.evaluation.store.run_store import RunStore

WHO = {"preset": "default", "detector": "ground truth", "reasoner": "geometric", "parts": {}}


def run_of(folder, *records, agent="hypernav"):
    configuration = RunPlan("houses-val", who={"agent": agent, **WHO}).configuration([])
    configuration["episodes"] |= {"count": len(records), "scenes": 1}
    with RunStore(folder, configuration) as store:
        for line in records:
            store.add(line)
    return folder


def test_costs_are_means_over_episodes(tmp_path):
    asked = run_of(
        tmp_path / "asked",
        record("0", path_length_m=4.0, model_calls=8, tokens_in=100, tokens_out=10),
        record("1", path_length_m=2.0, model_calls=2, failure=Failure.NEVER_SEEN, stopped=False),
    )
    (row,) = costs(load_runs([asked]))
    assert (row.metres, row.calls, row.tokens, row.success) == (3.0, 5.0, 55.0, 0.5)


def test_more_calls_are_further_to_the_right_and_none_at_the_left(tmp_path):
    runs = load_runs(
        [
            run_of(tmp_path / "none", record("0"), agent="frontier"),
            run_of(tmp_path / "few", record("0", model_calls=2)),
            run_of(tmp_path / "many", record("0", model_calls=200), agent="pivot"),
        ]
    )
    axis = call_axis(costs(runs))
    assert axis is not None
    assert axis.places[0] == 0.0 < axis.places[1] < axis.places[2] < 1.0
    assert dict(axis.ticks)[300] == pytest.approx(1.0)
    page = write_report(tmp_path / "out", runs).read_text()
    assert "Against model calls an episode" in page


@pytest.mark.parametrize(
    "reasoner", [SCORERS.find("truth").words(), REASONERS.find("noisy:1").words()]
)
def test_a_reader_is_told_of_what_stands_in_for_a_model(tmp_path, reasoner):
    folder = tmp_path / "told"
    who = {"agent": "vlfm", **WHO, "reasoner": reasoner}
    with RunStore(folder, RunPlan("houses-val", who=who).configuration([])) as store:
        store.add(record("0"))
    (warning,) = [one for one in warnings(load_runs([folder])) if "in place of a model" in one]
    assert f"vlfm reasons by {reasoner}" in warning


def test_without_any_call_there_is_nothing_to_draw(tmp_path):
    runs = load_runs([run_of(tmp_path / "none", record("0"))])
    assert call_axis(costs(runs)) is None
    page = write_report(tmp_path / "out", runs).read_text()
    assert "Cost of an episode" in page
    assert "Against model calls" not in page
