"""What `scripts/write_pages.py` writes into pages."""

import importlib
import re
from pathlib import Path

import pytest

from hypernav.app.build.config_values import config_values
from hypernav.app.cli.command_line import COMMANDS

ROOT = Path(__file__).parents[2]
PAGES = [
    ROOT / "README.md",
    *sorted(ROOT.glob("docs/commands/*.md")),
    *sorted(ROOT.glob("docs/reference/*.md")),
]


@pytest.fixture
def pages(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    monkeypatch.setenv("COLUMNS", "88")
    monkeypatch.setenv("NO_COLOR", "1")
    return importlib.import_module("write_pages")


def test_the_pages_show_what_the_program_says(pages, capsys):
    assert pages.main([*map(str, PAGES), "--check"]) == 0, capsys.readouterr().out


def test_what_differs_is_named_and_mended(pages, capsys, tmp_path):
    page = tmp_path / "README.md"
    before = (ROOT / "README.md").read_text("utf-8")
    page.write_text(re.sub(r"0\.\d\d\d", "0.999", before), "utf-8")
    assert pages.main([str(page), "--check"]) == 1
    assert "make pages" in capsys.readouterr().out
    assert pages.main([str(page)]) == 0
    assert page.read_text("utf-8") == before


def test_an_unknown_table_is_an_error(pages, capsys, tmp_path):
    page = tmp_path / "page.md"
    page.write_text("<!-- table: nowhere -->\n<!-- end of table -->\n", "utf-8")
    assert pages.main([str(page)]) == 1
    assert "there is no table 'nowhere'" in capsys.readouterr().err


def test_a_part_without_an_end_is_an_error(pages, capsys, tmp_path):
    page = tmp_path / "page.md"
    page.write_text("<!-- help: runs -->\n", "utf-8")
    assert pages.main([str(page), "--check"]) == 1
    assert "<!-- help: runs --> has no <!-- end of help -->" in capsys.readouterr().err


def test_every_command_has_a_page_with_its_help():
    for name in COMMANDS:
        page = (ROOT / "docs" / "commands" / f"{name}.md").read_text("utf-8")
        assert f"<!-- help: {name} -->\n```text\nusage: hypernav {name}" in page
        assert "{None}" not in page


def test_every_value_has_an_anchor_a_meaning_and_a_source():
    page = (ROOT / "docs" / "reference" / "configuration.md").read_text("utf-8")
    rows = dict(re.findall(r'^\| <a id="([\w.]+)"></a>(.*)$', page, re.MULTILINE))
    assert list(rows) == [value.key for value in config_values()]
    for row in rows.values():
        assert all(cell.strip() for cell in re.split(r"(?<!\\)\|", row)[:5])
