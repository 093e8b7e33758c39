import json
from typing import Any

import pytest

from certainty import certain
from eval_runs import apart, record
from hypernav.core.episode import Outcome
from hypernav.core.errors import RunFolderError
from hypernav.lab.evaluation.failures import RULES, Failure
from hypernav.lab.evaluation.protocol import StopRule
from hypernav.lab.evaluation.report import report_text, tables
from hypernav.lab.evaluation.report.published_results import PUBLISHED
from hypernav.lab.evaluation.report.report_page import tex, write_report
from hypernav.lab.evaluation.report.run_data import load_runs
from hypernav.lab.evaluation.run_plan import RunPlan
from hypernav.lab.evaluation.store.run_store import RunStore

WHO = {
    "agent": "hypernav",
    "preset": "default",
    "detector": "ground truth",
    "reasoner": "geometric",
    "parts": {"detector": "ground-truth"},
}


def missed(episode_id, scene_id, failure=Failure.NEVER_SEEN, **values):
    return record(episode_id, scene_id, failure=failure, stopped=False, **values)


def written(folder, records, agent="hypernav", wanted=None, **who):
    configuration = RunPlan("houses-val", who=WHO | {"agent": agent} | who).configuration([])
    configuration["episodes"] |= {"count": wanted or len(records), "scenes": 2}
    with RunStore(folder, configuration) as store:
        for line in records:
            store.add(line)
    return folder


@pytest.fixture
def good(tmp_path):
    records = [
        record("0", "a", goal="bed", shortest_path_m=2.0, path_length_m=4.0),
        record("1", "a", goal="sofa", shortest_path_m=6.0, path_length_m=6.0),
        record("0", "b", goal="bed", shortest_path_m=20.0, path_length_m=40.0),
        missed("1", "b", goal="bed", shortest_path_m=4.0, distance_to_goal_m=0.22),
    ]
    return written(tmp_path / "good", records)


@pytest.fixture
def bad(tmp_path):
    records = [
        missed("0", "a", goal="bed"),
        record("1", "a", goal="sofa"),
        missed("0", "b", Failure.STOPPED_TOO_FAR, goal="bed"),
        apart("1", "b"),
    ]
    return written(tmp_path / "bad", records, agent="frontier", wanted=9)


def test_groups_by_hand(good):
    runs = load_runs([good])
    by_scene = {g.name: (g.count, certain(g.success[0]).mean) for g in tables.by_scene(runs)}
    assert by_scene == {"a": (2, 1.0), "b": (2, 0.5)}
    assert [(g.name, g.count) for g in tables.by_goal(runs)] == [("bed", 3), ("sofa", 1)]
    assert certain(tables.by_goal(runs)[0].spl[0]).mean == pytest.approx((0.5 + 0.5 + 0.0) / 3)
    assert [(g.name, g.count) for g in tables.by_distance(runs)] == [
        ("under 3 m", 1),
        ("3 to 5 m", 1),
        ("5 to 8 m", 1),
        ("12 m and more", 1),
    ]
    assert tables.by_part(runs) == []


def test_every_protocol_is_scored_from_the_same_lines(good):
    matrix = tables.protocol_matrix(load_runs([good])[0])
    strict, lax = (
        [None if summary is None else summary.success.mean for _, summary in matrix[rule]]
        for rule in StopRule
    )
    assert strict == [0.75] * 5 + [None]  # nobody measured the distance to the object
    assert lax == [0.75, 0.75, 1.0, 1.0, 1.0, None]  # 0.22 m away when time ran out


def test_failures_are_shares_of_what_counts_and_outages_stand_apart(good, bad):
    rows = tables.failures(load_runs([good, bad]))
    assert [(row.failure, row.counts) for row in rows] == [
        (Failure.NEVER_SEEN, [1, 1]),
        (Failure.STOPPED_TOO_FAR, [0, 1]),
        (Failure.MODEL_UNAVAILABLE, [0, 1]),
    ]
    assert rows[0].shares == [0.25, pytest.approx(1 / 3)]
    assert rows[2].shares == [0.0, 0.25]


