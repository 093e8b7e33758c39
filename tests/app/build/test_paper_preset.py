"""The tables of docs/method.md against the presets."""

from pathlib import Path
from typing import Any, NamedTuple

import pytest
import yaml

from hypernav.app.build.presets import preset

PAGE = (Path(__file__).parents[3] / "docs" / "method.md").read_text(encoding="utf-8")
OF_THE_PAPER, OUR_RULES, LEFT_OPEN = (
    "## What the paper says",
    "## Rules of ours",
    "## What the paper leaves open",
)


class Row(NamedTuple):
    table: str
    sentence: str
    field: str
    paper: Any
    default: Any


def rows() -> list[Row]:
    """All rows of all tables; a row without a sentence belongs to the one above."""
    found: list[Row] = []
    table = ""
    for line in PAGE.splitlines():
        table = line if line.startswith("## ") else table
        cells = [cell.strip() for cell in line.removeprefix("|").removesuffix("|").split("|")]
        if len(cells) == 4 and cells[1].startswith("`"):
            sentence = cells[0] or found[-1].sentence
            found.append(Row(table, sentence, cells[1].strip("`"), *map(yaml.safe_load, cells[2:])))
    return found


def values(section: dict[str, Any], name: str = "") -> dict[str, Any]:
    """All values of a configuration by their full names."""
    flat: dict[str, Any] = {}
    for key, value in section.items():
        flat |= values(value, f"{name}{key}.") if isinstance(value, dict) else {name + key: value}
    return flat


def said(value: Any) -> Any:
    """A value as the tables have it: an empty cell for nothing."""
    return None if value == "" else value


PAPER = values(preset("paper").model_dump())
DEFAULT = values(preset("default").model_dump())
ROWS = rows()


def test_the_tables_are_read():
    for table in (OF_THE_PAPER, OUR_RULES, LEFT_OPEN):
        assert sum(row.table.startswith(table) for row in ROWS) > 10
    assert len({row.field for row in ROWS}) == len(ROWS)


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.field)
def test_every_sentence_has_its_value(row):
    assert row.sentence
    for values_of_preset, value in ((PAPER, row.paper), (DEFAULT, row.default)):
        in_use = said(values_of_preset[row.field])
        assert (type(in_use), in_use) == (type(value), value)


def test_every_difference_between_the_presets_is_in_a_table():
    different = {name for name, value in PAPER.items() if value != DEFAULT[name]}
    assert different <= {row.field for row in ROWS}


def test_a_rule_of_ours_is_a_difference():
    for row in ROWS:
        if row.table.startswith(OUR_RULES):
            assert row.paper != row.default, row.field
