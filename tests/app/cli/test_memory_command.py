"""`find --memory` and `hypernav memory`, from the command line."""

import errno
import json
import math
import os
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from box_scenes import room_glb
from full_disks import full_disk
from hypernav.app.build.memories.memory_page import ways
from hypernav.app.cli.main import main
from hypernav.core.errors import OutputError
from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.transforms import Pose2
from hypernav.io.folder_lock import folder_lock
from hypernav.search.memory.key_images import KeyImage
from memory_folders import change_index, files_of

SMALL = ("--set", "embodiment.camera.width=160", "embodiment.camera.height=120")


def hypernav(*arguments):
    """Run the command; returns its exit status."""
    with pytest.raises(SystemExit) as stop:
        main([str(argument) for argument in arguments])
    return stop.value.code


@pytest.fixture(scope="module")
def searched(tmp_path_factory) -> Path:
    """A folder with a scene, and the memory of a search in it."""
    folder = tmp_path_factory.mktemp("searched")
    glb = room_glb(folder / "room.glb")
    memory = folder / "home"
    out = folder / "out"
    status = hypernav("find", "bed", "--scene", glb, "--out", out, "--memory", memory, *SMALL)
    assert status == 0
    return folder


@pytest.fixture
def home(searched, tmp_path) -> Path:
    """A copy of that memory."""
    copy = tmp_path / "home"
    for path in (searched / "home").rglob("*"):
        if path.is_file():
            target = copy / path.relative_to(searched / "home")
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(path.read_bytes())
    return copy


def test_a_second_search_goes_on_from_the_first(searched, home, tmp_path):
    status = hypernav(
        "find", "bed", "--scene", searched / "room.glb", "--out", tmp_path / "out",
        "--memory", home, "--seed", 3, *SMALL,
    )  # fmt: skip
    assert status == 0
    history = json.loads((home / "memory.json").read_text())["history"]
    assert [one["outcome"] for one in history] == ["found", "found"]


def test_result_and_page_tell_with_which_memory_a_search_began(searched, home, tmp_path):
    first = json.loads((searched / "out" / "result.json").read_text())
    assert first["memory"] == {"folder": "home", "earlier_searches": 0}
    options = ("--scene", searched / "room.glb", "--out", tmp_path / "out", "--max-steps", 1)
    hypernav("find", "bed", "--memory", home, *options, *SMALL)
    second = json.loads((tmp_path / "out" / "result.json").read_text())
    assert second["memory"] == {"folder": "home", "earlier_searches": 1}
    assert "had been in 1 earlier search" in (tmp_path / "out" / "index.html").read_text()
    hypernav("find", "bed", *options, *SMALL)
    without = json.loads((tmp_path / "out" / "result.json").read_text())
    assert "memory" not in without


def test_a_robot_that_cannot_tell_its_start_says_so_and_begins_anew(searched, tmp_path, capsys):
    home, scene = tmp_path / "home", searched / "room.glb"
    hypernav(
        "find", "bed", "--scene", scene, "--out", tmp_path / "corner", "--memory", home,
        "--start", 0.8, 3.2, 150, "--max-steps", 1, *SMALL,
    )  # fmt: skip
    before = (home / "memory.json").read_bytes()
    capsys.readouterr()
    status = hypernav(
        "find", "bed", "--scene", scene, "--out", tmp_path / "out", "--memory", home,
        "--start", 2.5, 2.5, 30, "--relocalize", *SMALL,
    )  # fmt: skip
    assert status == 0
    found = json.loads((tmp_path / "out" / "result.json").read_text())["found_start"]
    assert not found["sure"]
    assert "memory" not in json.loads((tmp_path / "out" / "result.json").read_text())
    assert f"isn't clear: {found['doubt']}" in " ".join(capsys.readouterr().err.split())
    assert found["doubt"] in (tmp_path / "out" / "index.html").read_text()
    assert (home / "memory.json").read_bytes() == before


