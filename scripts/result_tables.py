"""The tables of README and docs, drawn from the measurements in ``docs/results/data``.

A file there is one table: its ``columns``, and ``rows`` that each name a command, the commit it ran
at, the day, the number of searches and the values. What a field means: `Table`, `Column`, `Row`.

A page has a table where it has the line ``<!-- table: NAME -->``, and one value of a table where
its text has ``{{ TABLE.ROW.COLUMN }}``, ``{{ TABLE.ROW.COLUMN.interval }}`` or the row's ``n`` or
``date``. Pages of the site are filled in when it is built; `write_pages` writes tables that show
without that.
"""

import datetime
import json
import re
import tomllib
from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import Any, ClassVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator, model_validator

from hypernav.core.errors import HyPerNavError

DATA = Path(__file__).parents[1] / "docs" / "results" / "data"
REPEATABLE = ("hypernav eval ", "hypernav ablate ", "python benchmarks/truthful_eval.py ")
"""Commands whose results `measure_results` reads; those of other commands are typed by hand."""
_NO_RUNS = "--study refinement"  # one process, and no searches

Cell = str | float | list[float]
"""A text, a number, or a mean with the lower and upper end of its 95 % interval."""

_MARKER = re.compile(r"^<!-- table: ([\w-]+) -->$", re.MULTILINE)
_VALUE = re.compile(r"\{\{ ?([\w.-]+) ?\}\}")


class ResultsError(HyPerNavError):
    """A data file, or what a page asks of it, is wrong."""


class _Part(BaseModel):
    model_config: ClassVar[ConfigDict] = ConfigDict(extra="forbid", frozen=True)


class Column(_Part):
    """A column of a table.

    Attributes:
        name: Its name in the cells of rows.
        head: What stands above it.
        measure: What `measure_results` fills it with; empty for a column that is typed by hand.
        digits: Number of decimal places of its numbers.
        interval: Whether a value that is measured keeps its interval.
    """

    name: str
    head: str
    measure: str = ""
    digits: int = Field(default=0, ge=0)
    interval: bool = True

    @property
    def is_paired(self) -> bool:
        """Whether a value compares the row with the one that it names in `Row.against`."""
        return self.measure.endswith(("_difference", "_times"))


class Row(_Part):
    """A row of a table.

    Attributes:
        name: Its name, unique in the table; pages refer to values by it.
        command: What was run; rows with the same command are parts of one run.
        variant: Folder of the variant, where the command is `hypernav ablate`.
        part: Which searches of the run count: ``later`` goals of lives, or goals on the ``same``,
            on an ``other`` floor, ``above`` or ``below`` the start; by default all.
        against: Name of the row with which paired columns compare this one.
        check: Episodes that ``make results-check`` runs, as in ``--episodes``.
        commit: Commit at which the command ran; where an older row's wasn't kept, the one that
            brought the figure into the docs.
        date: Day of the run. Rows that are older than this format have the day of their commit.
        n: Number of searches.
        cells: Values by the name of their column.
    """

    name: str
    command: str = ""
    variant: str = ""
    part: str = ""
    against: str = ""
    check: str = Field(default="", pattern=r"^(\d+:\d+)?$")
    commit: str = Field(default="", pattern=r"^([0-9a-f]{7,40})?$")
    date: datetime.date | None = None
    n: int | None = Field(default=None, ge=1)
    cells: dict[str, Cell]

    @property
    def is_repeatable(self) -> bool:
        """Whether ``make results`` can measure the row anew."""
        return self.command.startswith(REPEATABLE) and _NO_RUNS not in self.command

    @field_validator("cells", mode="before")
    @classmethod
    def _are_cells(cls, cells: Any) -> Any:
        for name, cell in cells.items() if isinstance(cells, dict) else ():
            whole = cell if isinstance(cell, list) else [cell]
            numbers = all(type(one) in (int, float) for one in whole)
            if isinstance(cell, str) and set(cell) & {"|", "\n"}:
                raise ValueError(
                    f"'{name}' must fit into a cell: no | and no new line, is {cell!r}"
                )
            if not isinstance(cell, str) and not (numbers and len(whole) in (1, 3)):
                raise ValueError(f"'{name}' must be text, a number or [mean, low, high], is {cell}")
            if isinstance(cell, list) and not cell[1] <= cell[0] <= cell[2]:
                raise ValueError(f"'{name}': the mean is not in its interval, {cell}")
        return cells

    @model_validator(mode="after")
    def _has_a_source(self) -> "Row":
        if self.command and not (self.commit and self.date):
            raise ValueError(f"row '{self.name}' has a command, and no commit or no date of it")
        if not self.command and not all(isinstance(cell, str) for cell in self.cells.values()):
            raise ValueError(f"row '{self.name}' has numbers, and no command that gives them")
        if self.check and not self.is_repeatable:
            raise ValueError(f"row '{self.name}' has a check, but its command gives no run folder")
        return self


