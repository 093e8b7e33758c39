import csv

import pytest

from eval_runs import SMALL, write_room
from hypernav.app.cli.main import main
from hypernav.lab.evaluation.refinement.page import result_lines
from hypernav.lab.evaluation.store.run_store import EPISODES_FILE

FILES = ("index.html", "refinement.csv", "figure.svg", "figure.png")


def ablate(*arguments):
    """Run the study; returns its exit status."""
    with pytest.raises(SystemExit) as stop:
        main(["ablate", *(str(one) for one in arguments), "--study", "refinement", *SMALL])
    return stop.value.code


@pytest.fixture(scope="module")
def room(tmp_path_factory):
    return write_room(tmp_path_factory.mktemp("scene") / "room.glb")


@pytest.fixture(scope="module")
def studied(room, tmp_path_factory):
    folder = tmp_path_factory.mktemp("studied")
    assert command(room, folder) == 0
    return folder


def command(room, folder):
    return ablate(f"scene:{room}#1", "--of", "paper", "--max-steps", "12", "--out", folder)


def test_a_study_leaves_a_page_a_table_and_a_figure(studied):
    assert all((studied / name).stat().st_size > 0 for name in FILES)
    with (studied / "refinement.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert {row["mask"] for row in rows} == {"raw box", "dilated box", "refined", "true mask"}
    assert {row["box"] for row in rows} == {"true", "jittered"}


@pytest.mark.slow
def test_a_study_that_goes_on_is_like_one_that_was_never_interrupted(studied, room):
    files = {name: (studied / name).read_bytes() for name in FILES}
    lines = studied / EPISODES_FILE
    lines.write_bytes(lines.read_bytes().splitlines(keepends=True)[0])
    assert command(room, studied) == 0
    assert {name: (studied / name).read_bytes() for name in FILES} == files


@pytest.mark.parametrize("option", [("--only", "no-erosion"), ("--list",), ("--workers", "2")])
def test_options_of_variants_are_refused(room, tmp_path, capsys, option):
    assert ablate(f"scene:{room}#1", "--out", tmp_path / "out", *option) == 2
    assert f"{option[0]} has no meaning for --study refinement" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_noisy_detector_is_refused_before_a_folder_is_made(room, tmp_path, capsys):
    detector = ("--detector", "noisy:poor", "--out", tmp_path / "out")
    assert ablate(f"scene:{room}#1", *detector) == 2
    said = capsys.readouterr().err
    assert "--detector noisy:poor doesn't work with --study refinement" in said
    assert not (tmp_path / "out").exists()


def test_without_a_record_it_is_said_that_nothing_was_measured():
    assert result_lines([]) == [
        "nothing was measured: no episode showed its goal within the range of depth"
    ]