def test_metres_by_hand(tmp_path):
    found: dict[str, Any] = {"shortest_path_m": 4.0, "explored_m": 6.0}
    records = [
        record("0", **found, approached_m=3.0, shortest_from_sight_m=2.0),
        record("1", **found, approached_m=1.0, shortest_from_sight_m=2.0),
        missed("2", "house", **found, approached_m=90.0, shortest_from_sight_m=2.0),
        missed("3", "house"),
    ]
    (row,) = tables.metres(load_runs([written(tmp_path, records)]))
    assert (row.explored.mean, row.explored.count) == (18.0 / 12.0, 3)
    assert (row.approached.mean, row.approached.count) == (1.0, 2)
    assert row.unseen.mean == 0.25


def test_without_a_sight_of_the_goal_there_are_no_metres_to_divide(tmp_path):
    (row,) = tables.metres(load_runs([written(tmp_path, [missed("0", "house")])]))
    assert (row.explored.count, row.approached.count, row.unseen.mean) == (0, 0, 1.0)


def test_runs_are_paired_by_episode_and_only_where_both_count(good, bad):
    pair = tables.pair(*load_runs([good, bad]))
    assert pair.count == 3
    assert pair.success.difference.mean == pytest.approx(-2 / 3)
    assert (pair.outcomes.both, pair.outcomes.only_first) == (1, 2)


def test_time_is_told_by_module_and_the_rest_is_named(good):
    rows = {row.name: row.milliseconds[0] for row in tables.module_times(load_runs([good]))}
    assert rows["world"] == pytest.approx(1000 * 0.6 / 20)
    assert rows["everything else"] == pytest.approx(1000 * 0.3 / 20)


def test_a_reader_is_warned_of_all_that_limits_the_numbers(good, bad):
    said = " ".join(report_text.warnings(load_runs([good, bad])))
    assert "ground-truth detection" in said
    assert "frontier is not finished: 4 of 9" in said
    assert "frontier: 1 episodes ended by a model or simulator outage" in said
    assert "hypernav is not finished" not in said


def test_the_page_is_whole_and_needs_no_network(good, bad, tmp_path):
    runs = load_runs([good, bad])
    page = write_report(tmp_path / "out", runs, pairs=tables.pairs(runs)).read_text()
    for text in ("hypernav", "frontier", "Under every protocol", "The protocol in full"):
        assert text in page
    assert "<script" not in page
    assert 'src="http' not in page
    for row in PUBLISHED:
        assert row.method in page
        assert row.url in page


def test_a_page_is_the_same_for_the_same_folders(good, tmp_path):
    first = write_report(tmp_path / "1", load_runs([good])).read_text()
    assert write_report(tmp_path / "2", load_runs([good])).read_text() == first


def test_two_runs_of_one_agent_are_told_apart_by_their_folders(good, tmp_path):
    other = written(tmp_path / "again", [record("0", "a")])
    assert [run.name for run in load_runs([good, other])] == ["good", "again"]


def test_a_goal_is_text_and_never_markup(tmp_path):
    folder = written(tmp_path / "odd", [record(goal="<b>bed</b> & 50 %_$")])
    write_report(tmp_path / "out", load_runs([folder]))
    assert "<b>bed</b>" not in (tmp_path / "out" / "report.html").read_text()
    assert tex("50 %_$&#{}") == r"50 \%\_\$\&\#\{\}"


def test_runs_without_a_common_episode_cannot_be_compared(good, tmp_path):
    other = written(tmp_path / "other", [record("9", "z")], agent="frontier")
    with pytest.raises(RunFolderError, match="no episode in common"):
        tables.pairs(load_runs([good, other]))


def test_a_run_of_outages_alone_says_so(tmp_path):
    with pytest.raises(RunFolderError, match="no episode that counts"):
        load_runs([written(tmp_path / "away", [apart()])])


def test_every_class_has_a_rule_and_words_for_people():
    assert {failure for failure, _ in RULES} == set(Failure) == set(report_text.RULES_IN_WORDS)


def test_published_numbers_name_their_source_and_what_differs():
    for row in PUBLISHED:
        assert 0.0 < row.spl_percent < row.success_percent < 100.0
        assert not row.url or row.url.startswith("https://")
        assert row.protocol
        assert row.source