class Table(_Part):
    """A table.

    Attributes:
        title: What it shows.
        columns: Columns, from the left.
        rows: Rows, from the top.
    """

    title: str
    columns: tuple[Column, ...] = Field(min_length=1)
    rows: tuple[Row, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _fits_together(self) -> "Table":
        names = [row.name for row in self.rows]
        if twice := {name for name in names if names.count(name) > 1}:
            raise ValueError(f"more than one row is named {', '.join(sorted(twice))}")
        for row in self.rows:
            if unknown := set(row.cells) - {column.name for column in self.columns}:
                raise ValueError(f"row '{row.name}' has cells of no column: {sorted(unknown)}")
            if row.against and row.against not in names:
                raise ValueError(f"row '{row.name}' is against '{row.against}', which is no row")
            for column in self.columns if row.is_repeatable else ():
                if not column.measure and not isinstance(row.cells.get(column.name, ""), str):
                    raise ValueError(
                        f"column '{column.name}' has numbers to repeat, and no measure"
                    )
        return self

    def row(self, name: str) -> Row:
        """The row of a name.

        Raises:
            KeyError: There is none.
        """
        return {row.name: row for row in self.rows}[name]

    def column(self, name: str) -> Column:
        """The column of a name.

        Raises:
            KeyError: There is none.
        """
        return {column.name: column for column in self.columns}[name]

    def cell(self, row: Row, column: Column) -> Cell | None:
        """The value of a cell, or None if there is none.

        A comparison with a row of another commit is none: the difference could be that of the code.
        SPL over that of another row is worked out where it is not there.
        """
        other = self.row(row.against) if row.against else None
        if column.is_paired and (other is None or other.commit != row.commit):
            return None
        if column.measure == "n" and row.n is not None:
            return float(row.n)
        found = row.cells.get(column.name)
        if found is None and other is not None and column.measure == "spl_times":
            spl = next((one.name for one in self.columns if one.measure == "spl"), "")
            if spl in row.cells and spl in other.cells:
                return _mean(row.cells[spl]) / _mean(other.cells[spl])
        return found


class Results:
    """All tables of a folder."""

    def __init__(self, folder: Path = DATA) -> None:
        """Read nothing yet.

        Args:
            folder: Folder of the data files.
        """
        self._folder = folder
        self._tables: dict[str, Table] = {}

    def names(self) -> list[str]:
        """The names of all tables, sorted."""
        return sorted(path.stem for path in self._folder.glob("*.toml"))

    def table(self, name: str) -> Table:
        """A table by its name.

        Raises:
            ResultsError: There is none, or its file is broken.
        """
        if name not in self._tables:
            path = self._folder / f"{name}.toml"
            if not path.exists():
                raise ResultsError(f"there is no table '{name}', only {', '.join(self.names())}")
            self._tables[name] = read_table(path)
        return self._tables[name]

    def drawn(self, name: str) -> str:
        """A table in Markdown, with its values filled in."""
        table = self.table(name)
        columns = [
            column
            for column in table.columns
            if any(table.cell(row, column) is not None for row in table.rows)
        ]
        lines = [
            [column.head for column in columns],
            ["---:" if _is_numeric(table, column) else "---" for column in columns],
            *([self._shown(table, row, column) for column in columns] for row in table.rows),
        ]
        return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)

    def filled(self, text: str) -> str:
        """A text with its ``{{ … }}`` replaced by values."""
        return _VALUE.sub(lambda asked: self._value(asked[1]), text)

    def page(self, markdown: str) -> str:
        """A page with its tables drawn and its values filled in.

        Raises:
            ResultsError: It asks for a table or value that is not there.
        """
        markdown = _MARKER.sub(
            lambda asked: f"{self.drawn(asked[1])}\n\n{self.sources(asked[1])}", markdown
        )
        return self.filled(markdown)

    def sources(self, name: str) -> str:
        """A block for readers to unfold: commands, commits and days of a table's rows."""
        table = self.table(name)
        measured = [row for row in table.rows if row.command]
        runs = [list(rows) for _, rows in groupby(measured, key=_source)]
        if not runs:
            return ""
        lines = [f"{table.title}. Data: `docs/results/data/{name}.toml`."]
        if any(row.is_repeatable for row in table.rows):
            lines[0] += f" `make results TABLE={name}` measures the rows anew."
        for rows in runs:
            first = rows[0]
            of = ", ".join(f"`{row.name}`" + (f" (n = {row.n:,})" if row.n else "") for row in rows)
            hand = "" if first.is_repeatable else ", values typed by hand from what it prints"
            lines += ["", f"{of}: commit `{first.commit}`, {first.date}{hand}", ""]
            lines += ["```text", *first.command.splitlines(), "```"]
        body = "\n".join(f"    {line}".rstrip() for line in lines)
        return f'??? note "Commands, commits, dates"\n\n{body}\n'

    def _shown(self, table: Table, row: Row, column: Column) -> str:
        cell = table.cell(row, column)
        return "" if cell is None else self.filled(shown(cell, column))

    def _value(self, asked: str) -> str:
        name, _, rest = asked.partition(".")
        wants_interval = rest.endswith(".interval")
        row_name, _, column_name = rest.removesuffix(".interval").rpartition(".")
        table = self.table(name)
        try:
            row = table.row(row_name)
            if column_name == "n" and row.n is not None:
                return f"{row.n:,}"
            if column_name == "date" and row.date is not None:
                return f"{row.date}"
            column = table.column(column_name)
        except KeyError as error:
            raise ResultsError(f"{{{{ {asked} }}}}: table '{name}' has no {error}") from error
        cell = table.cell(row, column)
        if wants_interval and isinstance(cell, list):
            return _interval(cell, column)
        if cell is None or wants_interval:
            raise ResultsError(f"{{{{ {asked} }}}}: the row has no such value to show")
        return self.filled(shown(cell if isinstance(cell, str) else _mean(cell), column))


