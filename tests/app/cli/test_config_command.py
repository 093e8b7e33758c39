import json

import pytest

from hypernav.app.cli.main import main


def hypernav(*arguments):
    """Run the command; returns its exit status."""
    with pytest.raises(SystemExit) as stop:
        main([str(argument) for argument in arguments])
    return stop.value.code


def test_one_value_is_shown_with_all_that_is_known_of_it(capsys):
    assert hypernav("config", "search.stop_distance_m") == 0
    printed = capsys.readouterr().out
    assert "search.stop_distance_m = 0.2 m\n" in printed
    assert "    0 to 10; measured; preset paper: 0.45\n" in printed
    assert "    Distance from the robot to an entry point" in printed
    assert "endurance_steps" not in printed


def test_without_a_section_all_are_listed(capsys):
    assert hypernav("config") == 0
    printed = capsys.readouterr().out
    assert all(f"\n{key} = " in printed for key in ("embodiment.body.radius_m", "policy.seed"))


def test_a_mistyped_section_is_bad_usage(capsys):
    assert hypernav("config", "searc") == 2
    assert "did you mean 'search'?" in capsys.readouterr().err


def test_the_schema_is_written_with_the_line_that_makes_editors_read_it(tmp_path, capsys):
    file = tmp_path / "schema.json"
    assert hypernav("config", "--schema", file) == 0
    assert f"$schema={file}" in capsys.readouterr().out
    assert "search" in json.loads(file.read_text("utf-8"))["properties"]