def test_the_rows_of_the_paper_say_what_its_totals_are_of():
    rows = [row for row in PUBLISHED if row.method == "HyPerNav"]
    assert [(row.success_percent, row.spl_percent) for row in rows] == [
        (53.4, 35.8),
        (65.4, 43.7),
        (80.0, 50.0),
        (60.0, 42.0),
    ]
    assert "10 scenes" in rows[0].dataset
    assert "12 scenes" in rows[1].dataset
    assert {row.method: row.step_seconds for row in PUBLISHED if row.step_seconds} == {
        "HyPerNav": 1.2,
        "NavVLM": 3.3,
    }


def test_a_line_holds_all_numbers_of_an_episode(good):
    line = json.loads((good / "episodes.jsonl").read_text().splitlines()[0])
    assert {
        "scene_id", "episode_id", "goal", "outcome", "failure", "success", "spl", "soft_spl",
        "distance_to_goal_m", "steps", "path_length_m", "model_calls", "seconds",
    } <= set(line)  # fmt: skip
    assert line["outcome"] == Outcome.FOUND


def test_a_run_of_an_older_version_is_refused_with_the_reason(good):
    path = good / "run.json"
    content = json.loads(path.read_text())
    del content["configuration"]["config"]["embodiment"]
    path.write_text(json.dumps(content))
    with pytest.raises(RunFolderError, match="of an older version of hypernav"):
        load_runs([good])


def test_intervals_do_not_depend_on_which_worker_was_done_first(tmp_path):
    lengths = [4.0 + 0.37 * k**1.5 for k in range(30)]
    records = [record(str(k), "house", path_length_m=length) for k, length in enumerate(lengths)]
    runs = load_runs(
        [written(tmp_path / "a", records), written(tmp_path / "b", [*records[3:], *records[:3]])]
    )
    first, second = (tables.overall([run]) for run in runs)
    assert first == second


def test_native_and_common_mode_share_no_report(tmp_path, good):
    native = written(
        tmp_path / "native",
        [record("0", "a", goal="bed")],
        agent="vlmnav (native)",
        parts={"detector": "none", "vlm": None, "mode": "native"},
    )
    with pytest.raises(RunFolderError, match="make a report of each mode"):
        load_runs([good, native])
    (run,) = load_runs([native])
    assert run.name == "vlmnav (native)"
    assert run.is_told_truth  # no model says when to stop
    assert any("native mode" in warning for warning in report_text.warnings([run]))
    assert not load_runs([good])[0].is_native


def test_runs_with_the_mistakes_of_released_code_are_called_so(tmp_path, good):
    records = [record("0", "a", goal="bed")]
    released = written(tmp_path / "x", records, agent="pivot", preset="pivot-as-released")
    paper = written(tmp_path / "y", records, preset="paper")
    runs = load_runs([good, released, paper])
    assert [run.name for run in runs] == [
        "hypernav",
        "pivot (pivot-as-released)",
        "hypernav (paper)",
    ]
    told = [text for text in report_text.warnings(runs) if "released code" in text]
    assert len(told) == 1
    assert told[0].startswith("pivot (pivot-as-released) ")


def test_a_configuration_without_what_reports_read_is_refused(good):
    path = good / "run.json"
    whole = json.loads(path.read_text())
    values = {
        "hypernav": 1,
        "dataset": None,
        "who": "x",
        "who.agent": [],
        "episodes.count": 10**400,
        "protocol.success_distance_m": "far",
        "protocol.stop_rule": "x",
        "config": {},
        "config.embodiment.camera.width": "640",
        "config.world.noise": [],
    }
    for key, value in values.items():
        changed = json.loads(json.dumps(whole))
        *sections, name = key.split(".")
        within = changed["configuration"]
        for section in sections:
            within = within[section]
        within[name] = value
        path.write_text(json.dumps(changed))
        with pytest.raises(RunFolderError, match=f"'{key}.*' of its configuration"):
            load_runs([good])
    del whole["configuration"]["config"]["embodiment"]["motion"]
    path.write_text(json.dumps(whole))
    write_report(good, load_runs([good]))  # by the values that are the default
