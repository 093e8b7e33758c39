"""Places where nothing can be written: noticed before the work begins, and left as they were."""

import json
import os
import shutil
import subprocess

import pytest

from eval_runs import SMALL, write_room
from hostile.commands import check, run

pytestmark = pytest.mark.slow

COMMANDS = {
    "find": ["find", "bed", "--scene", "room.glb"],
    "eval": ["eval", "scene:room.glb"],
    "ablate": ["ablate", "scene:room.glb"],
    "report": ["report", "."],
    "export": ["houses", "export", "5"],
    "show": ["houses", "show", "5"],
    "episodes": ["houses", "episodes", "houses-train", "--houses", "5:6"],
}
PLACES = [
    "file",
    "file/below",
    "file/far/below",
    "file/../beside",
    "loop",
    "loop/below",
    "dangling",
    "/dev/null",
    "/dev/null/below",
    "/dev/zero",
    "/proc/nowhere",
    "/proc/self/below",
    "/proc/self/fd/99/below",
    "/sys/nowhere",
    "/sys/kernel/below",
    "x" * 256,
    "x" * 300,
    "new/" + "x" * 300,
    "new/" * 2000,
]
FULL = """
import os
from tired import Tired

class Full(Tired):
    '''Fills the disk at its sixth step.'''

    def __init__(self, embodiment):
        super().__init__(embodiment)
        self.steps = 0

    def act(self, observation):
        self.steps += 1
        if self.steps == 6:
            with open("disk/filler", "wb", buffering=0) as file:
                try:
                    while file.write(bytes(1000)):
                        pass
                except OSError:
                    pass
        return super().act(observation)
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("outputs")
    write_room(folder / "room.glb")
    (folder / "file").write_text("in the way")
    (folder / "loop").symlink_to("loop")
    (folder / "dangling").symlink_to("nowhere/at/all")
    return folder


@pytest.mark.parametrize("place", PLACES, ids=range(len(PLACES)))
@pytest.mark.parametrize("command", COMMANDS)
def test_a_place_that_cannot_be_written_is_refused_first(command, place, folder):
    before = sorted(path.name for path in folder.iterdir())
    ended = run([*COMMANDS[command], "--out", place], folder, seconds=5)
    check(ended, 2, "hypernav: ")
    assert ended.err.count("\n") == 1
    assert "cannot be written" in ended.err or "is not a folder" in ended.err
    assert sorted(path.name for path in folder.iterdir()) == before


IN_THE_WAY = {
    "find": ("trace.jsonl", "result.json", "episode.mp4", "index.html"),
    "eval": ("run.json", "episodes.jsonl"),
    "report": ("report.html",),
}


@pytest.mark.parametrize("kind", ["folder", "pipe", "loop", "nowhere", "device", "another file"])
@pytest.mark.parametrize(
    ("command", "name"), [(command, name) for command in IN_THE_WAY for name in IN_THE_WAY[command]]
)
def test_what_lies_where_a_file_will_be_is_refused_first(command, name, kind, folder, tmp_path):
    place = tmp_path / name
    match kind:
        case "folder":
            place.mkdir()
        case "pipe":
            os.mkfifo(place)
        case "loop":
            place.symlink_to(name)
        case "nowhere":
            place.symlink_to("not/there")
        case "device":
            place.symlink_to("/dev/full")
        case "another file":
            place.symlink_to(folder / "file")
    ended = run([*COMMANDS[command], "--out", str(tmp_path)], folder, seconds=5)
    check(ended, 2, f"hypernav: {place} ")
    assert ended.err.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_a_folder_that_is_there_is_left_as_it_was(folder):
    (folder / "mine").mkdir()
    (folder / "mine" / "notes.txt").write_text("keep me")
    check(run(["eval", "scene:no.glb", "--out", "mine"], folder), 2, "no.glb")
    check(run(["eval", "scene:no.glb", "--out", "mine/new/er"], folder), 2, "no.glb")
    assert [path.name for path in (folder / "mine").iterdir()] == ["notes.txt"]
    assert (folder / "mine" / "notes.txt").read_text() == "keep me"


@pytest.fixture
def small_disk(tmp_path, folder):
    """A disk of 4 MB at ``disk``, in a folder with a room and an agent that fills it."""
    (tmp_path / "disk").mkdir()
    command = ["mount", "-t", "tmpfs", "-o", "size=4m", "none", str(tmp_path / "disk")]
    if subprocess.run(command, capture_output=True, check=False).returncode != 0:
        pytest.skip("a small disk can only be mounted as root")
    shutil.copy(folder / "room.glb", tmp_path)
    yield tmp_path
    subprocess.run(["umount", str(tmp_path / "disk")], check=True)


def test_a_search_on_a_full_disk_leaves_what_it_has(small_disk, tired):
    shutil.copy(tired, small_disk)
    (small_disk / "full.py").write_text(FULL)
    command = ["find", "door", "--scene", "room.glb", "--agent", "full:Full", "--out", "disk/out"]
    ended = run([*command, *SMALL], small_disk, seconds=60)
    check(ended, 2, "No space left", "index.html")
    out = small_disk / "disk" / "out"
    result = json.loads((out / "result.json").read_text())
    steps = [json.loads(line)["step"] for line in (out / "trace.jsonl").read_text().splitlines()]
    assert result["outcome"] == "interrupted"
    assert steps == list(range(len(steps)))
    assert len(steps) >= 5
    assert "</html>" in (out / "index.html").read_text()