def test_a_robot_that_finds_its_start_says_where_it_is(searched, home, tmp_path, capsys):
    status = hypernav(
        "find", "bed", "--scene", searched / "room.glb", "--out", tmp_path / "out",
        "--memory", home, "--start", 2.5, 2.5, 30, "--relocalize", *SMALL,
    )  # fmt: skip
    assert status == 0
    found = json.loads((tmp_path / "out" / "result.json").read_text())["found_start"]
    assert found["sure"]
    index = json.loads((home / "memory.json").read_text())
    frame = Pose2(*index["place"]["start"]).to_transform().inverse()
    x, y, _ = frame.apply(np.array([[2.5, 2.5, 0.0]]))[0]
    assert f"the robot is at ({x:.1f}, {y:.1f}) on floor 1 of" in capsys.readouterr().err
    assert "found on floor 1 by one turn" in (tmp_path / "out" / "index.html").read_text()
    assert [one["outcome"] for one in index["history"]] == ["found", "found"]


def test_the_page_does_not_count_the_steps_of_a_search_that_was_killed(home):
    index = json.loads((home / "memory.json").read_text())
    killed = index["history"][0] | {"search": 2, "outcome": "", "steps": 0}
    change_index(home, history=[*index["history"], killed])
    assert hypernav("memory", home) == 0
    rows = re.findall(r'<tr data-kind="search".*?</tr>', (home / "index.html").read_text())
    steps = [re.findall(r"<td[^>]*>([^<]*)</td>", row)[-3:] for row in rows]
    assert steps[0] == ["under way, or killed", "–", "0"]
    assert steps[1][1].isdigit()


@pytest.mark.parametrize(
    ("out", "words"),
    [
        ("home", "is the folder of --memory; choose another"),
        ("home/floor-1", "lies in the memory, whose files it could replace; choose another"),
    ],
)
def test_results_in_the_memory_are_refused_before_anything_is_begun(
    searched, home, monkeypatch, capsys, out, words
):
    monkeypatch.chdir(home.parent)
    before = {path: path.read_bytes() for path in home.rglob("*") if path.is_file()}
    scene = searched / "room.glb"
    assert hypernav("find", "bed", "--scene", scene, "--out", out, "--memory", home, *SMALL) == 2
    assert f"--out {out} {words}" in " ".join(capsys.readouterr().err.split())
    assert {path: path.read_bytes() for path in home.rglob("*") if path.is_file()} == before


def test_a_search_that_is_refused_at_its_start_leaves_no_folder_and_no_file(
    searched, home, tmp_path, capsys
):
    foreign, new, scene = tmp_path / "foreign", tmp_path / "new", searched / "room.glb"
    foreign.mkdir()
    (foreign / "letter.txt").write_text("dear")
    find = ("find", "bed", "--out", tmp_path / "out", *SMALL)
    for refused, words in [
        (("--scene", scene, "--memory", foreign), "holds other files (letter.txt)"),
        (("--scene", "builtin", "--memory", home), "is the memory of searched"),
        (
            ("embodiment.body.radius_m=0.2", "--scene", scene, "--memory", home),
            "embodiment.body.radius_m",
        ),
        (
            ("--scene", scene, "--memory", new, "--start", 90, 90, 0),
            "can't stand at (90.00, 90.00)",
        ),
        (("--scene", scene, "--memory", new, "--agent", "tired:Tired"), "keeps no memory"),
    ]:
        before = set(tmp_path.rglob("*"))
        assert hypernav(*find, *refused) == 2
        assert words in " ".join(capsys.readouterr().err.split())
        assert set(tmp_path.rglob("*")) == before


def test_a_folder_of_results_in_use_leaves_the_memory_as_it_is(searched, home, tmp_path, capsys):
    before = (home / "memory.json").read_bytes()
    out, scene = tmp_path / "out", searched / "room.glb"
    with folder_lock(out):
        status = hypernav(
            "find", "bed", "--scene", scene, "--out", out, "--memory", home, *SMALL
        )  # fmt: skip
    assert status == 2
    assert "is in use by another run" in " ".join(capsys.readouterr().err.split())
    assert (home / "memory.json").read_bytes() == before


def test_a_recorder_that_fails_leaves_the_memory_as_it_is(searched, home, tmp_path, monkeypatch):
    """No step was taken, so the memory has no search more."""

    def full(*args, **options):
        raise OutputError("the disk is full")

    before = files_of(home)
    monkeypatch.setattr("hypernav.app.cli.find.EpisodeRecorder", full)
    out, scene = tmp_path / "out", searched / "room.glb"
    assert hypernav("find", "bed", "--scene", scene, "--out", out, "--memory", home, *SMALL) == 2
    assert files_of(home) == before


