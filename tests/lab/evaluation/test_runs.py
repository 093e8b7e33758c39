"""Runs as Python programs use them: by text paths, as tables, as reports."""

import math
from typing import Any

import pytest

from eval_runs import apart, record
from hypernav.core.errors import RunFolderError
from hypernav.lab.evaluation.failures import Failure
from hypernav.lab.evaluation.report.run_data import load_runs
from hypernav.lab.evaluation.run_plan import RunPlan
from hypernav.lab.evaluation.runner import RunProgress
from hypernav.lab.evaluation.store.run_store import RunStore

WHO = {"preset": "default", "detector": "ground truth", "reasoner": "geometric", "parts": {}}


@pytest.fixture
def folders(tmp_path):
    """Two runs over the same episodes; the second one fails in one, and an outage ends another."""
    ours = [record("0"), record("1", spl=1.0), record("2")]
    theirs = [
        record("0"),
        record("1", failure=Failure.NEVER_SEEN, distance_to_goal_m=math.inf),
        apart("2"),
    ]
    for agent, records in (("hypernav", ours), ("frontier", theirs)):
        configuration = RunPlan("houses-val", who={"agent": agent, **WHO}).configuration([])
        configuration["episodes"] |= {"count": 3, "scenes": 1}
        with RunStore(tmp_path / agent, configuration) as store:
            for one in records:
                store.add(one)
    return [str(tmp_path / "hypernav"), str(tmp_path / "frontier")]


def test_folders_are_texts_or_paths_several_or_one(folders):
    assert [run.name for run in load_runs(folders)] == ["hypernav", "frontier"]
    assert [run.name for run in load_runs(iter(folders))] == ["hypernav", "frontier"]
    assert [run.name for run in load_runs(folders[0])] == ["hypernav"]


def test_a_folder_that_holds_no_run_is_named(tmp_path):
    with pytest.raises(RunFolderError, match="nowhere"):
        load_runs([str(tmp_path / "nowhere")])


def test_they_show_themselves_as_a_table_of_the_episodes_that_count(folders):
    shown = load_runs(folders)._repr_html_()
    assert "<td>hypernav</td><td>3</td><td>1.00</td><td>0.67</td>" in shown
    assert "<td>frontier</td><td>2</td><td>0.50</td><td>0.25</td>" in shown


def test_they_save_a_report_that_compares_them(folders, tmp_path):
    page = load_runs(folders).save(str(tmp_path / "report"))
    assert page == tmp_path / "report" / "report.html"
    assert (tmp_path / "report" / "report.csv").exists()
    assert "frontier" in page.read_text("utf-8")


def test_episodes_become_rows(folders):
    pandas = pytest.importorskip("pandas")
    frame: Any = load_runs(folders).to_pandas()
    assert isinstance(frame, pandas.DataFrame)
    assert frame["run"].tolist() == ["hypernav"] * 3 + ["frontier"] * 3
    assert frame.loc[1, ["outcome", "spl", "success"]].tolist() == ["found", 1.0, True]
    assert math.isinf(frame.loc[4, "distance_to_goal_m"])
    assert frame.groupby("run")["spl"].max().to_dict() == {"hypernav": 1.0, "frontier": 0.5}


def test_what_an_evaluation_returns_shows_its_episodes():
    progress = RunProgress([record("0", why="<none>")], total=4)
    shown = progress._repr_html_()
    assert "1 of 4 episodes" in shown
    assert "&lt;none&gt;" in shown
    pandas = pytest.importorskip("pandas")
    assert isinstance(progress.to_pandas(), pandas.DataFrame)
    assert progress.to_pandas()["goal"].tolist() == ["bed"]
