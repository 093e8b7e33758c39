"""What a start of the program may load: the rest waits until it is needed."""

import gc
import os
import shutil
import subprocess
import sys
from importlib.metadata import version

import pytest

from hypernav.app.cli.command_line import COMMANDS
from hypernav.app.cli.main import main

HEAVY = {
    "av", "cv2", "gymnasium", "jinja2", "matplotlib", "numba", "openai", "onnxruntime", "PIL",
    "scipy", "torch", "transformers", "trimesh",
}  # fmt: skip
MAIN = "from hypernav.app.cli.main import main; main({})"


def loaded_by(program: str) -> set[str]:
    """The packages that a Python program has loaded when it ends, whatever its exit status."""
    told = "import atexit, sys; atexit.register(lambda: print('\\n' + ' '.join(sys.modules)))\n"
    ended = subprocess.run(
        [sys.executable, "-c", told + program], capture_output=True, text=True, check=False
    )
    return {name.partition(".")[0] for name in ended.stdout.splitlines()[-1].split()}


def test_a_heavy_package_would_be_noticed():
    assert "scipy" in loaded_by("import scipy.ndimage; raise SystemExit(2)")


def test_importing_the_package_loads_no_other():
    loaded = loaded_by("import hypernav")
    assert "hypernav" in loaded
    assert not loaded & (HEAVY | {"numpy", "pydantic", "tyro", "rich"})


def test_a_robot_that_writes_no_video_loads_nothing_that_draws_pages_or_reads_scenes():
    parts = (
        "app.cli.serve",
        "app.cli.robots.ros2",
        "app.cli.robots.replay",
        "robot.server.serving",
        "robot.client.robot_client",
        "app.build.agents",
    )
    loaded = loaded_by("import " + ", ".join(f"hypernav.{part}" for part in parts))
    assert "numpy" in loaded
    assert not loaded & {"av", "embreex", "gymnasium", "matplotlib", "trimesh"}


def test_who_compares_nothing_does_not_wait_for_statistics():
    assert "scipy" not in loaded_by("import hypernav.app.cli.evaluation.report")


@pytest.mark.parametrize("command", ["config", "evaluation.eval", "evaluation.runs"])
def test_who_only_reads_configurations_and_results_loads_no_kernels(command):
    assert not loaded_by(f"import hypernav.app.cli.{command}") & {"numba", "scipy", "trimesh"}


def test_what_a_command_imports_is_searched_for_garbage_neither_then_nor_at_the_end(monkeypatch):
    monkeypatch.delitem(sys.modules, "hypernav.app.cli.evaluation.report", raising=False)
    before = gc.get_freeze_count()
    with pytest.raises(SystemExit):
        main(["report", "nowhere"])
    assert gc.get_freeze_count() > before
    assert gc.isenabled()


@pytest.mark.parametrize(
    "arguments",
    [
        ["--help"],
        ["--version"],
        ["fnd", "bed"],
        ["find", "--help"],
        ["find", "bed", "--agnt", "frontier"],
        ["eval", "--help"],
        ["ablate", "--help"],
        ["report", "--help"],
        ["doctor", "--help"],
        ["houses", "--help"],
        ["houses", "show", "--help"],
    ],
)
def test_help_and_mistakes_are_answered_without_a_heavy_package(arguments):
    loaded = loaded_by(MAIN.format(arguments))
    assert "tyro" in loaded
    assert not loaded & HEAVY


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["fnd", "bed"], "did you mean 'find'?"),
        (["--seed", "3"], "unknown command '--seed'"),
        ([], "no command"),
        (["houses", "sow", "3"], "show, export, episodes, splits"),
    ],
)
def test_a_mistyped_command_is_answered_with_those_there_are(arguments, words, capsys):
    with pytest.raises(SystemExit) as stop:
        main(arguments)
    said = capsys.readouterr().err
    assert stop.value.code == 2
    assert words in said
    assert said.count("\n") == 1


def test_the_version_is_that_of_the_installed_package(capsys):
    with pytest.raises(SystemExit) as stop:
        main(["--version"])
    assert stop.value.code == 0
    assert capsys.readouterr().out == f"hypernav {version('hypernav')}\n"


@pytest.mark.skipif(shutil.which("bash") is None, reason="bash is not installed")
@pytest.mark.parametrize(
    ("command", "status"),
    [
        ("--help >&-", 0),
        ("--version >&-", 0),
        ("--version | true; exit ${PIPESTATUS[0]}", 0),
        ("--version > /dev/full", 2),
    ],
)
def test_a_closed_or_full_output_is_no_crash(command, status):
    script = f"{sys.executable} -m hypernav {command}"
    ended = subprocess.run(["bash", "-c", script], check=False, capture_output=True, text=True)
    assert ended.returncode == status
    assert "should not have happened" not in ended.stderr