def test_what_was_found_counts_though_the_memory_cannot_be_saved(
    searched, tmp_path, monkeypatch, capsys
):
    """The disk is full at the search's end; one that takes long would be stopped on its way."""

    def full(home):
        raise OutputError("the disk is full")

    monkeypatch.setattr("hypernav.search.memory.store.memory_folder.MemoryFolder.save", full)
    monkeypatch.setattr("hypernav.search.memory.store.memory_folder.SAVE_EVERY_S", math.inf)
    out, scene, home = tmp_path / "out", searched / "room.glb", tmp_path / "home"
    assert hypernav("find", "bed", "--scene", scene, "--out", out, "--memory", home, *SMALL) == 2
    assert json.loads((out / "result.json").read_text())["outcome"] == "found"
    assert "the disk is full" in capsys.readouterr().err


def test_images_forgotten_for_want_of_room_are_told(searched, home, tmp_path, capsys):
    index = json.loads((home / "memory.json").read_text())
    index["most_bytes"] = 1000
    (home / "memory.json").write_text(json.dumps(index))
    assert hypernav("memory", home, "--forget", "beds") == 0
    kept = json.loads((home / "memory.json").read_text())
    assert (len(kept["images"]), kept["most_bytes"]) == (len(index["images"]), 1000)
    capsys.readouterr()
    options = ("--scene", searched / "room.glb", "--out", tmp_path / "out", "--memory", home)
    hypernav("find", "bed", *options, "--max-steps", 1, *SMALL)
    said = capsys.readouterr().err
    assert (
        f"{len(index['images'])} key images forgotten: the limit is 0.001 MB (--memory-mb)" in said
    )
    assert json.loads((home / "memory.json").read_text())["images"] == []
    hypernav("memory", home)
    assert "more than 0.001 MB" in (home / "index.html").read_text()


@pytest.mark.parametrize(
    "option", [("--relocalize",), ("--similarity", "local:clip"), ("--memory-mb", "5")]
)
def test_an_option_about_a_memory_needs_one(option, tmp_path, capsys):
    assert hypernav("find", "bed", "--out", tmp_path, *option) == 2
    assert "add --memory FOLDER" in capsys.readouterr().err


def test_the_page_shows_things_images_and_searches(home, capsys):
    assert hypernav("memory", home) == 0
    page = (home / "index.html").read_text()
    assert page.count('class="thing"') == page.count("<rect ")
    assert 'data-words="bed"' in page
    boxes, rows = re.findall(r'<rect id="(.+?)"', page), re.findall(r'data-box="(.+?)"', page)
    assert sorted(boxes) == sorted(rows)
    assert "<figure" in page
    assert f"open {home / 'index.html'}" in capsys.readouterr().out.replace("\n", "")


def test_the_page_says_of_which_things_later_images_show_nothing(home):
    index = json.loads((home / "memory.json").read_text())
    (bed,) = [one for one in index["floors"][0]["things"] if one["label"] == "bed"]
    bed["missed"] = 5
    (home / "memory.json").write_text(json.dumps(index))
    assert hypernav("memory", home) == 0
    page = (home / "index.html").read_text()
    assert page.count("probably gone") == 2  # in its row, and below the plan
    assert "not in 5 later images that should show it" in page
    assert 'class="gone"' in page


def test_the_page_says_how_high_floors_lie_wherever_the_robots_frame_begins(home):
    index = json.loads((home / "memory.json").read_text())
    (first,) = index["floors"]
    index["floors"] = []
    for number, z in enumerate((12.0, 15.0, 9.0), start=1):
        name = f"floor-{number}/state-9.npz"
        (home / name).parent.mkdir(exist_ok=True)
        shutil.copy(home / first["state"]["name"], home / name)
        index["floors"].append({**first, "z": z, "state": {**first["state"], "name": name}})
    (home / "memory.json").write_text(json.dumps(index))
    assert hypernav("memory", home) == 0
    page = (home / "index.html").read_text()
    assert re.findall(r"<h2>(Floor .+?):", page) == [
        "Floor 1",
        "Floor 2, 3.0 m above floor 1",
        "Floor 3, 3.0 m below floor 1",
    ]
    (bed, *_) = [one for one in first["things"] if one["label"] == "bed"]
    height = (bed["low"][2] + bed["high"][2]) / 2
    assert page.count(f"{height:.1f} m above its floor") >= 3


