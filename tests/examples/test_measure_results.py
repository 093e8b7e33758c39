"""What a table's values are measured from, and when one no longer holds."""

import datetime
import importlib
import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from eval_runs import SMALL, record, spec, write_room
from hypernav.core.naming.labels import ObjectLabel
from hypernav.lab.evaluation.failures import Failure

SCRIPTS = Path(__file__).parents[2] / "scripts"
COLUMNS = (
    ("success", 1),
    ("spl", 3),
    ("steps", 0),
    ("found", 0),
    ("wrong_stops", 0),
    ("spl_difference", 3),
    ("spl_times", 2),
)


@pytest.fixture
def modules(monkeypatch):
    monkeypatch.syspath_prepend(str(SCRIPTS))
    return importlib.import_module("measure_results"), importlib.import_module("result_tables")


def write_run(folder: Path, spl: list[float], **values) -> None:
    """The folder of a run: an episode in a house of its own for each SPL; 0 is a failure."""
    folder.mkdir(parents=True)
    told = {
        "hypernav": "0",
        "dataset": "houses-val",
        "selection": {},
        "episodes": {"count": len(spl), "scenes": len(spl), "fingerprint": "0"},
        "who": {"agent": "hypernav", "preset": "default", "detector": "d", "reasoner": "r"},
        "protocol": {
            "max_steps": 500,
            "success_distance_m": 0.1,
            "stop_rule": "stop required",
            "seed": 0,
        },
        "config": {"embodiment": {}, "world": {"sliding": True, "noise": {}}},
    }
    (folder / "run.json").write_text(json.dumps({"created": "now", "configuration": told}))
    lines = [
        record(
            "0",
            f"house {number}",
            path_length_m=4.0 / each if each else 4.0,
            spl=each,
            **({} if each else {"failure": Failure.LANGUAGE, "distance_to_goal_m": 3.0}),
            **values,
        )
        for number, each in enumerate(spl)
    ]
    text = "".join(line.model_dump_json() + "\n" for line in lines)
    (folder / "episodes.jsonl").write_text(text)


def table_of(tables, *rows):
    columns = [
        tables.Column(name=name, head=name, measure=name, digits=digits)
        for name, digits in (*COLUMNS, ("n", 0))
    ]
    return tables.Table(title="Robots", columns=tuple(columns), rows=rows)


def test_values_are_those_of_the_runs_with_their_interval(modules, tmp_path, monkeypatch):
    measure, tables = modules
    write_run(tmp_path / "a", [0.4] * 8)
    write_run(tmp_path / "b", [0.0] + [0.8] * 7)
    monkeypatch.setattr(measure, "_run", lambda command, folder: tmp_path / command[-1])
    told = {"commit": "abcdef1", "date": datetime.date(2020, 1, 1), "cells": {}}
    rows = (
        tables.Row(name="a", command="hypernav eval a", **told),
        tables.Row(name="b", command="hypernav eval b", against="a", **told),
    )
    a, b = measure.measure("robots", table_of(tables, *rows), Path("1234567")).rows
    assert (a.commit, a.date, a.n) == ("1234567", datetime.date.today(), 8)
    assert a.cells == {
        "success": [100.0, 100.0, 100.0], "spl": [0.4, 0.4, 0.4], "steps": [20.0, 20.0, 20.0],
        "found": 8.0, "wrong_stops": "0 of 8",
    }  # fmt: skip
    assert b.cells["success"][0] == 87.5
    assert b.cells["wrong_stops"] == "1 of 8"
    mean, low, high = b.cells["spl_difference"]
    assert low < mean == 0.3 < high
    assert b.cells["spl_times"][0] == 1.75


def test_later_goals_of_lives_are_counted_alone(modules, tmp_path, monkeypatch):
    measure, tables = modules
    write_run(tmp_path / "a", [0.4] * 3, life="0", goal_number=1)
    monkeypatch.setattr(measure, "_run", lambda command, folder: tmp_path / "a")
    told = {"commit": "abcdef1", "date": datetime.date(2020, 1, 1), "cells": {}}
    row = tables.Row(name="a", command="hypernav eval a", part="later", **told)
    (found,) = dict(measure._measured(table_of(tables, row), [row], tmp_path)).values()
    assert found.records == []


def test_goals_on_other_floors_are_those_above_and_below(modules, tmp_path, monkeypatch):
    measure, _ = modules
    write_run(tmp_path / "a", [0.2, 0.4, 0.6])
    (run,) = measure.load_runs([tmp_path / "a"])
    where = {"house 0": "same", "house 1": "above", "house 2": "below"}
    monkeypatch.setattr(measure, "direction", lambda episode: where[episode.scene_id])
    monkeypatch.setattr(measure, "load_episodes", lambda name: [spec("0", one) for one in where])
    spl = {
        part: [one.spl for one in measure._part_of(run, part)]
        for part in ("", "same", "above", "other")
    }
    assert spl == {"": [0.2, 0.4, 0.6], "same": [0.2], "above": [0.4], "other": [0.4, 0.6]}


