"""The published benchmarks, from a data folder to scored episodes."""

import json
import shutil
from contextlib import closing, nullcontext
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from eval_runs import SMALL, timeless_lines
from hypernav.app.build.data.datasets import load_episodes, select
from hypernav.app.cli.evaluation.run_choice import check, config_of, plan_of
from hypernav.app.cli.main import main
from hypernav.app.cli.options.agent import AgentOptions
from hypernav.app.cli.options.commands import EvalOptions
from hypernav.core.episode import Outcome
from hypernav.core.errors import ConfigError, EpisodeError
from hypernav.lab.datasets import paper_results
from hypernav.lab.datasets.benchmark_files import scene_number
from hypernav.lab.evaluation.report.report_text import protocol_lines, warnings
from hypernav.lab.evaluation.report.run_data import load_runs
from hypernav.lab.evaluation.run_plan import RunPlan, Selection
from hypernav.lab.evaluation.workers.job import Job
from hypernav.lab.evaluation.workers.worker import EpisodeWorker
from scan_writers.buildings import STOREY_M
from scan_writers.episodes import HASH, SCENE
from small_worlds import small_config

ROBOT = small_config(embodiment={"motion": {"forward_m": 0.25, "turn_angle_deg": 30.0}})


@pytest.fixture
def own_data(benchmark_data, tmp_path):
    """A data folder that a test may change."""
    return shutil.copytree(benchmark_data, tmp_path / "data")


class Blind:
    """A detector without masks that finds nothing."""

    def detect(self, observation, goal):
        return []


def hypernav(*arguments):
    with pytest.raises(SystemExit) as stop:
        main([str(argument) for argument in arguments])
    return stop.value.code


def test_goals_are_asked_for_as_the_published_baselines_do(benchmark_data):
    goals = [episode.goal.text for episode in load_episodes(f"hm3d:{benchmark_data}#v1/val")]
    assert goals == ["chair", "potted plant", "tv", "couch"]


def test_starts_keep_their_storey(benchmark_data):
    heights = [episode.start_z for episode in load_episodes(f"hm3d:{benchmark_data}#v2/val")]
    assert heights == [0.0, 0.0, STOREY_M, STOREY_M]


def test_view_points_of_child_categories_count_too(benchmark_data):
    sofa = load_episodes(f"ovon:{benchmark_data}#val_unseen")[1]
    television = load_episodes(f"hm3d:{benchmark_data}#v1/val")[2]
    couch = load_episodes(f"hm3d:{benchmark_data}#v1/val")[3]
    assert sofa.view_points is not None
    assert television.view_points is not None
    assert couch.view_points is not None
    both = np.concatenate([couch.view_points, television.view_points])
    assert {*map(tuple, sofa.view_points)} == {*map(tuple, both)}


@pytest.mark.slow
def test_what_the_file_names_is_found_whatever_the_annotators_called_it(own_data, tmp_path):
    text = own_data / "scene_datasets" / "hm3d" / "val" / SCENE / f"{HASH}.semantic.txt"
    text.write_text(
        text.read_text().replace('"television"', '"screen"').replace('"tv"', '"screen"')
    )
    television = load_episodes(f"hm3d:{own_data}#v1/val")[2]
    with closing(EpisodeWorker(Job(tmp_path, ROBOT))) as worker:
        for objects, success in ((television.objects, True), ((), False)):
            assert worker.run(replace(television, objects=objects, max_steps=60)).success == success


@pytest.mark.parametrize("name", ["802", "00802", SCENE, HASH])
def test_scenes_go_by_the_numbers_of_the_paper(benchmark_data, name):
    episodes = load_episodes(f"hm3d:{benchmark_data}#v1/val")
    assert len(select(episodes, scenes=name)) == len(episodes) == 4
    with pytest.raises(EpisodeError, match=r"there is no scene '813'; there are 1: 802$"):
        select(episodes, scenes="802,813")


def test_the_papers_scenes_go_as_the_benchmark_prints_them(benchmark_data):
    episodes = load_episodes(f"hm3d:{benchmark_data}#v1/val")
    folder = Path(episodes[0].scene_id).parents[1]
    split = [
        replace(episode, scene_id=str(folder / f"00{number}-x" / "x.basis.glb"))
        for number in ("880", *paper_results.HM3D.scenes, "800", "899")
        for episode in episodes[:2]
    ]
    chosen = select(split, scenes=paper_results.HM3D.selection)
    numbers = [scene_number(episode.scene_id) for episode in chosen]
    assert set(numbers) == set(paper_results.HM3D.scenes)
    with pytest.raises(EpisodeError, match=r"no scene '847'; there are 12: 880, 802, 813, .*899$"):
        select(split, scenes=paper_results.OVON.selection.removeprefix("820,835,810,"))


def test_where_scenes_have_numbers_another_number_is_no_position(benchmark_data):
    episodes = load_episodes(f"hm3d:{benchmark_data}#v1/val")
    with pytest.raises(EpisodeError, match=r"there is no scene '0'; there are 1: 802$"):
        select(episodes, scenes="0")