def read_table(path: Path) -> Table:
    """Read a data file.

    Raises:
        ResultsError: It is no TOML, or does not say what a table says.
    """
    try:
        return Table.model_validate(tomllib.loads(path.read_text("utf-8")))
    except tomllib.TOMLDecodeError as error:
        raise ResultsError(f"{path} is no TOML: {error}") from error
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"]))
        more = f", and {len(error.errors()) - 1} more" if len(error.errors()) > 1 else ""
        raise ResultsError(f"{path}: {where or 'the table'}: {first['msg']}{more}") from error


def to_toml(table: Table) -> str:
    """The text of a table's data file, which has one form, so that changes stay small."""
    lines = [f"title = {_toml(table.title)}", "columns = ["]
    lines += [f"  {_toml(column.model_dump(exclude_defaults=True))}," for column in table.columns]
    lines.append("]")
    for row in table.rows:
        fields = row.model_dump(exclude_defaults=True, exclude={"cells"})
        lines += ["", "[[rows]]", *(f"{name} = {_toml(value)}" for name, value in fields.items())]
        lines += ["[rows.cells]", *(f"{_key(k)} = {_toml(v)}" for k, v in row.cells.items())]
    return "\n".join(lines) + "\n"


def shown(cell: Cell, column: Column) -> str:
    """A cell as a reader sees it."""
    if isinstance(cell, str):
        return cell
    sign = "+" if column.measure.endswith("_difference") else ""
    mean = f"{_mean(cell):{sign},.{column.digits}f}"
    return f"{mean} ({_interval(cell, column)})" if isinstance(cell, list) else mean


def _interval(cell: Sequence[float], column: Column) -> str:
    return " to ".join(f"{end:.{column.digits}f}" for end in cell[1:])


def _mean(cell: Cell) -> float:
    if isinstance(cell, str):
        raise ResultsError(f"'{cell}' is a text where a number is needed")
    return cell[0] if isinstance(cell, list) else cell


def _is_numeric(table: Table, column: Column) -> bool:
    cells = [table.cell(row, column) for row in table.rows]
    return all(cell is None or isinstance(cell, float | int) for cell in cells)


def _source(row: Row) -> tuple[str, str, str]:
    return (row.command, row.commit, str(row.date))


def _key(name: str) -> str:
    return name if re.fullmatch(r"[\w-]+", name, re.ASCII) else json.dumps(name)


def _toml(value: Any) -> str:
    match value:
        case dict():
            return "{ " + ", ".join(f"{_key(k)} = {_toml(v)}" for k, v in value.items()) + " }"
        case list():
            return "[" + ", ".join(map(_toml, value)) + "]"
        case bool():
            return str(value).lower()
        case str() if "\n" in value:
            return f"'''\n{value}'''"  # a command, as it stands in a shell
        case str():
            return json.dumps(value, ensure_ascii=False)
        case float():
            return f"{value:.0f}" if value.is_integer() else repr(value)
        case _:
            return str(value)
