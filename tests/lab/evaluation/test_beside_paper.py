"""A run beside the rows of the paper."""

import re

import pytest

from certainty import certain
from eval_runs import record
from hypernav.app.build.presets import HyPerNavConfig, preset
from hypernav.app.cli.main import main
from hypernav.lab.datasets import paper_results
from hypernav.lab.datasets.benchmarks import BENCHMARKS
from hypernav.lab.datasets.paper_results import HM3D, OVON
from hypernav.lab.evaluation.failures import Failure
from hypernav.lab.evaluation.report.published_results import BesidePaper, beside_paper
from hypernav.lab.evaluation.report.report_page import write_report
from hypernav.lab.evaluation.report.run_data import load_runs
from hypernav.lab.evaluation.run_plan import RunPlan
from hypernav.lab.evaluation.store.run_store import RunStore

LIKE_THE_PAPER = {
    "agent": "hypernav",
    "preset": "paper",
    "detector": "QwenVL-7B",
    "reasoner": "QwenVL-7B",
    "segmenter": "MobileSAM",
    "model": "QwenVL-7B",
    "parts": {"detector": "vlm", "vlm": "openai:http://localhost:1/v1"},
}


def scan(number):
    """File of an HM3D scene."""
    return f"data/scene_datasets/hm3d/val/{int(number):05d}-x/x.basis.glb"


def found(episode_id, scene_id, **values):
    return record(episode_id, scene_id, **({"goal": "chair"} | values))


def missed(episode_id, scene_id, **values):
    return found(episode_id, scene_id, failure=Failure.NEVER_SEEN, stopped=False, **values)


def written(folder, records, dataset, benchmark=None, config=None, wanted=None, **who):
    plan = RunPlan(
        dataset,
        who=LIKE_THE_PAPER | who,
        benchmark=benchmark,
        config=config or HyPerNavConfig(),
    )
    configuration = plan.configuration([])
    configuration["episodes"] |= {"count": wanted or len(records), "scenes": 2}
    with RunStore(folder, configuration) as store:
        for line in records:
            store.add(line)
    return folder


def beside(folder, records, dataset="hm3d:data#v1/val", **values) -> BesidePaper:
    return beside_paper(load_runs([written(folder, records, dataset, **values)])[0])


def said(one: BesidePaper) -> str:
    return " ".join(one.differences)


@pytest.fixture
def two_scenes():
    """Half of scene 802 and all of 813 found, and a scene that the paper doesn't list."""
    return [
        found("0", scan(802)),
        missed("1", scan(802)),
        found("0", scan(813)),
        missed("0", scan(800)),
    ]


def test_each_scene_of_the_paper_stands_beside_the_runs_episodes_in_it(tmp_path, two_scenes):
    rows = {row.name: row for row in beside(tmp_path, two_scenes).rows}
    scenes = [f"HM3D, scene {number}" for number in HM3D.scenes]
    assert list(rows) == ["HM3D, average", "HM3D, mean of its scenes", *scenes]
    one = rows["HM3D, scene 802"]
    assert (one.paper, one.episodes) == (HM3D.scenes["802"], 2)
    assert certain(one.success).mean == 0.5
    assert certain(one.spl).mean == 0.25  # 4 m of the 8 m that it walked
    empty = rows["HM3D, scene 880"]
    assert (empty.success, empty.spl, empty.episodes) == (None, None, 0)


def test_the_average_is_of_all_episodes_and_the_mean_of_the_scenes_that_the_paper_lists(
    tmp_path, two_scenes
):
    average, mean = beside(tmp_path, two_scenes).rows[:2]
    assert (average.paper, average.episodes) == (HM3D.total, 4)
    assert certain(average.success).mean == pytest.approx(1 / 2)
    assert (mean.paper, mean.episodes) == (HM3D.plain_mean, 3)
    assert certain(mean.success).mean == pytest.approx(2 / 3)


def test_other_scenes_and_episodes_are_said(tmp_path, two_scenes):
    told = said(beside(tmp_path, two_scenes))
    assert "Scenes of the paper that the run lacks: 814, 824, 829" in told
    assert "the paper doesn't list: 800." in told
    assert "The run has 3 episodes in them, the paper's table 1,000." in told
    assert "v1" not in told
    assert "neither success distance nor camera of its simulations; the run's are 0.1 m" in told


