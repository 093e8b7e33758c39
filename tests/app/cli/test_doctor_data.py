"""hypernav doctor --data: what of the benchmarks is there, and what is missing."""

import shutil

import numpy as np
import pytest

from hypernav.app.cli.main import main
from scan_writers.basis_bytes import ktx2
from scan_writers.buildings import two_storeys
from scan_writers.data_folder import BELOW
from scan_writers.episodes import HASH, SCENE, episode, write_split


@pytest.fixture
def data(benchmark_data, tmp_path):
    return shutil.copytree(benchmark_data, tmp_path / "data")


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
    assert "4 episodes in 1 scene, 4 categories" in line_of(lines, "hm3d v1/val:")
    assert line_of(lines, "ovon hm3d/val_seen_synonyms:").startswith("ok")
    assert line_of(lines, "hm3d v2/val annotations:").startswith("ok")
    assert line_of(lines, "mp3d v1/val navmeshes:").startswith("note")
    assert not any(line.startswith("FAULT") for line in lines)


def test_goals_of_goat_bench_that_cannot_be_run_are_counted(data, capsys):
    _, lines = examine(capsys, data)
    assert "4 goals of lives in 1 scene, 2 categories" in line_of(lines, "goat v1/val_unseen:")
    goals = line_of(lines, "goat v1/val_unseen goals:")
    assert goals.startswith("note")
    assert "2 category goals, 1 description goal, 1 image goal; 1 of them are left out" in goals


def test_missing_scenes_are_named_with_where_to_get_them(data, capsys):
    shutil.rmtree(data / "scene_datasets" / "hm3d" / "val" / SCENE)
    status, lines = examine(capsys, data)
    assert status == 1
    assert f"0 of 1 scene; missing: {SCENE}" in line_of(lines, "hm3d v1/val scenes:")
    remedies = lines[lines.index("what to change:") :]
    assert any("matterport.com" in line for line in remedies)
    assert not any("goat-bench" in line or "DATASETS.md" in line for line in remedies)


def test_a_split_that_is_missing_is_a_note_where_others_are_there(data, capsys):
    shutil.rmtree(data / "datasets" / "ovon" / "hm3d" / "val_unseen")
    status, lines = examine(capsys, data)
    assert status == 0
    assert "no episodes of val_unseen" in line_of(lines, "ovon episodes:")


def test_scenes_without_episodes_are_a_fault(data, capsys):
    shutil.rmtree(data / "datasets" / "objectnav" / "mp3d")
    status, lines = examine(capsys, data)
    assert status == 1
    assert "no episodes for the scenes in" in line_of(lines, "mp3d episodes:")


def test_scenes_that_benchmarks_share_need_the_episodes_of_one(data, capsys):
    shutil.rmtree(data / "datasets")
    status, lines = examine(capsys, data)
    said = line_of(lines, "hm3d or ovon or goat episodes:")
    assert status == 1
    assert f"no episodes for the scenes in {data / 'scene_datasets' / 'hm3d'}" in said
    assert str(data / "datasets" / "goat_bench") in said


@pytest.mark.parametrize("kind", ["goat_bench", "ovon", "objectnav/hm3d"])
def test_a_benchmark_without_the_others_is_whole(data, capsys, kind):
    others = data.with_name("others")
    (data / "datasets").rename(others)
    shutil.copytree(others / kind, data / "datasets" / kind)
    shutil.rmtree(data / "scene_datasets" / "mp3d")
    status, lines = examine(capsys, data)
    assert (status, lines[-1]) == (0, "all is well")
    assert line_of(lines, "mp3d:").startswith("note")
    assert not any(line.startswith("FAULT") for line in lines)


def test_a_benchmark_that_is_begun_is_no_other_ones_note(data, capsys):
    shutil.rmtree(data / "datasets" / "goat_bench" / "hm3d" / "v1")
    (data / "datasets" / "goat_bench" / "hm3d" / "v1" / "val_unseen").mkdir(parents=True)
    status, lines = examine(capsys, data)
    assert status == 1
    assert line_of(lines, "goat episodes:").startswith("FAULT")
    assert lines[-1] == (
        "  goat episodes: linked in the README of https://github.com/Ram81/goat-bench"
    )