@pytest.mark.parametrize(
    ("start_z", "goal_z", "where"),
    [(0.0, 0.4, "same"), (3.1, 2.98, "same"), (3.0, 0.0, "below"), (0.0, 6.7, "above")],
)
def test_where_a_goal_is_counts_from_the_floor_of_the_start(
    start_z, goal_z, where, modules, monkeypatch
):
    measure, _ = modules
    bed = SimpleNamespace(label=ObjectLabel("bed"), box_min=(0.0, 0.0, goal_z))
    scene = SimpleNamespace(storeys=(0.0, 3.0, 6.1), instances=[bed])
    monkeypatch.setattr(measure, "cached_building", lambda building: scene)
    assert measure.direction(replace(spec("0", "storeys:7"), start_z=start_z)) == where


@pytest.mark.parametrize(
    ("then", "now", "holds"),
    [
        ([0.6, 0.55, 0.65], [0.6] * 10, True),
        ([0.6, 0.55, 0.65], [0.5, 0.7] * 5, True),
        ([0.6, 0.55, 0.65], [0.66, 0.5, 0.82] * 3, True),  # outside of the interval, by chance
        ([0.6, 0.55, 0.65], [0.3, 0.4] * 5, False),
        ([0.6, 0.55, 0.65], [0.8, 0.9] * 5, False),
    ],
)
def test_a_value_holds_while_the_interval_of_the_difference_includes_0(then, now, holds, modules):
    measure, tables = modules
    estimate = measure.mean_with_interval(now, [str(number) for number in range(len(now))])
    column = tables.Column(name="spl", head="SPL", measure="spl", digits=3)
    assert measure.Check("x", column, then, estimate).holds(1) is holds


def test_all_found_of_ten_is_no_reason_to_doubt_99_percent(modules):
    measure, tables = modules
    column = tables.Column(name="success", head="success", measure="success", digits=1)
    ten, hundreds = (
        measure.mean_with_interval([1.0] * n, [*map(str, range(n))]) for n in (10, 900)
    )
    assert measure.Check("x", column, [99.0, 98.5, 99.5], ten).holds(1)
    assert not measure.Check("x", column, [90.0, 89.0, 91.0], hundreds).holds(1)


def test_the_more_values_are_checked_the_farther_one_may_lie_by_chance(modules):
    measure, tables = modules
    column = tables.Column(name="spl", head="SPL", measure="spl", digits=3)
    now = measure.Estimate(0.66, 0.62, 0.70, 10, 10)
    check = measure.Check("x", column, [0.6, 0.6, 0.6], now)
    assert not check.holds(1)
    assert check.holds(100)


def test_what_cannot_be_measured_says_so(modules, tmp_path, capsys):
    measure, tables = modules
    row = 'name = "a"\ncommand = "python benchmarks/step.py"\ncommit = "abcdef1"\n'
    (tmp_path / "mine.toml").write_text(
        f'title = "A"\ncolumns = [{{ name = "x", head = "x" }}]\n[[rows]]\n{row}'
        "date = 2026-11-29\ncells = { x = 1 }\n"
    )
    assert measure.main(["other"], data=tmp_path) == 1
    assert "there is no table 'other', only mine" in capsys.readouterr().err
    table = tables.Results(tmp_path).table("mine")
    assert measure.main(["--check"], data=tmp_path) == 1
    assert "mine: no row has a check" in capsys.readouterr().err
    with pytest.raises(tables.ResultsError, match="its values are typed by hand"):
        measure.measure("mine", table, tmp_path)
    row = table.rows[0].model_copy(update={"command": "hypernav eval houses-val"})
    column = tables.Column(name="x", head="x", measure="sp")
    table = table.model_copy(update={"rows": (row,), "columns": (column,)})
    with pytest.raises(tables.ResultsError, match="mine: nothing measures sp, only"):
        measure.measure("mine", table, tmp_path)


@pytest.mark.slow
def test_a_small_table_is_measured_written_and_checked(modules, tmp_path, monkeypatch, capfd):
    measure, tables = modules
    monkeypatch.setattr(measure, "commit_of_code", lambda: "1234567")
    room = write_room(tmp_path / "scene" / "room.glb")
    command = f"hypernav eval 'scene:{room}#3' --workers 1 --quiet {' '.join(SMALL)} --agent "
    told = {"commit": "abcdef1", "date": datetime.date(2020, 1, 1), "check": "0:6"}
    rows = (
        tables.Row(name="a", command=command + "frontier", cells={"spl": 0.1}, **told),
        tables.Row(name="b", command=command + "hypernav", against="a", cells={}, **told),
    )
    data = tmp_path / "data"
    data.mkdir()
    (data / "room.toml").write_text(tables.to_toml(table_of(tables, *rows)))
    assert measure.main(["room"], data=data, runs=tmp_path / "runs") == 0
    a, b = tables.Results(data).table("room").rows
    assert a.n == b.n == 6
    assert a.commit == "1234567"
    assert a.cells["spl"][0] > 0.2
    assert measure.main(["--check"], data=data, runs=tmp_path / "runs") == 0
    assert "6 of 6 values hold" in capfd.readouterr().out
    text = tables.to_toml(
        table_of(tables, a.model_copy(update={"cells": {"spl": [0.1, 0.1, 0.1]}}))
    )
    (data / "room.toml").write_text(text)
    assert measure.main(["--check", "room"], data=data, runs=tmp_path / "runs") == 1
    assert "LEFT ITS INTERVAL" in capfd.readouterr().out
