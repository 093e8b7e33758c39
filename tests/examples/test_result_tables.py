"""The tables of README and docs are what their data files say."""

import importlib
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = sorted((ROOT / "docs").rglob("*.md"))

DATA = """
title = "Two robots"
columns = [
  { name = "robot", head = "robot" },
  { name = "spl", head = "SPL", measure = "spl", digits = 3 },
  { name = "more", head = "beside the first", measure = "spl_difference", digits = 3 },
  { name = "times", head = "times", measure = "spl_times", digits = 2 },
]

[[rows]]
name = "one"
command = "hypernav eval houses-val"
commit = "abcdef1"
date = 2026-11-29
n = 1000
[rows.cells]
robot = "the first"
spl = [0.4, 0.35, 0.45]

[[rows]]
name = "two"
command = "python benchmarks/many_searches.py"
against = "one"
commit = "abcdef1"
date = 2026-11-29
[rows.cells]
robot = "{{ robots.one.n }}"
spl = 0.6
more = [0.2, 0.1, 0.3]
"""


@pytest.fixture
def tables(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    return importlib.import_module("result_tables")


@pytest.fixture
def results(tables, tmp_path):
    """The tables of a folder with the one above, or with what it is changed to."""

    def read(old: str = "", new: str = ""):
        assert old in DATA
        (tmp_path / "robots.toml").write_text(DATA.replace(old, new), "utf-8")
        return tables.Results(tmp_path)

    return read


def test_a_table_has_means_with_intervals_and_ratios_of_two_rows(results):
    assert results().drawn("robots").splitlines() == [
        "| robot | SPL | beside the first | times |",
        "| --- | --- | --- | ---: |",
        "| the first | 0.400 (0.350 to 0.450) |  |  |",
        "| 1,000 | 0.600 | +0.200 (0.100 to 0.300) | 1.50 |",
    ]


def test_rows_of_two_commits_are_not_compared(results):
    second = 'against = "one"\ncommit = "abcdef1"'
    drawn = results(second, second.replace("abcdef1", "abcdef2")).drawn("robots")
    assert drawn.splitlines()[0] == "| robot | SPL |"  # no column without a value
    assert drawn.splitlines()[-1] == "| 1,000 | 0.600 |"


def test_a_page_gets_its_tables_their_sources_and_its_values(results):
    page = "{{ robots.one.spl }}, {{ robots.one.spl.interval }}, {{robots.two.times}}, "
    page += "{{ robots.one.n }}, {{ robots.one.date }}\n\n"
    values, _, drawn = results().page(page + "<!-- table: robots -->\n").partition("\n\n")
    assert values == "0.400, 0.350 to 0.450, 1.50, 1,000, 2026-11-29"
    assert drawn.startswith("| robot | SPL |")
    assert "    `one` (n = 1,000): commit `abcdef1`, 2026-11-29\n" in drawn
    assert "    hypernav eval houses-val\n" in drawn
    assert "values typed by hand" in drawn  # of the second row, whose command gives no run folder


@pytest.mark.parametrize(
    "asked",
    ["robots.one.more", "robots.two.spl.interval", "robots.three.spl", "robots.one.x", "a.b.c"],
)
def test_a_value_that_is_not_there_is_an_error(asked, results, tables):
    with pytest.raises(tables.ResultsError, match=r"robots|there is no table 'a'"):
        results().page(f"{{{{ {asked} }}}}")


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("title =", "titel =", "title: Field required"),
        ("title =", "title", "is no TOML"),
        ("[0.4, 0.35, 0.45]", "[0.4, 0.45, 0.35]", "'spl': the mean is not in its interval"),
        (
            "[0.4, 0.35, 0.45]",
            "[0.4, 0.35]",
            r"'spl' must be text, a number or \[mean, low, high\]",
        ),
        ('"the first"', '"the | first"', "'robot' must fit into a cell"),
        ("spl = 0.6", "speed = 0.6", r"row 'two' has cells of no column: \['speed'\]"),
        ('against = "one"', 'against = "three"', "'three', which is no row"),
        ('name = "two"', 'name = "one"', "more than one row is named one"),
        ('command = "python benchmarks/many_searches.py"\n', "", "no command that gives them"),
        ("date = 2026-11-29\nn = 1000", "n = 1000", "row 'one' has a command, and no commit or no"),
        ("n = 1000", 'n = 1000\ncheck = "a tenth"', "check: String should match"),
        ('measure = "spl", ', "", "column 'spl' has numbers to repeat, and no measure"),
    ],
)
def test_a_broken_file_says_what_is_wrong_with_it(old, new, said, results, tables):
    with pytest.raises(tables.ResultsError, match=said) as error:
        results(old, new).table("robots")
    assert "robots.toml" in str(error.value)
    assert len(str(error.value).splitlines()) == 1 or "is no TOML" in said


def test_a_data_file_that_is_written_is_read_as_it_was(results, tables, tmp_path):
    table = results().table("robots")
    (tmp_path / "again.toml").write_text(tables.to_toml(table), "utf-8")
    assert tables.read_table(tmp_path / "again.toml") == table


def test_every_data_file_has_the_form_in_which_it_would_be_written(tables):
    for name in tables.Results().names():
        path = tables.DATA / f"{name}.toml"
        assert path.read_text("utf-8") == tables.to_toml(tables.read_table(path)), name


def test_every_table_and_value_that_a_page_asks_for_is_there(tables):
    results = tables.Results()
    for page in PAGES:
        drawn = results.page(page.read_text("utf-8"))
        assert not re.search(r"^ *<!-- *table|\{\{ ?[\w.-]", drawn, re.MULTILINE), (
            page
        )  # misspelled


def test_every_measured_row_knows_its_measures_and_its_command(tables, monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    measure = importlib.import_module("measure_results")
    known = {"", "n", *measure.ESTIMATES, *measure.COUNTS, *measure.PAIRED}
    command_faults = importlib.import_module("page_commands").command_faults
    commands = set()
    for name in tables.Results().names():
        table = tables.Results().table(name)
        assert {column.measure for column in table.columns} <= known, name
        commands |= {row.command for row in table.rows}
    assert not list(
        command_faults("\n".join(commands - {one for one in commands if ":" in one[:40]}))
    )