def test_a_broken_episode_file_is_named(data, capsys):
    file = data / "datasets" / "objectnav" / "hm3d" / "v1" / "val" / "content" / f"{HASH}.json.gz"
    file.write_bytes(file.read_bytes()[:-30])
    status, lines = examine(capsys, data)
    assert status == 1
    assert f"{HASH}.json.gz: broken gzip data" in line_of(lines, "hm3d v1/val:")


def test_compressed_textures_need_their_package(data, capsys, monkeypatch):
    folder = data / "scene_datasets" / "hm3d" / "val" / SCENE
    (folder / f"{HASH}.basis.glb").write_bytes(ktx2(np.zeros((1, 1, 3), int)))
    monkeypatch.setattr("hypernav.lab.evaluation.checks.data_folder.find_spec", lambda name: None)
    status, lines = examine(capsys, data)
    assert status == 1
    assert line_of(lines, "hm3d v1/val textures:").startswith("FAULT")
    assert any("pip install 'hypernav[hm3d]'" in line for line in lines)


def test_an_empty_folder_holds_no_benchmark(tmp_path, capsys):
    status, lines = examine(capsys, tmp_path)
    assert status == 1
    assert any(line.startswith("FAULT folder:") for line in lines)
    assert all(one in lines[-1] for one in ("HM3D ObjectNav", "HM3D-OVON", "GOAT-Bench"))


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"junk", "not valid JSON"),
        (None, "is missing"),
        (b'{"episodes": [{}, {}]}', "holds 2 episodes"),
    ],
)
def test_a_main_file_that_is_not_read_is_a_note(data, capsys, content, words):
    split = data / "datasets" / "goat_bench" / "hm3d" / "v1" / "val_unseen"
    file = split / "val_unseen.json.gz"
    file.unlink() if content is None else file.write_bytes(content)
    status, lines = examine(capsys, data)
    said = line_of(lines, "goat v1/val_unseen main file:")
    assert status == 0
    assert said.startswith("note")
    assert str(file) in said
    assert words in said
    assert said.endswith("; runs read content/ alone")


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


def test_a_split_without_episodes_is_a_fault_in_the_words_of_eval(data, tmp_path, capsys):
    shutil.rmtree(data / "datasets" / "objectnav" / "mp3d" / "v1" / "val" / "content")
    status, lines = examine(capsys, data)
    words = line_of(lines, "mp3d v1/val:").partition(": ")[2]
    assert status == 1
    assert "content, which is missing; unpack the archive again" in words
    with pytest.raises(SystemExit) as stop:
        main(["eval", f"mp3d:{data}", "--out", str(tmp_path / "run")])
    assert stop.value.code == 2
    assert words.strip() in capsys.readouterr().err


@pytest.mark.parametrize("ending", [".glb", ".basis.navmesh", ".semantic.glb"])
def test_a_file_of_a_scene_that_is_cut_off_is_a_fault(data, capsys, ending):
    file = data / "scene_datasets" / "hm3d" / "val" / SCENE / f"{HASH}{ending}"
    file.write_bytes(file.read_bytes()[:-40])
    status, lines = examine(capsys, data)
    found = line_of(lines, "hm3d files:")
    assert status == 1
    assert found.startswith("FAULT")
    assert str(file) in found
    assert "cut off" in found
    assert lines[-1].startswith("  hm3d files: get these scenes again")


def test_episodes_that_repeat_in_another_file_are_a_fault(data, capsys):
    content = data / "datasets" / "objectnav" / "hm3d" / "v1" / "val" / "content"
    shutil.copy(content / f"{HASH}.json.gz", content / "copy.json.gz")
    status, lines = examine(capsys, data)
    assert status == 1
    assert "two episodes are called 0" in line_of(lines, "hm3d v1/val:")


def test_our_own_export_is_recognised(data, capsys):
    scene = f"hypernav/{SCENE}/{HASH}.glb"
    own = data.with_name("own")
    shutil.copytree(
        data / "scene_datasets" / "hm3d" / "val" / SCENE,
        own / "scene_datasets" / "hypernav" / SCENE,
    )
    found = [episode(0, scene, "chair", BELOW)]
    write_split(own / "datasets" / "objectnav" / "hypernav" / "houses-val", two_storeys(), found)
    status, lines = examine(capsys, own)
    assert (status, lines[-1]) == (0, "all is well")
    assert "1 episode in 1 scene" in line_of(lines, "generated hypernav/houses-val:")
