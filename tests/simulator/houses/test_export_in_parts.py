"""Parts of a split, written into one folder one after the other, or interrupted."""

import gzip
import json

import pytest

from box_houses import box_house
from hypernav.app.build.data.datasets import load_episodes
from hypernav.app.cli import houses
from hypernav.app.cli.main import main
from hypernav.core.errors import EpisodeError
from hypernav.simulator.houses.episodes import splits
from hypernav.simulator.houses.episodes.splits import load_split
from hypernav.simulator.houses.export import habitat_data
from hypernav.simulator.houses.export.building_files import ExportedBuilding
from hypernav.simulator.houses.export.habitat_data import HabitatData, export_split, of_scene

SPLIT = "houses-train"
ENDINGS = (".glb", ".objects.json", ".semantic.glb", ".semantic.txt", ".navmesh")


def empty_files(building, out_dir):
    """What `export_building` writes, without content."""
    out_dir.mkdir(parents=True, exist_ok=True)
    paths = [out_dir / f"{building.file_stem}{ending}" for ending in ENDINGS]
    for path in paths:
        path.touch()
    return ExportedBuilding(*paths)


@pytest.fixture
def dataset(tmp_path, monkeypatch):
    """Two houses out of boxes, whose scenes are exported as empty files."""
    monkeypatch.setattr(splits, "cached_building", box_house)
    monkeypatch.setattr(habitat_data, "cached_building", box_house)
    monkeypatch.setattr(habitat_data, "export_building", empty_files)
    monkeypatch.setattr(habitat_data.NavmeshSurface, "load", lambda path: None)
    monkeypatch.setattr(habitat_data, "_measured", lambda part, surface: part)
    return load_split(SPLIT, numbers=range(5, 7), cache=tmp_path / "cache")


@pytest.fixture
def interrupted(monkeypatch):
    """House 6 is interrupted in the middle of its scene."""

    def export(building, out_dir):
        files = empty_files(building, out_dir)
        if building.number == 6:
            raise KeyboardInterrupt
        return files

    def interrupt():
        monkeypatch.setattr(habitat_data, "export_building", export)

    return interrupt


def test_parts_fit_together(dataset, tmp_path):
    for number in (5, 6):
        data = export_split(of_scene(dataset, f"houses:{number}"), SPLIT, tmp_path / "ex")
    assert data.buildings == {"house_5", "house_6"}
    config = json.loads(data.dataset_config.read_text())
    assert len(config["stages"]["paths"][".glb"]) == 2
    files = [json.loads(gzip.decompress(f.read_bytes())) for f in data.content.iterdir()]
    numbers = [file["category_to_task_category_id"] for file in files]
    assert numbers[0] == numbers[1]
    assert numbers[0].keys() >= {e["object_category"] for f in files for e in f["episodes"]}


def test_an_interrupted_export_leaves_whole_buildings_and_can_be_repeated(
    dataset, tmp_path, interrupted, monkeypatch
):
    data = export_split(dataset, SPLIT, tmp_path / "ex")
    interrupted()
    with pytest.raises(KeyboardInterrupt):
        export_split(dataset, SPLIT, tmp_path / "ex")
    assert data.buildings == {"house_5"}
    assert data.dataset_config.is_file()
    assert len(load_episodes(f"habitat:{data.episodes}")) == 28
    monkeypatch.setattr(habitat_data, "export_building", empty_files)
    assert export_split(dataset, SPLIT, tmp_path / "ex").buildings == {"house_5", "house_6"}


def test_phrases_are_exported_all_at_once(dataset, tmp_path):
    data = HabitatData(tmp_path, "houses-ovon")
    data.content.mkdir(parents=True)
    (data.content / "house_2001.json.gz").touch()
    with pytest.raises(EpisodeError, match="1 other buildings of houses-ovon"):
        export_split(dataset, "houses-ovon", tmp_path)


def hypernav(*arguments):
    with pytest.raises(SystemExit) as stop:
        main([str(argument) for argument in arguments])
    return stop.value.code


def test_the_command_says_what_the_folder_holds(dataset, tmp_path, monkeypatch, capsys):
    for number in (5, 6):
        part = of_scene(dataset, f"houses:{number}")
        monkeypatch.setattr(houses, "load_split", lambda *_, part=part, **__: part)
        command = ("houses", "export", f"{SPLIT}#{number}", "--out", tmp_path / "ex")
        assert hypernav(*command) == 0
    said = capsys.readouterr().err
    assert "holds 1 of its buildings" in said
    assert f"28 episodes of {SPLIT} written" in said
    assert "holds 2 of its buildings" in said


def test_the_command_says_how_to_complete_what_was_interrupted(
    dataset, tmp_path, interrupted, monkeypatch, capsys
):
    interrupted()
    monkeypatch.setattr(houses, "load_split", lambda *_, **__: dataset)
    assert hypernav("houses", "export", f"{SPLIT}#5:7", "--out", tmp_path / "ex") == 130
    said = capsys.readouterr().err
    assert f"interrupted; buildings of {SPLIT} that are complete in {tmp_path / 'ex'}: 1." in said
    assert "Run the same command again" in said