@pytest.mark.skipif(shutil.which("bash") is None, reason="bash is not installed")
def test_a_shell_completes_commands_and_options(capsys):
    with pytest.raises(SystemExit) as stop:
        main(["--completion", "bash"])
    assert not stop.value.code
    ask = "complete -p hypernav > /dev/null; COMP_CWORD={}; COMP_WORDS=(hypernav {}); "
    ask += "_tyro_hypernav hypernav; echo ${{COMPREPLY[@]}}"
    script = "\n".join([capsys.readouterr().out, ask.format(1, "fi"), ask.format(2, "find --scen")])
    done = subprocess.run(["bash", "-c", script], capture_output=True, text=True, check=True)
    commands, options = done.stdout.splitlines()
    assert commands.split()[0] == "find"
    assert options.split()[0] == "--scene"


def completed(shell, words):
    """What a shell offers after words, of which the last one is unfinished."""
    done = subprocess.run(
        [sys.executable, "-m", "hypernav", "--completion", shell],
        capture_output=True,
        text=True,
        check=True,
    )
    ask = f"""
        COMP_WORDS=({" ".join(words)}); COMP_CWORD={len(words) - 1}
        _tyro_hypernav hypernav; echo ${{COMPREPLY[@]}}
    """
    if shell == "fish":
        ask = f'complete --do-complete "{" ".join(words)}" | cut -f 1'
    ran = subprocess.run([shell, "-c", f"{done.stdout}\n{ask}"], capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr[-500:]
    return ran.stdout.split()


@pytest.mark.slow
@pytest.mark.parametrize("shell", ["bash", "fish"])
def test_names_of_scenes_and_agents_are_offered_and_then_files(shell, tmp_path, monkeypatch):
    if shutil.which(shell) is None:
        pytest.skip(f"{shell} is not installed")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.glb").touch()
    assert completed(shell, ["hypernav", "find", "--scene", "bui"]) == ["builtin"]
    if shell != "fish":  # it asks for all values, and filters them itself
        assert completed(shell, ["hypernav", "find", "--scene", "mi"]) == ["mine.glb"]
    assert completed(shell, ["hypernav", "eval", "--agent", "fro"]) == ["frontier"]
    assert "find" in completed(shell, ["hypernav", "fi"])


def test_a_shell_that_cannot_complete_is_named(capsys):
    with pytest.raises(SystemExit) as stop:
        main(["--completion", "tcsh"])
    assert stop.value.code == 2
    assert "bash, zsh, fish" in capsys.readouterr().err


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_of_the_list_can_be_asked_for_help(name, capsys):
    with pytest.raises(SystemExit) as stop:
        main([name, "--help"])
    assert stop.value.code == 0
    assert COMMANDS[name] in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize("encoding", ["utf-8", "ascii"])
def test_a_mistake_is_one_line_in_every_encoding(encoding):
    command = "from hypernav.app.cli.main import main; main(['find', 'bed', '--sede', '3'])"
    ended = subprocess.run(
        [sys.executable, "-c", command],
        env={**os.environ, "PYTHONIOENCODING": encoding},
        capture_output=True,
        text=True,
    )
    assert ended.returncode == 2
    assert ended.stderr.startswith(
        "hypernav: Unrecognized options: --sede, 3; Perhaps you meant: --seed INT "
    )
    assert ended.stderr.endswith("; see hypernav find --help\n")
    assert "--" not in ended.stderr.replace("--sede", "").replace("--seed", "").replace(
        "--help", ""
    )


def test_descriptions_of_options_have_no_lines_of_their_docstrings(capsys):
    with pytest.raises(SystemExit):
        main(["--completion", "bash"])
    spec = next(
        line for line in capsys.readouterr().out.splitlines() if line.startswith("COMPLETION_SPEC")
    )
    assert "any whole number N" in spec
    assert "\\n" not in spec


@pytest.mark.parametrize("columns", ["1", "5", "12"])
def test_a_narrow_terminal_gets_help_too(columns):
    ended = subprocess.run(
        [sys.executable, "-c", MAIN.format(["find", "--help"])],
        env=os.environ | {"COLUMNS": columns},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert (ended.returncode, "--scene" in ended.stdout) == (0, True)
