import json
import shutil

import pytest

from eval_runs import SMALL, timeless_lines, write_room
from hypernav.app.cli.evaluation import ablate
from hypernav.app.cli.main import main

QUICK = ("--workers", "1", "--max-steps", "12", *SMALL)


def hypernav(*arguments):
    """Run the command; returns its exit status."""
    with pytest.raises(SystemExit) as stop:
        main([str(argument) for argument in arguments])
    return stop.value.code


@pytest.fixture(scope="module")
def room(tmp_path_factory):
    return write_room(tmp_path_factory.mktemp("scene") / "room.glb")


@pytest.fixture(scope="module")
def ablated(room, tmp_path_factory):
    """The preset paper and one variant of it, in one room."""
    folder = tmp_path_factory.mktemp("ablated")
    assert hypernav(*command(room, folder), "--quiet") == 0
    return folder


def command(room, folder):
    only = ("--of", "paper", "--only", "no-dilation")
    return ("ablate", f"scene:{room}#1", *only, "--out", folder, *QUICK)


def test_a_variant_is_the_evaluation_with_its_values(ablated, room, tmp_path):
    options = (*QUICK, "local.dilation_iterations=0", "--preset", "paper", "--quiet")
    assert hypernav("eval", f"scene:{room}#1", "--out", tmp_path, *options) == 0
    variant = ablated / "no-dilation"
    assert timeless_lines(variant) == timeless_lines(tmp_path)
    ours, theirs = (json.loads((at / "run.json").read_text()) for at in (variant, tmp_path))
    assert ours["configuration"] == theirs["configuration"]
    unchanged = json.loads((ablated / "unchanged" / "run.json").read_text())["configuration"]
    assert (
        unchanged["config"]["local"] | {"dilation_iterations": 0}
        == (ours["configuration"]["config"]["local"])
    )


@pytest.mark.slow
def test_an_ablation_that_goes_on_is_like_one_that_was_never_interrupted(
    ablated, room, tmp_path, capsys
):
    shutil.copytree(ablated, tmp_path, dirs_exist_ok=True)
    lines = tmp_path / "no-dilation" / "episodes.jsonl"
    lines.write_text(lines.read_text().splitlines(keepends=True)[0])
    pages = {name: (tmp_path / name).read_bytes() for name in ("index.html", "ablation.csv")}
    for name in pages:
        (tmp_path / name).unlink()
    assert hypernav(*command(room, tmp_path)) == 0
    said = capsys.readouterr().err
    assert "variant 1 of 2: unchanged" in said
    assert "variant 2 of 2: no dilation" in said
    assert "1 of 2 episodes are done already" in said
    assert f"open {tmp_path / 'index.html'}" in said
    assert timeless_lines(tmp_path / "no-dilation") == timeless_lines(ablated / "no-dilation")
    assert {name: (tmp_path / name).read_bytes() for name in pages} == pages


def test_a_folder_of_another_ablation_is_refused(ablated, room, capsys):
    before = (ablated / "unchanged" / "episodes.jsonl").read_bytes()
    assert hypernav(*command(room, ablated), "--seed", "7") == 2
    assert "protocol.seed was 0, is now 7" in capsys.readouterr().err
    assert (ablated / "unchanged" / "episodes.jsonl").read_bytes() == before


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--of", "default"], "was begun with another configuration: config."),
        (["--max-steps", "9"], "protocol.max_steps was 12, is now 9"),
        (["--goals", "bed", "--only", "local-only"], 'selection.goals was null, is now "'),
        (["--study", "model", "--only", "random-block"], 'study was "switches", is now "model"'),
    ],
)
def test_a_refused_command_leaves_every_file_as_it_was(ablated, room, capsys, arguments, words):
    before = {path: path.read_bytes() for path in ablated.rglob("*") if path.is_file()}
    assert hypernav(*command(room, ablated), *arguments) == 2
    said = capsys.readouterr().err
    assert words in said
    assert "choose another --out" in said
    assert "open " not in said
    assert before == {path: path.read_bytes() for path in ablated.rglob("*") if path.is_file()}


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--only", "foo"], "unknown variant 'foo'"),
        (["--detector", "noisy:bad"], "bad"),
        (["--reasoner", "noisy:1.5"], "1.5"),
    ],
)
def test_the_list_refuses_what_a_run_refuses(arguments, words, capsys):
    assert hypernav("ablate", "scene:builtin", "--list", *arguments) == 2
    said = capsys.readouterr()
    assert words in said.err
    assert said.out == ""


def test_the_list_of_some_variants_names_only_these(capsys):
    assert hypernav("ablate", "scene:builtin", "--list", "--only", "no-erosion") == 0
    said = capsys.readouterr().out
    assert [line.split(":")[0] for line in said.splitlines()] == [
        "unchanged",
        "no-erosion",
        "    --set local.erosion_px=1",
    ]


def test_the_list_names_every_variant_and_runs_nothing(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert hypernav("ablate", "houses-val", "--list") == 0
    said = capsys.readouterr().out
    assert "bump-sensor-off: Whether a step that is cut short marks an obstacle" in said
    assert "    --set planning.bump_sensor=false" in said
    assert "    --reasoner random" in said
    assert "left out: no-presence-check (without a model nobody checks" in said
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--only", "no-erosoin"], "did you mean 'no-erosion'? variants: local-only, global-only"),
        (["--only", "no-presence-check"], "left out, because without a model"),
        (["--of", "papre"], "papre"),
        (["--preset", "paper"], "--preset"),
        (["--study", "switch"], "switches"),
        (["--workers", "0"], "processes; expected 1 to 256"),
        (["--record", "x.jsonl"], "Unrecognized options: --record"),
    ],
)
def test_bad_input_is_one_line_with_the_remedy(arguments, words, capsys):
    assert hypernav("ablate", "scene:builtin", *arguments) == 2
    said = capsys.readouterr().err
    assert words in said
    assert said.count("\n") == 1


@pytest.mark.slow
def test_names_with_blanks_are_taken_too(monkeypatch, tmp_path):
    run = []
    monkeypatch.setattr(ablate, "_run", lambda *given: run.append((given[0].slug, given[-1])))
    words = "No erosion,unchanged"
    assert hypernav("ablate", "scene:builtin", "--only", words, "--out", tmp_path) == 0
    headings = ["variant 1 of 2: unchanged", "variant 2 of 2: no erosion"]
    assert run == list(zip(("unchanged", "no-erosion"), headings, strict=True))


@pytest.mark.slow
def test_an_interruption_leaves_a_page_of_what_there_is(ablated, monkeypatch, tmp_path, capsys):
    shutil.copytree(ablated / "unchanged", tmp_path / "unchanged")

    def interrupted(variant, *_):
        if variant.slug != "unchanged":
            raise KeyboardInterrupt

    monkeypatch.setattr(ablate, "_run", interrupted)
    only = ("--of", "paper", "--only", "no-erosion")
    assert hypernav("ablate", "scene:builtin", *only, "--out", tmp_path) == 130
    page = (tmp_path / "index.html").read_text()
    assert "Without results so far: no erosion." in page
    assert "index.html" in capsys.readouterr().err
