import logging
import os
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from rich.table import Table

from hypernav.app.cli.main import main
from hypernav.app.cli.screen.search_lines import warnings_on
from hypernav.app.cli.screen.terminal import Terminal
from hypernav.core.errors import ModelUnavailableError

EVIL = "\x1b]0;owned\x07 \x9b31m \u202e red"
SHOWN = r"\x1b]0;owned"


@pytest.fixture
def terminal() -> Terminal:
    return Terminal(stderr=False, soft_wrap=True)


def test_texts_tables_and_warnings_are_shown_not_obeyed(
    terminal: Terminal, capsys: pytest.CaptureFixture[str]
):
    table = Table(EVIL)
    table.add_row(EVIL)
    terminal.print(EVIL, EVIL)
    terminal.print(table)
    with warnings_on(terminal):
        logging.getLogger("hypernav.test").warning("the server said %s", EVIL)
    with terminal.status(EVIL):
        pass
    said = capsys.readouterr().out
    assert said.count(SHOWN) >= 5
    assert not set(said) & set("\x1b\x07\x9b\u202e")


def test_colours_of_our_own_remain(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("TERM", "xterm")
    Terminal(stderr=False).print("[red]\x1b[5m[/]")
    assert capsys.readouterr().out == "\x1b[31m\\x1b[5m\x1b[0m\n"


def test_an_error_about_input_is_shown_not_obeyed(capsys: pytest.CaptureFixture[str]):
    with pytest.raises(SystemExit):
        main(["find", "bed", "--scene", f"{EVIL}.glb", "--detector", EVIL])
    said = capsys.readouterr().err
    assert not set(said) & set("\x1b\x07\x9b\u202e")


def test_an_error_of_several_lines_is_said_in_one(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    def fail(_: object) -> int:
        raise ModelUnavailableError("no server\n\tat all\n")

    monkeypatch.setattr("hypernav.app.cli.command_line.run_command", fail)
    with pytest.raises(SystemExit, match="3"):
        main(["find", "bed"])
    assert capsys.readouterr().err == "hypernav: no server at all\n"


def ended(command: str) -> tuple[int, str, str]:
    """Status and outputs of a line of shell; ``$say 1`` writes long to a stream."""
    script = (
        "import sys\n"
        "from hypernav.app.cli.screen.terminal import Terminal\n"
        "from hypernav.core.errors import OutputError\n"
        "terminal = Terminal(stderr=sys.argv[1] == '2')\n"
        "try:\n"
        "    for _ in range(3000): terminal.print('x' * 60)\n"
        "except OutputError as error:\n"
        "    print(error, file=sys.stderr)\n"
        "    sys.exit(2)\n"
    )
    say = shlex.join([sys.executable, "-c", script])
    line = f"set -o pipefail; {command.replace('$say', say)}"
    done = subprocess.run(["bash", "-c", line], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


@pytest.mark.parametrize("command", ["$say 1 | head -1", "$say 2 2>&1 >/dev/null | head -1"])
def test_a_reader_that_leaves_ends_nothing(command: str):
    assert ended(command) == (0, "x" * 60 + "\n", "")


def test_messages_that_cannot_be_written_are_dropped():
    assert ended("$say 2 2>/dev/full") == (0, "", "")


def test_a_result_that_cannot_be_written_is_an_error():
    expected = "standard output cannot be written (No space left on device)\n"
    assert ended("$say 1 >/dev/full") == (2, "", expected)


@pytest.mark.parametrize("command", ["--help", "eval --help"])
@pytest.mark.parametrize("reader", ["true", "head -1 >/dev/null", "cat >/dev/null"])
def test_help_that_is_not_read_to_its_end_is_no_crash(command: str, reader: str, tmp_path: Path):
    program = "from hypernav.app.cli.main import main; main()"
    line = f"set -o pipefail; {shlex.join([sys.executable, '-c', program])} {command} | {reader}"
    done = subprocess.run(
        ["bash", "-c", line],
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"TMPDIR": str(tmp_path)},
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert not list(tmp_path.glob("hypernav-crash-*"))
