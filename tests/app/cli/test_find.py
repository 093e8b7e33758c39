import json
import re
import subprocess
import sys

import pytest

from box_scenes import room_glb
from hypernav.app.cli.main import main
from hypernav.app.cli.screen.search_lines import no_such_object_line
from hypernav.core.goal import Goal
from hypernav.io.folder_lock import folder_lock
from hypernav.simulator.houses.building import NOUNS
from hypernav.simulator.houses.generator import storeys_of
from hypernav.simulator.houses.named_scenes import building_of

SMALL = ("--set", "embodiment.camera.width=160", "embodiment.camera.height=120")


@pytest.fixture(scope="module")
def glb(tmp_path_factory):
    """A room with a bed as a GLB whose nodes carry the names."""
    return room_glb(tmp_path_factory.mktemp("scene") / "room.glb")


def hypernav(*arguments):
    """Run the command; returns its exit status."""
    with pytest.raises(SystemExit) as stop:
        main([str(argument) for argument in arguments])
    return stop.value.code


def test_found_is_exit_status_0_and_leaves_the_numbers(glb, tmp_path, capsys):
    status = hypernav("find", "bed", "--scene", glb, "--out", tmp_path, *SMALL)
    result = json.loads((tmp_path / "result.json").read_text())
    assert status == 0
    assert (result["outcome"], result["success"]) == ("found", True)
    assert result["scene"] == str(glb)
    assert {
        "goal", "scene", "agent", "preset", "detector", "reasoner", "spl", "soft_spl", "steps",
        "path_length_m", "shortest_path_m", "distance_to_goal_m", "model_calls", "seconds",
        "config",
    } <= set(result)  # fmt: skip
    assert result["config"]["embodiment"]["camera"]["width"] == 160
    assert str(tmp_path / "index.html") in capsys.readouterr().err.replace("\n", "")


def test_not_found_is_exit_status_1(glb, tmp_path):
    status = hypernav("find", "piano", "--scene", glb, "--out", tmp_path, "--quiet", *SMALL)
    assert status == 1
    assert json.loads((tmp_path / "result.json").read_text())["outcome"] == "not_found"


def test_two_searches_never_write_one_folder(glb, tmp_path, capsys):
    with folder_lock(tmp_path):
        assert hypernav("find", "bed", "--scene", glb, "--out", tmp_path, *SMALL) == 2
    assert f"{tmp_path} is in use by another run" in capsys.readouterr().err.replace("\n", " ")
    assert not (tmp_path / "trace.jsonl").exists()


EXPLORER = """
from hypernav import Destination, ExplorationView


class Ahead:
    def next_destination(self, view: ExplorationView) -> Destination | None:
        x, y = view.robot.xy
        return Destination(x + 1.0, y, "ahead", most_steps=3) if len(view.visits) < 3 else None
"""


def test_an_explorer_of_ones_own_says_where_to_go(glb, tmp_path, monkeypatch):
    (tmp_path / "my_explorer.py").write_text(EXPLORER)
    monkeypatch.syspath_prepend(tmp_path)
    options = ("--agent", "my_explorer:Ahead", "--out", tmp_path / "run", "--max-steps", 40)
    assert hypernav("find", "piano", "--scene", glb, "--quiet", *options, *SMALL) == 1
    steps = (tmp_path / "run" / "trace.jsonl").read_text().splitlines()
    assert any(json.loads(step)["reason"] == "ahead" for step in steps)


def test_quiet_says_nothing(glb, tmp_path, capsys):
    hypernav("find", "bed", "--scene", glb, "--out", tmp_path, "--quiet", "--max-steps", 2, *SMALL)
    said = capsys.readouterr()
    assert said.out == said.err == ""