def test_only_the_scenes_of_chosen_episodes_are_needed(benchmark_data, tmp_path):
    empty = tmp_path / "scenes"
    empty.mkdir()
    plan = RunPlan(f"hm3d:{benchmark_data}#v1/val", Selection(), scenes_dir=empty)
    with pytest.raises(EpisodeError, match=r"^the scene .* is missing; hypernav doctor"):
        plan.episodes()


@pytest.fixture(scope="module")
def records(benchmark_data, tmp_path_factory):
    """What an agent with ground truth makes of the four episodes of HM3D."""
    config = ROBOT
    worker = EpisodeWorker(Job(tmp_path_factory.mktemp("run"), config))
    try:
        return [worker.run(episode) for episode in load_episodes(f"hm3d:{benchmark_data}#v1/val")]
    finally:
        worker.close()


@pytest.mark.slow
def test_goals_on_either_storey_are_found(records):
    assert [record.outcome for record in records] == [Outcome.FOUND] * 4
    assert all(record.success and record.spl > 0.3 for record in records)


def test_a_goal_on_the_other_storey_is_at_the_end_of_the_stairs(benchmark_data, tmp_path):
    below, _, _, above = load_episodes(f"hm3d:{benchmark_data}#v1/val")
    downstairs = replace(above, episode_id="4", start=below.start, start_z=below.start_z)
    worker = EpisodeWorker(Job(tmp_path, small_config()))
    record = worker.run(replace(downstairs, max_steps=1))
    assert 9.0 < record.shortest_path_m < 16.0


@pytest.mark.slow
def test_the_files_view_points_decide_about_distances(records):
    # The chair is 1.5 m away; 1.0 m of them lies beyond its farthest view points.
    assert records[0].shortest_path_m == pytest.approx(0.5, abs=0.15)


@pytest.mark.slow
def test_the_command_takes_the_robot_and_the_limits_of_the_benchmark(benchmark_data, tmp_path):
    quick = ("--max-steps", "3", "--workers", "1", "--quiet", "--episodes", "0:1")
    split = f"ovon:{benchmark_data}#val_seen"
    assert hypernav("eval", split, *quick, "--out", tmp_path / "ovon") == 0
    run = json.loads((tmp_path / "ovon" / "run.json").read_text())["configuration"]
    camera, body = run["config"]["embodiment"]["camera"], run["config"]["embodiment"]["body"]
    assert (camera["width"], camera["height"], camera["hfov_deg"]) == (360, 640, 42.0)
    assert run["navmeshes"] == {"file": 0, "computed": 1}  # the files are another robot's
    assert (camera["height_m"], body["height_m"], body["radius_m"]) == (1.31, 1.41, 0.17)
    assert run["config"]["embodiment"]["motion"]["forward_m"] == 0.25
    assert (run["protocol"]["max_steps"], run["protocol"]["success_distance_m"]) == (3, 0.25)
    assert len(timeless_lines(tmp_path / "ovon")) == 1


def test_another_benchmark_and_single_values_win():
    who = AgentOptions(set=("embodiment.camera.width=160",))
    options = EvalOptions(
        "hm3d:data", who, benchmark="hypernav-paper-hm3d", success_distance=1.0, max_steps=3
    )
    config = config_of(options)
    assert config.embodiment.motion.forward_m == 0.5
    assert config.embodiment.camera.width == 160
    plan = plan_of(options, config)
    assert (plan.max_steps, plan.success_distance_m) == (3, 1.0)


@pytest.mark.parametrize(
    ("options", "run_ends", "agent_knows"),
    [
        (EvalOptions("goat:data"), 5000, 5000),
        (EvalOptions("hm3d:data"), 500, 500),
        (EvalOptions("houses-val", max_steps=80), 80, 80),
        (EvalOptions("houses-val", AgentOptions(set=("search.max_steps=300",))), 500, 300),
    ],
    ids=["goat", "hm3d", "--max-steps", "--set"],
)
def test_the_agent_knows_how_many_steps_it_has(options, run_ends, agent_knows):
    config = config_of(options)
    assert plan_of(options, config).max_steps == run_ends
    assert config.search.max_steps == agent_knows


def test_the_papers_goals_go_by_the_words_of_the_files(benchmark_data):
    dataset = f"hm3d:{benchmark_data}#v1/val"
    plan = RunPlan(dataset, benchmark="hypernav-paper-hm3d")
    asked = [episode.goal.text for episode in plan.episodes()]
    named = load_episodes(f"hypernav-paper-{dataset}")
    words = ["chair", "plant", "tv monitor", "sofa"]
    assert asked == [episode.goal.text for episode in named] == words
    chosen = replace(plan, selection=Selection(goals="plant")).episodes()
    assert [episode.goal.text for episode in chosen] == ["plant"]