@pytest.mark.parametrize(
    ("dataset", "words"),
    [
        ("hm3d:data#v2/val", "the run's are of v2, the paper's seem to be of v1"),
        ("hm3d:data", "may be of any version"),
        ("ovon:data#val_seen", "the run's are of val_seen, the paper's of val unseen"),
    ],
)
def test_another_version_or_split_is_said(tmp_path, dataset, words):
    assert words in said(beside(tmp_path, [found("0", scan(835))], dataset))


def test_ovon_has_rows_of_its_own(tmp_path):
    rows = beside(tmp_path, [found("0", scan(890))], "ovon:data#val_unseen").rows
    assert [row.paper for row in rows] == [OVON.total, OVON.plain_mean, *OVON.scenes.values()]
    assert rows[-1].episodes == 1
    named = "hypernav-paper-ovon"
    assert BENCHMARKS[named].printed is OVON
    assert beside(tmp_path / "2", [found("0", scan(890))], "habitat:x", benchmark=named).rows


@pytest.mark.parametrize(
    ("who", "words"),
    [
        ({"preset": "default"}, "the run has the preset default, not paper"),
        ({"agent": "frontier"}, "the paper's scenes are HyPerNav's, the run is frontier's"),
        ({"parts": {"detector": "ground-truth"}}, "The simulator told the run what it sees"),
        ({"parts": {"detector": "yolox:x"}, "detector": "YOLOX"}, "boxes are of YOLOX; the"),
        ({"model": "none; the published one is QwenVL-7B"}, "The run's model: none; the paper's"),
        ({"segmenter": "depth cut, in place of MobileSAM"}, "segmenter: depth cut, in place of"),
    ],
)
def test_another_method_or_network_is_said_and_the_papers_own_is_not(tmp_path, who, words):
    config = preset("paper")
    records = [found("0", scan(802))]
    assert words in said(beside(tmp_path / "other", records, config=config, **who))
    assert words not in said(beside(tmp_path / "own", records, config=config))


def test_an_unfinished_run_and_other_actions_are_said(tmp_path):
    motion = {"motion": {"forward_m": 0.25, "turn_angle_deg": 30.0}}
    config = HyPerNavConfig.model_validate({"embodiment": motion})
    told = said(beside(tmp_path, [found("0", scan(802))], wanted=9, config=config))
    assert "not finished: 1 of 9 episodes" in told
    assert "steps of 0.25 m, turns of 30° and 500 steps; the paper's are 0.5 m" in told


@pytest.mark.parametrize(("agent", "count"), [("hypernav", 4), ("frontier", 3)])
def test_the_robots_goals_stand_beside_the_same_goals_by_the_same_method(tmp_path, agent, count):
    records = [record("0", "houses:1", goal="the bed"), missed("1", "houses:1", goal="sofa")]
    one = beside(tmp_path, records, "houses-val", agent=agent)
    (row,) = one.rows
    assert row.name == f"robot, bed, {count} of 5"
    assert (row.paper.success_percent, row.episodes) == (20.0 * count, 1)
    assert "Other scenes: the paper's tables by scene are of HM3D and HM3D-OVON" in said(one)
    assert paper_results.ROBOT_SETTING in said(one)


def test_the_benchmarks_row_beside_other_buildings_is_said_to_be_of_others(tmp_path):
    others = "Other scenes: the paper's tables by scene are of HM3D and HM3D-OVON"
    assert others in said(beside(tmp_path / "other", [found("0", "houses:1")]))
    assert others not in said(beside(tmp_path / "own", [found("0", scan(802))]))


def test_what_the_paper_has_no_row_of_is_beside_none(tmp_path):
    one = beside(tmp_path, [record("0", "houses:1", goal="sofa")], "houses-val")
    assert one.rows == []
    assert "Other scenes" in said(one)
    records = [record("0", "houses:1")]
    assert beside(tmp_path / "other", records, "houses-val", agent="vlfm").rows == []


def test_page_and_terminal_have_the_table_if_asked(tmp_path, two_scenes, capsys):
    folder = written(tmp_path / "run", two_scenes, "hm3d:data#v1/val")
    assert "Beside the HyPerNav paper" not in write_report(folder, load_runs([folder])).read_text()
    with pytest.raises(SystemExit) as stop:
        main(["report", str(folder), "--published"])
    assert stop.value.code == 0
    shown, page = capsys.readouterr().err, (folder / "report.html").read_text()
    for text in ("HM3D, scene 802", "47.5", "33.1", "Scenes of the paper that the run lacks"):
        assert text in shown
        assert text in page
    assert "Beside the HyPerNav paper" in page
    assert re.search(r"range.>[\d.]+–", page) is None  # four episodes are too few for an interval