def test_screen_result_and_page_say_what_stands_in_for_the_papers_segmenter(glb, tmp_path, capsys):
    few = ("--max-steps", 2, *SMALL)
    hypernav("find", "bed", "--scene", glb, "--out", tmp_path, "--preset", "paper", *few)
    words = "masks of ground truth, in place of MobileSAM"
    assert words in capsys.readouterr().err
    assert json.loads((tmp_path / "result.json").read_text())["segmenter"] == words
    assert words in (tmp_path / "index.html").read_text()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["find", "bed", "--scene", "nowhere.glb"], "nowhere.glb"),
        (["find", "bed", "--detector", "magic"], "unknown detector 'magic'"),
        (["find", "bed", "--detector", "yolox:nowhere.onnx"], "nowhere.onnx"),
        (["find", ""], "goal is empty"),
        (["find", "bed", "--max-steps", "0"], "steps of a search; expected 1 to 1,000,000"),
        (["find", "bed", "--seed", "-1"], "a whole number; expected 0 to"),
        (["find", "bed", "--set", "search.endurence_steps=3"], "did you mean 'endurance_steps'"),
        (["find", "bed", "--config", "nowhere.yaml"], "nowhere.yaml"),
        (["find", "bed", "--agnt", "frontier"], "--agent"),
        (["find", "bed", "--reasoner", "vlm"], "name it, for example --vlm openai:http://local"),
        (["find", "bed", "--agent", "fast"], "use hypernav, frontier, vlfm"),
        (["find", "bed", "--start", "1", "2"], "--start takes three numbers"),
        (
            ["find", "bed", "--start", "1", "a", "2"],
            "--start: expected numbers, got ['1', 'a', '2'];",
        ),
        (["find", "bed", "--max-steps", "x"], "--max-steps: expected a whole number, got 'x';"),
        (["find", "bed", "--pace", "x"], "--pace: expected a number, got 'x';"),
        (
            ["find", "bed", "--seed", "x"],
            "expected a whole number, got 'x'; see hypernav find --help",
        ),
        (["fnd", "bed"], "find"),
        (["find"], "missing from hypernav find: GOAL The object to find"),
        (["find", "potted", "plant"], 'one name go in quotes, as in "potted plant"'),
        (["find", "bed", "--scene", "house:7"], "did you mean 'houses:7'?"),
        (["find", "bed", "--scene", "bultin"], "did you mean 'builtin'?"),
        (["find", "bed", "--scene", "storeys-train#3024"], "say 'storeys:3024', for its searches"),
        (["find", "bed", "--scene", "houses-val"], "say 'houses:1000', for its searches run hyp"),
    ],
)
def test_bad_input_is_one_line_with_the_remedy(arguments, words, capsys):
    assert hypernav(*arguments) == 2
    said = capsys.readouterr().err
    assert words in said
    assert said.count("\n") == 1
    assert said.startswith("hypernav: ")


@pytest.mark.parametrize(
    ("goal", "words"),
    [
        ("bedd", "to 'bedd'; did you mean 'bed'? The search runs anyway."),
        ("zeppelin", "to 'zeppelin'; it holds bed. The search runs anyway."),
    ],
)
def test_a_goal_that_the_building_does_not_hold_is_said_before_the_search(
    goal, words, glb, tmp_path, capsys
):
    hypernav("find", goal, "--scene", glb, "--out", tmp_path, "--max-steps", 1)
    assert words in capsys.readouterr().err.splitlines()[0]
    assert "Nothing in the building answers to it." in (tmp_path / "index.html").read_text()


def test_a_number_of_no_building_is_told_with_its_kind(capsys):
    assert hypernav("find", "bed", "--scene", "storeys:-1") == 2
    assert "there is no storeyed building '-1'" in capsys.readouterr().err


def test_a_building_without_names_is_told_how_to_get_some():
    assert "objects.json" in no_such_object_line(Goal("bed"), [])


