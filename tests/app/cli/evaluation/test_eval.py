import csv
import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time

import pytest

from eval_runs import SMALL, timeless_lines, write_exam, write_room
from hypernav.app.cli.evaluation.run_choice import worker_count
from hypernav.app.cli.main import main
from hypernav.app.cli.options.agent import AgentOptions
from hypernav.app.cli.options.commands import EvalOptions
from hypernav.lab.evaluation.runner import available_cores
from servers.scripted import ScriptedServer

QUICK = ("--workers", "1", "--max-steps", "30", *SMALL)


@pytest.fixture(scope="module")
def room(tmp_path_factory):
    return write_room(tmp_path_factory.mktemp("scene") / "room.glb")


def hypernav(*arguments):
    """Run the command; returns its exit status."""
    with pytest.raises(SystemExit) as stop:
        main([str(argument) for argument in arguments])
    return stop.value.code


@pytest.fixture(scope="module")
def runs(room, tmp_path_factory):
    """The same two episodes by both agents; the first run keeps its pages."""
    folder = tmp_path_factory.mktemp("runs")
    common = (f"scene:{room}#1", *QUICK, "--quiet")
    assert hypernav("eval", *common, "--out", folder / "hypernav", "--save", "videos") == 0
    assert hypernav("eval", *common, "--out", folder / "frontier", "--agent", "frontier") == 0
    return folder


def test_a_memory_can_only_be_emptied_where_there_are_lives(room, tmp_path, capsys):
    command = ("eval", f"scene:{room}#1", *QUICK, "--fresh-memory", "--out", tmp_path / "run")
    assert hypernav(*command) == 2
    assert "belong to no lives" in capsys.readouterr().err
    assert not (tmp_path / "run" / "episodes.jsonl").exists()


def test_a_run_leaves_its_episodes_and_its_configuration(runs):
    lines = timeless_lines(runs / "hypernav")
    assert [line["goal"] for line in lines] == ["bed", "sofa"]
    assert {
        "scene_id", "episode_id", "goal", "outcome", "failure", "success", "spl", "soft_spl",
        "distance_to_goal_m", "steps", "path_length_m", "model_calls",
    } <= set(lines[0])  # fmt: skip
    configuration = json.loads((runs / "hypernav" / "run.json").read_text())["configuration"]
    assert configuration["who"]["detector"] == "ground truth"
    assert configuration["config"]["embodiment"]["camera"]["width"] == 160
    session = json.loads((runs / "hypernav" / "sessions.jsonl").read_text())
    assert (session["ended"], session["episodes"]) == ("finished", 2)
    assert session["peak_memory_mb"]["0"] > 50


@pytest.mark.slow
def test_a_run_does_not_go_on_with_other_weights_in_the_same_file(
    room, test_data, tmp_path, capsys
):
    weights = tmp_path / "net.onnx"
    shutil.copyfile(test_data / "models" / "yolox_nano.onnx", weights)
    arguments = ["eval", f"scene:{room}#1", *QUICK, "--quiet", "--out", tmp_path / "run"]
    arguments += ["--detector", f"yolox:{weights}", "--goals", "bed", "--max-steps", "2"]
    assert hypernav(*arguments) == 0
    who = json.loads((tmp_path / "run" / "run.json").read_text())["configuration"]["who"]
    whole = hashlib.sha256(weights.read_bytes()).hexdigest()
    assert whole.startswith(who["files"][str(weights)])
    with weights.open("ab") as file:
        file.write(b"\x9a\x06\x00")  # an empty field that no reader knows: another file, as good
    assert hypernav(*arguments) == 2
    assert "files" in capsys.readouterr().err


def test_there_is_one_worker_a_core_unless_each_would_load_a_model():
    served, local = (AgentOptions(vlm=vlm) for vlm in ("openai:http://gpu/v1", "local:qwen"))
    assert worker_count(EvalOptions("houses-val")) == available_cores()
    assert worker_count(EvalOptions("houses-val", served)) == available_cores()
    assert worker_count(EvalOptions("houses-val", local)) == 1
    assert worker_count(EvalOptions("houses-val", local, workers=3)) == 3


