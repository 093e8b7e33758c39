"""hypernav doctor --data: what of the benchmarks is there, and what is missing."""

import shutil

import numpy as np
import pytest

from hypernav.cli.main import main
from scan_writers.basis_bytes import ktx2
from scan_writers.data_folder import write_data
from scan_writers.episodes import HASH, SCENE


@pytest.fixture
def data(tmp_path):
    return write_data(tmp_path / "data")


def examine(capsys, folder):
    """Exit status and the lines that doctor prints."""
    with pytest.raises(SystemExit) as stop:
        main(["doctor", "--data", str(folder)])
    said = capsys.readouterr()
    return stop.value.code, (said.out or said.err).splitlines()


def line_of(lines, start):
    (found,) = [line for line in lines if line.split(maxsplit=1)[-1].startswith(start)]
    return found


def test_a_whole_folder_is_well(data, capsys):
    status, lines = examine(capsys, data)
    assert (status, lines[-1]) == (0, "all is well")
    assert "4 episodes in 1 scenes, 4 categories" in line_of(lines, "hm3d v1/val:")
    assert line_of(lines, "ovon hm3d/val_seen_synonyms:").startswith("ok")
    assert line_of(lines, "hm3d v2/val annotations:").startswith("ok")
    assert line_of(lines, "mp3d v1/val navmeshes:").startswith("note")
    assert not any(line.startswith("FAULT") for line in lines)


def test_missing_scenes_are_named_with_where_to_get_them(data, capsys):
    shutil.rmtree(data / "scene_datasets" / "hm3d" / "val" / SCENE)
    status, lines = examine(capsys, data)
    assert status == 1
    assert f"0 of 1 scenes; missing: {SCENE}" in line_of(lines, "hm3d v1/val scenes:")
    remedies = lines[lines.index("what to change:") :]
    assert any("matterport.com" in line for line in remedies)


def test_a_split_that_is_missing_is_a_note_where_others_are_there(data, capsys):
    shutil.rmtree(data / "datasets" / "ovon" / "hm3d" / "val_unseen")
    status, lines = examine(capsys, data)
    assert status == 0
    assert "no episodes of val_unseen" in line_of(lines, "ovon episodes:")


def test_scenes_without_episodes_are_a_fault(data, capsys):
    shutil.rmtree(data / "datasets" / "objectnav" / "mp3d")
    status, lines = examine(capsys, data)
    assert status == 1
    assert "no episodes of val" in line_of(lines, "mp3d episodes:")


def test_a_broken_episode_file_is_named(data, capsys):
    file = data / "datasets" / "objectnav" / "hm3d" / "v1" / "val" / "content" / f"{HASH}.json.gz"
    file.write_bytes(file.read_bytes()[:-30])
    status, lines = examine(capsys, data)
    assert status == 1
    assert f"{HASH}.json.gz: broken gzip data" in line_of(lines, "hm3d v1/val:")


def test_compressed_textures_need_their_package(data, capsys, monkeypatch):
    folder = data / "scene_datasets" / "hm3d" / "val" / SCENE
    (folder / f"{HASH}.basis.glb").write_bytes(ktx2(np.zeros((1, 1, 3), int)))
    monkeypatch.setattr("hypernav.evaluation.data_checkup.find_spec", lambda name: None)
    status, lines = examine(capsys, data)
    assert status == 1
    assert line_of(lines, "hm3d v1/val textures:").startswith("FAULT")
    assert any("pip install 'hypernav[hm3d]'" in line for line in lines)


def test_an_empty_folder_holds_no_benchmark(tmp_path, capsys):
    status, lines = examine(capsys, tmp_path)
    assert status == 1
    assert any(line.startswith("FAULT folder:") for line in lines)


def test_a_folder_that_is_none_says_so(tmp_path, capsys):
    status, lines = examine(capsys, tmp_path / "nowhere")
    assert status == 1
    assert "is no folder" in lines[0]


@pytest.mark.parametrize("part", ["scene_datasets", "datasets"])
def test_whoever_names_a_part_of_the_data_is_told_the_whole(data, capsys, part):
    status, lines = examine(capsys, data / part)
    assert status == 1
    assert "holds one part of the data only" in line_of(lines, "folder:")
    assert lines[-1].endswith(f"name the folder above it: {data}")


def test_something_has_to_be_named(capsys):
    with pytest.raises(SystemExit) as stop:
        main(["doctor"])
    assert stop.value.code == 2
    assert "--vlm SPEC, a model, or --data DIR" in capsys.readouterr().err