def test_a_start_inside_a_wall_names_a_better_one(glb, tmp_path, capsys):
    status = hypernav(
        "find", "bed", "--scene", glb, "--out", tmp_path, "--start", -1, 0, 0, "--quiet"
    )
    assert status == 2
    assert "nearest position is" in capsys.readouterr().err


def test_a_start_that_is_refused_leaves_no_folder(glb, tmp_path):
    out = tmp_path / "out"
    assert hypernav("find", "bed", "--scene", glb, "--out", out, "--start", -1, 0, 0) == 2
    assert not out.exists()


def test_help_names_every_option(capsys):
    assert hypernav("find", "--help") == 0
    said = capsys.readouterr().out
    for option in ("--scene", "--agent", "--preset", "--detector", "--start", "--seed", "--out"):
        assert option in said


@pytest.mark.parametrize(
    ("command", "given"),
    [(("find",), ("bed", "--seed", "2")), (("houses", "export"), ("7",)), (("houses",), ())],
)
def test_help_is_the_same_whatever_is_given_beside_it(command, given, capsys):
    assert hypernav(*command, "--help") == 0
    said = capsys.readouterr().out
    assert hypernav(*command, *given, "-h") == 0
    assert capsys.readouterr().out == said


@pytest.mark.parametrize("command", [("find",), ("robot", "simulate")])
def test_help_names_every_kind_of_building(command, capsys):
    assert hypernav(*command, "--help") == 0
    said = capsys.readouterr().out
    assert [kind for kind in NOUNS if f"{kind}:N" not in said] == []


@pytest.mark.slow
def test_two_processes_write_the_same_trace(glb, tmp_path):
    traces = []
    for name in ("a", "b"):
        command = [sys.executable, "-c", "from hypernav.app.cli.main import main; main()", "find"]
        options = ["bed", "--scene", str(glb), "--out", str(tmp_path / name), "--seed", "7"]
        subprocess.run([*command, *options, *SMALL], check=True, capture_output=True)
        traces.append((tmp_path / name / "trace.jsonl").read_bytes())
    assert traces[0] == traces[1]


@pytest.mark.slow
def test_in_a_building_with_stairs_the_robot_climbs_unless_told(tmp_path):
    def step(*options):
        scene = ("--scene", "storeys:3004", "--max-steps", 1)
        hypernav("find", "bed", *scene, "--out", tmp_path, "--quiet", *SMALL, *options)
        result = json.loads((tmp_path / "result.json").read_text())
        return result["config"]["embodiment"]["body"]["max_step_m"]

    assert step() == 0.2
    assert step("embodiment.body.max_step_m=0.1") == 0.1


@pytest.mark.slow
def test_a_start_may_be_on_any_floor(tmp_path, capsys):
    def status_from(*start: float):
        options = ("--start", *start, "--max-steps", 1, "--quiet", *SMALL)
        return hypernav("find", "bed", "--scene", "storeys:3004", "--out", tmp_path, *options)

    storeys = storeys_of(building_of("storeys:3004"))
    assert len(storeys) > 1
    start = (0.0, 0.0, 0.0)
    for storey in storeys:
        room = storey.rooms[0].inner
        start = ((room.x0 + room.x1) / 2.0, (room.y0 + room.y1) / 2.0, 126.0)
        status = status_from(*start, storey.floor_z)
        if status == 2:  # furniture stands there
            nearest = re.search(
                r"nearest position is \((.*), (.*), (.*)\)", capsys.readouterr().err
            )
            assert nearest is not None
            x, y, z = map(float, nearest.groups())
            start = (x, y, 126.0)
            assert z == pytest.approx(storey.floor_z, abs=0.1)
            status = status_from(*start, z)
        assert status == 1
        *begun, z = json.loads((tmp_path / "result.json").read_text())["start"]
        assert begun == pytest.approx(start)
        assert z == pytest.approx(storey.floor_z, abs=0.1)
    assert status_from(*start, 20.0) == 2
    assert "can't stand at" in capsys.readouterr().err