def test_things_are_exported_as_closed_polygons_on_the_map(home, tmp_path):
    assert hypernav("memory", home, "--export", tmp_path / "things.geojson") == 0
    found = json.loads((tmp_path / "things.geojson").read_text())
    beds = [one for one in found["features"] if one["properties"]["label"] == "bed"]
    ring = beds[0]["geometry"]["coordinates"][0]
    assert ring[0] == ring[-1]
    assert len(ring) == 5


def test_exported_heights_are_those_of_the_map_frame(home, tmp_path):
    index = json.loads((home / "memory.json").read_text())
    index["floors"][0]["z"] = -2.5
    (home / "memory.json").write_text(json.dumps(index))
    assert hypernav("memory", home, "--export", tmp_path / "things.geojson") == 0
    found = json.loads((tmp_path / "things.geojson").read_text())["features"]
    things = index["floors"][0]["things"]
    assert things
    for one, thing in zip(found, things, strict=True):
        told = one["properties"]
        assert (told["floor"], told["floor_m"]) == (1, -2.5)
        assert told["bottom_m"] == pytest.approx(thing["low"][2] - 2.5)
        assert told["top_m"] == pytest.approx(thing["high"][2] - 2.5)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--export", "home/memory.json"], "lies in the memory"),
        (["--export", "home/index.html"], "lies in the memory"),
        (["--page", "home/memory.json"], "--page home/memory.json lies in the memory"),
        (["--forget"], "name what to forget"),
        (["--forget", "bedd"], "no 'bedd' is remembered; did you mean 'bed'?"),
    ],
)
def test_mistakes_change_nothing(home, monkeypatch, capsys, options, words):
    monkeypatch.chdir(home.parent)
    before = {path: path.read_bytes() for path in home.rglob("*.*") if path.is_file()}
    assert hypernav("memory", "home", *options) == 2
    assert words in " ".join(capsys.readouterr().err.split())
    assert all(path.read_bytes() == content for path, content in before.items())


def test_what_is_forgotten_is_gone_from_the_folder(home):
    assert hypernav("memory", home, "--forget", "beds", "--forget-images") == 0
    index = json.loads((home / "memory.json").read_text())
    assert not any(one["label"] == "bed" for one in index["floors"][0]["things"])
    assert index["images"] == []
    assert list((home / "images").iterdir()) == []


@pytest.mark.parametrize("name", ["beds", "A-Bed"])
def test_what_is_forgotten_is_counted_by_its_label_and_so_are_images(home, capsys, name):
    images = len(json.loads((home / "memory.json").read_text())["images"])
    assert images > 1
    assert hypernav("memory", home, "--forget", name, "--forget-images") == 0
    said = capsys.readouterr().out.splitlines()
    assert said[:2] == ["1 thing forgotten: bed", f"{images} key images forgotten"]


def test_nothing_is_said_to_be_forgotten_that_could_not_be_saved(home, monkeypatch, capsys):
    def full(descriptor):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    assert hypernav("memory", home, "--forget", "bed", "--forget-images") == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert "No space left on device); what was saved before is whole; free some space" in said.err


@pytest.mark.parametrize("most", [0, 2000])
def test_a_save_into_files_of_a_limited_size_ends_in_one_line(home, capsys, most):
    before = files_of(home)
    with full_disk(most):
        assert hypernav("memory", home, "--forget-images") == 2
    said = capsys.readouterr()
    assert (said.out, said.err.count("\n")) == ("", 1)
    assert "cannot be written (File too large)" in said.err
    assert before.items() <= files_of(home).items()


@pytest.fixture
def read_only(home, monkeypatch) -> Path:
    """The memory as on a read-only file system."""

    open_below = os.open

    def refuse_to_write(path, flags, mode=0o777, *, dir_fd=None):
        folder = None if dir_fd is None else Path(os.readlink(f"/proc/self/fd/{dir_fd}"))
        if flags & (os.O_RDWR | os.O_WRONLY) and folder and folder.is_relative_to(home):
            raise OSError(errno.EROFS, os.strerror(errno.EROFS))
        return open_below(path, flags, mode, dir_fd=dir_fd)

    monkeypatch.setattr(os, "open", refuse_to_write)
    return home