@pytest.mark.slow
def test_saved_episodes_have_a_page_and_colours_change_no_result(runs, room, tmp_path):
    lines = timeless_lines(runs / "hypernav")
    for line in lines:
        assert (runs / "hypernav" / line["saved"] / "index.html").is_file()
        assert (runs / "hypernav" / line["saved"] / "episode.mp4").is_file()
    hypernav("eval", f"scene:{room}#1", *QUICK, "--quiet", "--out", tmp_path)
    unseen = timeless_lines(tmp_path)
    assert [line | {"saved": ""} for line in lines] == unseen


@pytest.mark.slow
def test_only_failures_are_saved_if_one_says_so(runs, room, tmp_path):
    taken = [line["steps"] for line in timeless_lines(runs / "hypernav")]
    between = str(sum(taken) // 2)  # enough for one of the two
    command = ("eval", f"scene:{room}#1", *QUICK, "--quiet", "--save", "failures")
    hypernav(*command, "--out", tmp_path, "--max-steps", between)
    lines = timeless_lines(tmp_path)
    assert {line["success"] for line in lines} == {True, False}
    assert [bool(line["saved"]) for line in lines] == [not line["success"] for line in lines]
    assert len(list(tmp_path.glob("episodes/*"))) == 1


def test_the_same_command_again_runs_nothing_and_another_one_is_refused(runs, room, capsys):
    folder = runs / "frontier"
    before = (folder / "episodes.jsonl").read_bytes()
    command = ("eval", f"scene:{room}#1", *QUICK, "--out", folder)
    assert hypernav(*command, "--agent", "frontier") == 0
    assert "2 of 2 episodes are done already" in capsys.readouterr().err
    assert hypernav(*command, "--agent", "frontier", "--max-steps", "31") == 2
    assert "protocol.max_steps was 30, is now 31" in capsys.readouterr().err
    assert hypernav(*command) == 2
    assert 'who.agent was "frontier", is now "hypernav"' in capsys.readouterr().err
    assert (folder / "episodes.jsonl").read_bytes() == before


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["houses-vall"], "did you mean 'houses-val'"),
        (["scene:nowhere.glb"], "nowhere.glb"),
        (["houses-val", "--workers", "0"], "--workers 0: processes; expected 1 to 256"),
        (["houses-val", "--max-steps", "0"], "steps of a search; expected 1 to 1,000,000"),
        (["houses-val", "--seed", "-1"], "--seed -1: a whole number; expected 0 to"),
        (["houses-val", "--success-distance", "0"], "metres; expected 0.001 to 100"),
        (["houses-val", "--save", "all"], "videos"),
        (["houses-val", "--record", "x.jsonl"], "Unrecognized options: --record"),
        (["houses-val", "--set", "search.endurence_steps=3"], "did you mean 'endurance_steps'"),
        ([], "missing from hypernav eval: DATASET houses-val, houses-ovon"),
    ],
)
def test_bad_input_is_one_line_with_the_remedy(arguments, words, capsys):
    assert hypernav("eval", *arguments) == 2
    said = capsys.readouterr().err
    assert words in said
    assert said.count("\n") == 1


