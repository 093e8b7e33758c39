"""Reports of runs with lives: by number of the goal, and paired with a run without memory."""

import csv
import json
from dataclasses import replace

import pytest

from certainty import certain
from eval_runs import apart, record, spec
from hypernav.lab.evaluation.failures import Failure
from hypernav.lab.evaluation.report import lives
from hypernav.lab.evaluation.report.report_page import write_report
from hypernav.lab.evaluation.report.run_data import load_runs
from hypernav.lab.evaluation.report.tables import pairs
from hypernav.lab.evaluation.run_plan import RunPlan
from hypernav.lab.evaluation.store.run_store import RunStore

WHO = {
    "agent": "hypernav",
    "preset": "default",
    "detector": "ground truth",
    "reasoner": "geometric",
}
SPLS = {"a": (0.4, 0.8, 0.9), "b": (0.6, 0.6)}
"""SPL of every goal of the lives with memory."""


def goal(life, number, spl, **values):
    shortest = 4.0
    lengths = {"shortest_path_m": shortest, "path_length_m": shortest / spl, "spl": spl}
    named = {"life": life, "goal_number": number}
    return record(f"{life}.{number}", life, **named, **lengths, **values)


def goals(factor=1.0, spls=None):
    return [
        goal(life, number, spl * (factor if number > 1 else 1.0))
        for life, values in (spls or SPLS).items()
        for number, spl in enumerate(values, start=1)
    ]


def written(folder, records, *, fresh=False, **who):
    episodes = [replace(spec(r.episode_id, r.scene_id), life=r.life) for r in records]
    plan = RunPlan("houses-life-train", who=WHO | who, fresh_memory=fresh)
    with RunStore(folder, plan.configuration(episodes)) as store:
        for line in records:
            store.add(line)
    return folder


@pytest.fixture
def runs(tmp_path):
    fresh = written(tmp_path / "fresh", goals(0.5), fresh=True)
    return load_runs([fresh, written(tmp_path / "kept", goals())])


def test_goals_are_grouped_by_their_number_and_all_later_ones_together(runs):
    rows = lives.by_goal_number([runs[1]])
    assert [row.name for row in rows] == ["1", "2", "3", lives.LATER]
    assert [certain(row.spl[0]).mean for row in rows] == pytest.approx([0.5, 0.7, 0.9, 2.3 / 3])
    assert [certain(row.spl[0]).count for row in rows] == [2, 2, 1, 3]


def test_memory_is_compared_with_none_goal_by_goal(runs):
    pairs = lives.paired_by_goal_number(*runs)
    assert [certain(pair.spl_ratio).mean for pair in pairs] == pytest.approx([1.0, 2.0, 2.0, 2.0])
    assert [pair.count for pair in pairs] == [2, 2, 1, 3]
    assert all(pair.success.difference.mean == 0.0 for pair in pairs)


def test_goals_that_count_in_one_run_only_are_left_out_of_the_pairs(tmp_path, runs):
    away = [apart("a.3", "a").model_copy(update={"life": "a", "goal_number": 3})]
    short = written(tmp_path / "short", [r for r in goals() if r.episode_id != "a.3"] + away)
    (other,) = load_runs([short])
    assert [pair.name for pair in lives.paired_by_goal_number(runs[0], other)] == [
        *("1", "2", lives.LATER)
    ]


def test_a_ratio_to_nothing_is_none(tmp_path):
    missed = [
        r.model_copy(update={"success": False, "stopped": False, "failure": Failure.NEVER_SEEN})
        for r in goals()
    ]
    none, kept = written(tmp_path / "none", missed, fresh=True), written(tmp_path / "kept", goals())
    pairs = lives.paired_by_goal_number(*load_runs([none, kept]))
    assert [pair.spl_ratio for pair in pairs] == [None] * 4


def test_a_life_is_the_sum_of_its_goals(runs):
    first, second = lives.life_records(runs[1])
    assert (first.life, first.goals, first.found, first.steps) == ("a", 3, 3, 60)
    assert first.spl == pytest.approx(0.7)
    assert second.share_found == 1.0


def test_a_life_with_a_goal_that_does_not_count_has_no_record(tmp_path):
    away = apart("a.3", "a").model_copy(update={"life": "a", "goal_number": 3})
    (run,) = load_runs([written(tmp_path / "run", [*goals()[:2], *goals()[3:], away])])
    assert [life.life for life in lives.life_records(run)] == ["b"]


def test_the_page_shows_lives_and_says_what_became_of_the_memory(tmp_path, runs):
    page = write_report(tmp_path / "report", runs, pairs=pairs(runs)).read_text()
    assert "By number of the goal in its life" in page
    assert "memory: emptied before each goal" in page
    assert "memory: kept between goals" in page
    content = json.loads((tmp_path / "report" / "lives.json").read_text())
    assert [life["found"] for life in content["runs"]["kept"]] == [3, 2]
    assert content["against_the_first_run"]["kept"][1]["spl_ratio"]["mean"] == pytest.approx(2.0)
    with (tmp_path / "report" / "report.csv").open() as file:
        last = list(csv.DictReader(file))[-1]
    assert (last["life"], last["goal_number"]) == ("b", "2")


def test_a_single_life_of_a_single_run_is_one_and_has_no_pairs(tmp_path, runs):
    alone = written(tmp_path / "alone", goals(spls={"a": SPLS["a"]}))
    page = write_report(tmp_path / "one", load_runs([alone])).read_text()
    assert "1 complete life</summary>" in page
    assert "Behind means 95 % bootstrap intervals over episodes." in page
    assert "Pairs are" not in page
    page = write_report(tmp_path / "both", runs).read_text()
    assert "2 complete lives of kept, one by one" in page
    assert "Pairs are" in page
    assert "Behind means and ratios 95 % bootstrap intervals over scenes." in page


def test_of_runs_that_differ_in_it_each_is_said_to_be_drawn_by_scenes_or_episodes(tmp_path, runs):
    alone = written(tmp_path / "alone", goals(spls={"a": SPLS["a"]}))
    both = load_runs([alone, runs[1].folder])
    page = write_report(tmp_path / "report", both, pairs=pairs(both)).read_text()
    assert "intervals over episodes (alone), scenes (kept)." in page
    assert "episode by episode" in page


def test_runs_without_lives_have_none_of_this(tmp_path):
    alone = record("0")
    folder = tmp_path / "run"
    with RunStore(folder, RunPlan("houses-val", who=WHO).configuration([spec()])) as store:
        store.add(alone)
    page = write_report(folder, load_runs([folder])).read_text()
    assert "By number of the goal" not in page
    assert not (folder / "lives.json").exists()
    assert "goal_number" not in (folder / "report.csv").read_text()


def test_a_run_with_lives_is_shown_beside_others_without(tmp_path, runs):
    folders = tmp_path / "a", tmp_path / "b"
    for folder in folders:
        with RunStore(folder, RunPlan("houses-val", who=WHO).configuration([spec()])) as store:
            store.add(record("0"))
    page = write_report(tmp_path / "report", [*load_runs(folders), runs[1]]).read_text()
    assert "By number of the goal in its life" in page


def test_a_report_says_that_an_agent_keeps_no_memory(tmp_path):
    folder = written(tmp_path / "run", goals(), keeps_memory=False)
    page = write_report(folder, load_runs([folder])).read_text()
    assert "its agent keeps no memory" in page
    assert "memory: none, the agent keeps none" in page