@pytest.mark.parametrize(
    ("who", "refused"),
    [
        (AgentOptions(segmenter="depth-cut"), "is run with QwenVL-7B: name the model, --vlm"),
        (AgentOptions(segmenter="depth-cut", reasoner="geometric"), "is run with QwenVL-7B"),
        (AgentOptions(vlm="openai:http://localhost:1/v1"), "is run with MobileSAM: name its"),
        (AgentOptions(vlm="openai:http://localhost:1/v1", segmenter="depth-cut"), ""),
        (AgentOptions(detector="none:1", reasoner="geometric", segmenter="depth-cut"), ""),
    ],
)
def test_the_papers_networks_have_to_be_named_or_what_replaces_them(who, refused):
    options = EvalOptions("hm3d:data", who, benchmark="hypernav-paper-hm3d")
    with pytest.raises(ConfigError, match=refused) if refused else nullcontext():
        check(options)


def test_a_run_by_the_papers_protocol_names_the_papers_networks_beside_its_own():
    config = config_of(EvalOptions("ovon:data", AgentOptions(), benchmark="hypernav-paper-ovon"))
    assert config.chat.published_model == paper_results.MODEL
    assert config.local.published_segmenter == paper_results.SEGMENTER


@pytest.mark.slow
def test_what_stands_in_for_the_papers_networks_is_said(benchmark_data, tmp_path, capsys):
    split = (f"hm3d:{benchmark_data}#v1/val", "--benchmark", "hypernav-paper-hm3d")
    quick = ("--max-steps", "2", "--workers", "1", "--episodes", "0:1", *SMALL)
    command = ("eval", *split, *quick, "--out", tmp_path / "run")
    assert hypernav(*command) == 2
    assert "is run with QwenVL-7B: name the model, --vlm" in capsys.readouterr().err
    stand_ins = ("--segmenter", "depth-cut", "--detector", f"{__name__}:Blind")
    assert hypernav(*command, *stand_ins, "--reasoner", "geometric") == 0
    said = capsys.readouterr().err
    assert "10 scenes with 1,000 episodes: --scenes 802,813,814,824,829,835,853," in said
    run = json.loads((tmp_path / "run" / "run.json").read_text())["configuration"]
    assert run["benchmark"] == "hypernav-paper-hm3d"
    assert run["who"]["segmenter"].endswith("in place of MobileSAM")
    assert run["who"]["model"] == "none; the published one is QwenVL-7B"
    runs = load_runs([tmp_path / "run"])
    assert dict(protocol_lines(runs[0]))["Model"] == run["who"]["model"]
    (warned,) = [one for one in warnings(runs) if "hypernav-paper-hm3d" in one]
    assert "its success distance and its camera are not stated" in warned


@pytest.mark.slow
def test_a_run_in_which_nothing_could_be_scored_fails_in_one_line(own_data, tmp_path, capsys):
    mesh = own_data / "scene_datasets" / "hm3d" / "val" / SCENE / f"{HASH}.glb"
    whole = mesh.read_bytes()
    mesh.write_bytes(whole[:-40])
    quick = ("--max-steps", "2", "--workers", "1", "--quiet", "--episodes", "0:2", *SMALL)
    command = ("eval", f"hm3d:{own_data}#v1/val", *quick, "--out", tmp_path / "run")
    assert hypernav(*command) == 2
    said = capsys.readouterr().err
    assert said.startswith("hypernav: none of the 2 episodes could be scored (SceneError: ")
    assert said.count("\n") == 1
    mesh.write_bytes(whole)
    assert hypernav(*command) == 0


@pytest.mark.slow
def test_a_run_does_not_go_on_in_another_scene_of_the_same_name(own_data, tmp_path, capsys):
    navmesh = own_data / "scene_datasets" / "hm3d" / "val" / SCENE / f"{HASH}.basis.navmesh"
    quick = ("--max-steps", "2", "--workers", "1", "--quiet", "--episodes", "0:1", *SMALL)
    command = ("eval", f"hm3d:{own_data}#v1/val", *quick, "--out", tmp_path / "run")
    assert hypernav(*command) == 0
    whole = navmesh.read_bytes()
    navmesh.unlink()
    assert hypernav(*command) == 2
    assert "was begun with other files of the scene" in capsys.readouterr().err
    navmesh.write_bytes(whole)
    assert hypernav(*command) == 0


def test_goals_go_by_the_files_own_words_too(benchmark_data):
    plan = RunPlan(f"hm3d:{benchmark_data}#v1/val", Selection(goals="plant, tv_monitor,couch"))
    assert [episode.goal.text for episode in plan.episodes()] == ["potted plant", "tv", "couch"]


def test_a_slash_at_the_end_of_a_folder_names_no_other_data_set(benchmark_data):
    plain, slashed = (
        RunPlan(f"hm3d:{folder}#v1/val") for folder in (benchmark_data, f"{benchmark_data}/")
    )
    episodes = plain.episodes()
    assert slashed.episodes() == episodes
    assert slashed.configuration(episodes) == plain.configuration(episodes)