def test_ctrl_c_says_how_to_go_on(room, tmp_path):
    program = "from hypernav.app.cli.main import main; main()"
    command = [sys.executable, "-c", program, "eval", f"scene:{room}#200", "--out", str(tmp_path)]
    process = subprocess.Popen(
        [*command, *QUICK],
        stderr=subprocess.PIPE,
        text=True,
        # A shell that runs tests in the background hands down SIGINT as ignored.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    path = tmp_path / "episodes.jsonl"
    deadline = time.monotonic() + 100
    while time.monotonic() < deadline and not (path.exists() and path.read_text()):
        time.sleep(0.05)
    os.kill(process.pid, signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 130
    assert re.search(r"interrupted; \d+ of 400 episodes are safe .* Run the same command", said)
    assert "Traceback" not in said
    assert json.loads((tmp_path / "sessions.jsonl").read_text())["ended"] == "interrupted"


def test_report_of_one_run_links_its_episodes(runs, capsys):
    assert hypernav("report", runs / "hypernav") == 0
    assert "report.html" in capsys.readouterr().err
    page = (runs / "hypernav" / "report.html").read_text()
    for line in timeless_lines(runs / "hypernav"):
        assert f'href="{line["saved"]}/index.html"' in page
    assert "ground-truth" in page
    assert "Compared" not in page


def test_report_compares_runs_and_writes_csv_and_tex(runs, tmp_path, capsys):
    folders = (runs / "hypernav", runs / "frontier")
    assert hypernav("report", *folders, "--compare", "--out", tmp_path) == 0
    said = capsys.readouterr().err
    assert re.search(r"hypernav found its goal in .* SPL of .*; frontier found its goal in", said)
    page = (tmp_path / "report.html").read_text()
    assert "frontier against hypernav on the 2 episodes" in page
    with (tmp_path / "report.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["run"] for row in rows] == ["hypernav"] * 2 + ["frontier"] * 2
    assert r"\toprule" in (tmp_path / "report.tex").read_text()


def test_report_writes_to_no_folder_that_a_stranger_linked(runs, tmp_path, capsys):
    for name in ("hypernav", "frontier"):
        shutil.copytree(runs / name, tmp_path / name)
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "hypernav" / "compared").symlink_to(tmp_path / "elsewhere")
    assert hypernav("report", tmp_path / "hypernav", tmp_path / "frontier") == 2
    assert "compared is a link" in capsys.readouterr().err
    assert not list((tmp_path / "elsewhere").iterdir())


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "name at least one folder"),
        (["nowhere"], "there is no folder nowhere"),
        (["nowhere", "--compare"], "at least two"),
    ],
)
def test_a_report_about_nothing_is_one_line_with_the_remedy(arguments, words, capsys):
    assert hypernav("report", *arguments) == 2
    said = capsys.readouterr().err
    assert words in said
    assert said.count("\n") == 1


def test_a_plan_by_an_exam_runs_nothing_and_tells_the_cost(room, tmp_path, capsys):
    exam = write_exam(tmp_path)
    vlm = ("--vlm", "openai:http://127.0.0.1:9/v1#qwen2.5-vl")  # nobody is asked
    plan = ("eval", f"scene:{room}#1", *QUICK, *vlm, "--exam", exam, "--plan")
    price = ("price.in_per_million=1",)
    assert hypernav(*plan, "--out", tmp_path / "run", "--set", *SMALL[1:], *price) == 0
    said = capsys.readouterr().err
    assert "222 calls of the model, 111 in a search" in said
    assert "in money" in said
    assert "--reasoner geometric saves 5% of the calls" in said
    assert not (tmp_path / "run").exists()
    auto = ("--reasoner", "auto", "--out", tmp_path / "run")
    assert hypernav(*plan, *auto) == 0
    assert "210 calls of the model, 105 in a search" in capsys.readouterr().err


@pytest.mark.slow
def test_a_plan_by_episodes_first_asks_the_model_how_long_it_takes(room, tmp_path, capsys):
    with ScriptedServer() as server:
        server.delay_s = 0.3
        who = ("--vlm", server.spec, "--workers", "1", "--max-steps", "1", "--out", tmp_path)
        assert hypernav("eval", f"scene:{room}#1", *who, "--plan", "--set", *SMALL[1:]) == 0
    said = capsys.readouterr().err
    pace = re.search(r"an answer takes 0.\d+ s; .* takes \d+ s; this run has 2 searches", said)
    assert pace is not None
    assert pace.start() < said.index("by these 2 episodes:")


@pytest.mark.slow
def test_a_plan_without_an_exam_keeps_its_ten_episodes(room, tmp_path, capsys):
    run = ("eval", f"scene:{room}#6", *QUICK, "--max-steps", "3", "--out", tmp_path)
    assert hypernav(*run, "--plan") == 0
    said = capsys.readouterr().err
    assert "10 of 12 episodes done" in said
    assert "by these 10 episodes:" in said
    assert "no model is asked" in said
    assert hypernav(*run) == 0
    assert "10 of 12 episodes are done already" in capsys.readouterr().err


def test_auto_without_an_exam_and_an_exam_of_another_model_are_refused(room, tmp_path, capsys):
    plan = ("eval", f"scene:{room}#1", *QUICK, "--out", tmp_path / "run")
    assert hypernav(*plan, "--reasoner", "auto") == 2
    assert "--exam" in capsys.readouterr().err
    other = ("--vlm", "openai:http://127.0.0.1:9/v1#llava", "--exam", write_exam(tmp_path))
    assert hypernav(*plan, *other) == 2
    assert "not of llava" in capsys.readouterr().err