def test_a_memory_on_a_read_only_file_system_can_be_looked_at(read_only, tmp_path, capsys):
    before = files_of(read_only)
    export, page = tmp_path / "things.geojson", tmp_path / "page.html"
    assert hypernav("memory", read_only, "--export", export) == 0
    assert json.loads(export.read_text())["features"]
    assert "no page: " in (said := capsys.readouterr().out)
    assert "(Read-only file system)" in said
    assert "; --page FILE writes it elsewhere" in said
    assert hypernav("memory", read_only, "--page", page) == 0
    assert 'data-words="bed"' in page.read_text()
    assert f"open {page}" in capsys.readouterr().out
    assert hypernav("memory", read_only) == 2
    assert "--page FILE writes it elsewhere" in capsys.readouterr().err
    assert hypernav("memory", read_only, "--forget", "bed") == 2
    assert f"{read_only} cannot be written" in capsys.readouterr().err
    assert files_of(read_only) == before


def test_names_of_the_same_things_are_asked_for_once(home, capsys):
    assert hypernav("memory", home, "--forget", "Bed", "beds", "bed") == 0
    assert capsys.readouterr().out.count("forgotten: bed") == 1


def test_a_memory_that_a_search_uses_is_left_alone(home, capsys):
    before = (home / "memory.json").read_bytes()
    with folder_lock(home):
        assert hypernav("memory", home, "--forget", "bed") == 2
    assert "is in use by another run" in capsys.readouterr().err
    assert (home / "memory.json").read_bytes() == before


def test_a_memory_that_a_first_search_has_not_saved_yet_is_in_use(tmp_path, capsys):
    new = tmp_path / "new"
    with folder_lock(new):
        assert hypernav("memory", new) == 2
    assert "is in use by another run" in capsys.readouterr().err
    assert hypernav("memory", new) == 2
    assert "there is no memory in" in capsys.readouterr().err


def test_a_file_is_no_memory(home, capsys):
    index = home / "memory.json"
    assert hypernav("memory", index) == 2
    assert f"{index} is no folder; name the folder of a memory" in "".join(capsys.readouterr().err)


def test_no_memory_is_one_line(tmp_path, capsys):
    assert hypernav("memory", tmp_path / "none") == 2
    assert "there is no memory in" in capsys.readouterr().err
    assert not (tmp_path / "none").exists()


def test_another_building_and_an_impossible_size_are_one_line(home, tmp_path, capsys):
    command = ("find", "bed", "--out", tmp_path, "--memory", home, *SMALL)
    assert hypernav(*command, "--memory-mb", "0") == 2
    assert "--memory-mb 0.0: megabytes; expected 1.0 to 500.0" in capsys.readouterr().err
    assert hypernav(*command) == 2
    assert "is the memory of searched0/room.glb, and this is builtin" in capsys.readouterr().err


def test_a_plan_joins_no_positions_between_which_the_robot_did_not_drive():
    driven = [(0.0, 0.0), (0.5, 0.0), (0.5, 0.5)]
    another = [(3.0, 0.5), (3.2, 0.5)]
    assert ways([*driven, *another]) == [driven, another]
    assert ways([]) == []


def test_a_thing_is_marked_where_its_image_shows_it():
    camera = PinholeCamera.from_hfov(160, 120, 90.0)
    image = KeyImage(
        number=0, floor=0, search=1, jpeg=b"", png=b"", camera=camera,
        camera_to_map=optical_to_base(1.0), robot=Pose2(0.0, 0.0, 0.0), patches=np.empty(0, int),
    )  # fmt: skip

    shown = image.box_of((4.0, 1.0, 0.5), (4.0, 2.0, 1.0))
    assert shown == pytest.approx((0.25, 0.5, 0.125, 10.0 / 120.0))  # y is to the left
    cut = image.box_of((4.0, -9.0, 0.0), (4.0, 9.0, 1.0))
    assert cut is not None
    assert cut[::2] == (0.0, 1.0)
    assert image.box_of((-4.0, 1.0, 0.5), (-3.0, 2.0, 1.0)) is None
