import logging

import pytest
from rich.table import Table

from hypernav.cli.main import main
from hypernav.cli.terminal import Terminal
from hypernav.cli.warnings_shown import warnings_on

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
