"""A run goes on only in the scenes that its episodes were done in."""

import json
import os

import pytest

from eval_runs import record, spec
from hypernav.core.errors import RunFolderError
from hypernav.lab.evaluation.store import scene_files
from hypernav.lab.evaluation.store.run_store import RunStore
from hypernav.lab.evaluation.store.scene_files import SCENES_FILE, keep_scenes


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "room.glb"
    path.write_bytes(b"one")
    return path


def begin(folder, scene):
    """Begin a run of one episode, or go on with it."""
    with RunStore(folder / "run", {}) as store:
        keep_scenes(store, [spec("0", str(scene))])


def finish_an_episode(folder, scene):
    with RunStore(folder / "run", {}) as store:
        store.add(record("0", str(scene)))


def test_houses_are_no_files_and_leave_none(tmp_path):
    finish_an_episode(tmp_path, "houses:1")
    begin(tmp_path, "houses:1")
    assert not (tmp_path / "run" / SCENES_FILE).exists()


@pytest.mark.parametrize("name", ["room.glb", "objects.json"])
def test_a_scene_in_which_an_episode_is_done_stays_the_same(tmp_path, scene, name):
    begin(tmp_path, scene)
    finish_an_episode(tmp_path, scene)
    (tmp_path / name).write_bytes(b"others")
    with pytest.raises(RunFolderError, match=r"other files of the scene .*room\.glb: mesh"):
        begin(tmp_path, scene)


def test_the_same_bytes_at_another_time_are_the_same_file(tmp_path, scene):
    begin(tmp_path, scene)
    finish_an_episode(tmp_path, scene)
    os.utime(scene, (1, 1))
    begin(tmp_path, scene)


def test_files_are_read_once_while_their_sizes_and_times_stay(tmp_path, scene, monkeypatch):
    read = []
    digest = scene_files._digest
    monkeypatch.setattr(scene_files, "_digest", lambda files: read.append(files) or digest(files))
    begin(tmp_path, scene)
    finish_an_episode(tmp_path, scene)
    begin(tmp_path, scene)
    assert len(read) == 1
    os.utime(scene, (1, 1))
    begin(tmp_path, scene)
    begin(tmp_path, scene)
    assert len(read) == 2


def test_a_folder_that_remembers_bare_hashes_goes_on(tmp_path, scene):
    begin(tmp_path, scene)
    finish_an_episode(tmp_path, scene)
    path = tmp_path / "run" / SCENES_FILE
    content = json.loads(path.read_text())
    path.write_text(json.dumps({name: files["hash"] for name, files in content.items()}))
    begin(tmp_path, scene)
    assert json.loads(path.read_text()) == content
    scene.write_bytes(b"other")
    path.write_text(json.dumps({name: files["hash"] for name, files in content.items()}))
    with pytest.raises(RunFolderError, match="choose another"):
        begin(tmp_path, scene)


def test_a_scene_in_which_nothing_is_done_may_be_mended(tmp_path, scene):
    begin(tmp_path, scene)
    scene.write_bytes(b"mended")
    begin(tmp_path, scene)
    finish_an_episode(tmp_path, scene)
    begin(tmp_path, scene)
    scene.write_bytes(b"one")
    with pytest.raises(RunFolderError, match="choose another"):
        begin(tmp_path, scene)


def test_a_folder_that_remembers_no_scene_goes_on(tmp_path, scene):
    finish_an_episode(tmp_path, scene)
    begin(tmp_path, scene)


@pytest.mark.parametrize(
    "content", ["{", "[]", '{"room.glb": 3}', '{"room.glb": {"hash": "a", "size": 1}}']
)
def test_what_is_remembered_may_not_be_damaged(tmp_path, scene, content):
    begin(tmp_path, scene)
    (tmp_path / "run" / SCENES_FILE).write_text(content)
    with pytest.raises(RunFolderError, match=SCENES_FILE):
        begin(tmp_path, scene)
