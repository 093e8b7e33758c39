"""A memory that somebody else has made: nothing outside its folder is touched, all is bounded."""

import hashlib
import io
import json
import math
import os
import shutil
import struct
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from hypernav.app.cli.main import main
from hypernav.app.cli.serve import _check_memory as check_memory
from hypernav.core.errors import MemoryFolderError, RunFolderError
from hypernav.search.memory.store.memory_writer import INDEX_NAME
from memory_folders import change_index, files_of, opened, searched


@pytest.fixture(scope="module")
def written(tmp_path_factory) -> Path:
    return searched(tmp_path_factory.mktemp("memory") / "home")


@pytest.fixture
def home(written, tmp_path) -> Path:
    """A copy of a memory of two floors, to be made hostile."""
    return Path(shutil.copytree(written, tmp_path / "home"))


@pytest.fixture
def mine(tmp_path) -> Path:
    """A file of one's own, beside the memory."""
    path = tmp_path / "mine.txt"
    path.write_text("mine")
    return path


def command(*arguments: object) -> int:
    """The exit status of a command."""
    with pytest.raises(SystemExit) as stop:
        main([str(one) for one in arguments])
    return int(stop.value.code or 0)


def index_of(folder: Path) -> dict[str, Any]:
    return json.loads((folder / INDEX_NAME).read_text())


def with_content(folder: Path, record: dict[str, Any], content: bytes) -> dict[str, Any]:
    """A file with other content, and the record that vouches for it."""
    (folder / record["name"]).write_bytes(content)
    return record | {"size": len(content), "sha256": hashlib.sha256(content).hexdigest()}


def with_state(folder: Path, content: bytes) -> None:
    """Give the first floor another state."""
    floors = index_of(folder)["floors"]
    floors[0]["state"] = with_content(folder, floors[0]["state"], content)
    change_index(folder, floors=floors)


NAMES = [".lock", ".lock.owner", ".memory.json.new", ".index.html.new", "images/.000000.jpg.new"]


@pytest.mark.parametrize("name", [*NAMES, "memory.json", "floor-2/state-1.npz", "notes.txt"])
def test_no_link_in_a_memory_leads_to_a_file_elsewhere(home, mine, name, capsys):
    (home / name).unlink(missing_ok=True)
    (home / name).symlink_to(mine)
    assert command("memory", home) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert f"{name.rpartition('/')[2]} is a link, expected a file" in said
    assert command("memory", home, "--forget-images") == 2
    assert mine.read_text() == "mine"


@pytest.mark.parametrize(
    "name", [*NAMES, "memory.json", "floor-1/state-1.npz", "images/000000.jpg"]
)
def test_no_pipe_in_a_memory_is_waited_for(home, name, capsys):
    (home / name).unlink(missing_ok=True)
    os.mkfifo(home / name)
    assert command("memory", home) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "is a pipe, expected a file" in said


@pytest.mark.parametrize("name", [*NAMES, "memory.json", "floor-1/state-1.npz"])
def test_a_server_waits_for_no_pipe_either(home, name):
    (home / name).unlink(missing_ok=True)
    os.mkfifo(home / name)
    with pytest.raises((MemoryFolderError, RunFolderError), match="is a pipe, expected a file"):
        check_memory(home)


@pytest.mark.parametrize("forget", [(), ("--forget-images",)])
def test_no_image_is_removed_from_a_linked_folder(home, tmp_path, forget):
    photos = tmp_path / "photos"
    (home / "images").rename(photos)
    (photos / "000123.jpg").write_bytes(b"a photo")
    before = files_of(photos)
    (home / "images").symlink_to(photos)
    assert command("memory", home, *forget) == 2
    assert files_of(photos) == before


def test_a_link_to_the_memory_itself_is_followed(home, tmp_path):
    (tmp_path / "mem").symlink_to(home)
    assert command("memory", tmp_path / "mem", "--forget-images") == 0
    assert index_of(home)["images"] == []


def png(width: int, height: int, bits: int, colours: int, *, missing_rows: int = 0) -> bytes:
    """A PNG of zeros, of any size; its last rows may be missing."""
    channels = 3 if colours == 2 else 1
    row = bytes(1 + width * channels * bits // 8)
    packer = zlib.compressobj(1)
    data = b"".join(packer.compress(row) for _ in range(height - missing_rows))
    data += packer.flush()
    head = struct.pack(">IIBBBBB", width, height, bits, colours, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(part)) + kind + part + struct.pack(">I", zlib.crc32(kind + part))
        for kind, part in ((b"IHDR", head), (b"IDAT", data), (b"IEND", b""))
    )


def encoded(ending: str, image: np.ndarray) -> bytes:
    return cv2.imencode(ending, image)[1].tobytes()


@pytest.mark.parametrize("is_map_lost", [True, False])
@pytest.mark.parametrize(
    ("key", "content"),
    [
        ("jpeg", png(4000, 2000, 8, 2)),
        ("png", png(4000, 2000, 16, 0)),
        ("jpeg", encoded(".jpg", np.zeros((9, 9, 3), np.uint8))),
        ("png", encoded(".png", np.zeros((8, 8, 3), np.uint8))),
        ("png", encoded(".png", np.zeros((8, 8), np.uint8))),
        ("png", encoded(".jpg", np.zeros((8, 8), np.uint8))),
    ],
)
def test_an_image_of_another_size_or_kind_is_left_out_undecoded(
    home, monkeypatch, key, content, is_map_lost
):
    decode = cv2.imdecode

    def small(data: np.ndarray, how: int) -> Any:
        assert data.tobytes() != content
        return decode(data, how)

    monkeypatch.setattr(cv2, "imdecode", small)
    images = index_of(home)["images"]
    images[0][key] = with_content(home, images[0][key], content)
    change_index(home, images=images)
    if is_map_lost:
        (home / "floor-1/state-1.npz").unlink()
    with opened(home) as memory:
        assert memory.left_out[-1].endswith("key images are missing or damaged, and left out: 0")


def test_a_camera_beyond_all_cameras_is_damaged_though_its_image_agrees(home):
    images = index_of(home)["images"]
    images[0]["jpeg"] = with_content(
        home, images[0]["jpeg"], encoded(".jpg", np.zeros((2500, 2500), np.uint8))
    )
    images[0]["camera"][:2] = [2500, 2500]
    change_index(home, images=images)
    with opened(home) as memory:
        assert memory.left_out[-1].endswith("left out: 0")


def test_a_colour_image_that_cannot_be_decoded_ends_in_one_line(home, capsys):
    images = index_of(home)["images"]
    content = bytearray((home / images[0]["jpeg"]["name"]).read_bytes())
    at = content.find(b"\xff\xc4")  # the Huffman tables
    content[at + 4 : at + 40] = b"\xff" * 36
    images[0]["jpeg"] = with_content(home, images[0]["jpeg"], bytes(content))
    change_index(home, images=images)
    assert command("memory", home) == 2
    assert "key image 0 of the memory is damaged" in capsys.readouterr().err
    assert command("memory", home, "--forget-images") == 0


def test_a_depth_image_with_too_few_rows_ends_in_one_line(home, capsys):
    images = index_of(home)["images"]
    width, height = struct.unpack(">II", (home / images[0]["png"]["name"]).read_bytes()[16:24])
    content = png(width, height, 16, 0, missing_rows=1)
    images[0]["png"] = with_content(home, images[0]["png"], content)
    change_index(home, images=images)
    assert command("memory", home) == 2
    assert "key image 0 of the memory is damaged" in capsys.readouterr().err
    assert command("memory", home, "--forget-images") == 0


def same_state(facts: dict[str, Any]) -> None:
    facts["floors"][1]["state"] = facts["floors"][0]["state"]


def same_image(facts: dict[str, Any]) -> None:
    facts["images"][1]["jpeg"] = facts["images"][0]["jpeg"]


def many_things(facts: dict[str, Any]) -> None:
    facts["floors"][0]["things"] = [thing(number) for number in range(501)]


def many_connectors(facts: dict[str, Any]) -> None:
    facts["connectors"] = facts["connectors"][:1] * 1001


def many_floors(facts: dict[str, Any]) -> None:
    facts["floors"] = facts["floors"][:1] * 201


def long_label(facts: dict[str, Any]) -> None:
    facts["floors"][0]["things"] = [thing(0) | {"label": "a" * 5_000_000}]


def many_searches(facts: dict[str, Any]) -> None:
    facts["history"] = facts["history"] * 1001


def thing(number: int) -> dict[str, Any]:
    return {
        **{"number": number, "label": "bed", "score": 0.9, "low": [1, 1, 0], "high": [2, 2, 1]},
        **{"views": [[0, 0, 0.9]], "pixels": 100.0, "first_search": 1, "last_search": 1},
        **{"seen": 1, "missed": 0, "overlooked": 0, "image": None, "image_pixels": 0.0},
        "refuted_in": 0,
    }


def of_thing(**values: Any) -> Callable[[dict[str, Any]], None]:
    def change(facts: dict[str, Any]) -> None:
        facts["floors"][0]["things"] = [thing(0) | values]

    return change


def of_index(**values: Any) -> Callable[[dict[str, Any]], None]:
    def change(facts: dict[str, Any]) -> None:
        facts.update(values)

    return change


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (same_state, r"floor-1/state-1\.npz is named twice"),
        (same_image, r"images/000000\.jpg is named twice"),
        (many_things, r"floors\.0\.things: .*at most 500"),
        (many_connectors, r"connectors: .*at most 1000"),
        (many_floors, r"floors: .*at most 200"),
        (many_searches, r"history: .*at most 1000"),
        (long_label, r"floors\.0\.things\.0\.label: .*at most 32768"),
        (of_thing(missed=10**400), r"things\.0\.missed"),
        (of_thing(missed=math.inf), r"things\.0\.missed"),
        (of_thing(missed=10**10), r"things\.0\.missed: .*less than or equal to 1000000000"),
        (of_thing(score=-1e300), r"things\.0\.score"),
        (of_thing(score=1.1), r"things\.0\.score"),
        (of_thing(low=[1e300, 0, 0]), r"things\.0\.low\.0"),
        (of_thing(pixels=-1.0), r"things\.0\.pixels"),
        (of_thing(views=[[0, 0, 0.5]] * 5), r"things\.0\.views: .*at most 4"),
        (of_index(saves=10**9 + 1), r"saves"),
        (of_index(image_count=10**9 + 5), r"image_count"),
        (of_index(searches=-1), r"searches"),
        (of_index(most_bytes=10**30), r"most_bytes"),
    ],
)
def test_an_index_beyond_what_is_written_is_refused(home, change, told):
    facts = index_of(home)
    change(facts)
    (home / INDEX_NAME).write_text(json.dumps(facts).replace("Infinity", "1e400"))
    before = files_of(home)
    with pytest.raises(MemoryFolderError, match=rf"is broken \(.*{told}"):
        opened(home)
    assert files_of(home) == before


def test_counts_at_their_bound_go_on_from_there(home):
    facts = index_of(home)
    of_thing(missed=10**9, seen=10**9)(facts)
    of_index(saves=10**9, image_count=10**9, searches=10**9)(facts)
    (home / INDEX_NAME).write_text(json.dumps(facts))
    with opened(home) as memory:
        memory.save()
    assert index_of(home)["saves"] == 10**9 + 1


def packed(arrays: dict[str, np.ndarray], method: int = zipfile.ZIP_DEFLATED) -> bytes:
    """Arrays as NumPy writes them, however packed."""
    members = {name: io.BytesIO() for name in arrays}
    for name, array in arrays.items():
        np.save(members[name], array)
    return zip_of({name: one.getvalue() for name, one in members.items()}, method)


def zip_of(members: dict[str, bytes], method: int = zipfile.ZIP_DEFLATED) -> bytes:
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", method) as archive:
        for name, content in members.items():
            archive.writestr(f"{name}.npy", content)
    return data.getvalue()


@pytest.mark.parametrize("method", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
@pytest.mark.parametrize("is_broken", [True, False])
def test_a_map_packed_in_another_way_is_damaged(home, method, is_broken):
    content = packed(dict(np.load(home / "floor-1/state-1.npz")), method)
    at = len(content) // 2
    with_state(home, content[:at] + bytes(64) + content[at + 64 :] if is_broken else content)
    with opened(home) as memory:
        (line,) = memory.left_out
        assert line.startswith("the map of floor 1 is damaged (")
        memory.save()


@pytest.mark.parametrize(
    "member", [b"no magic and no header", b"\x93NUMPY\x01\x00\x0a\x00{'descr': 1}"]
)
def test_a_map_with_a_member_that_is_no_array_is_damaged(home, member):
    with_state(home, zip_of({"trajectory": member}))
    with opened(home) as memory:
        assert memory.left_out[0].startswith("the map of floor 1 is damaged (trajectory.npy is no")


def test_a_trajectory_longer_than_any_search_is_damaged(home):
    arrays = dict(np.load(home / "floor-1/state-1.npz"))
    with_state(home, packed(arrays | {"trajectory": np.zeros((1_005_001, 2))}))
    with opened(home) as memory:
        assert "trajectory.npy has 16,080,016 bytes, at most" in memory.left_out[0]


def test_all_floors_and_images_together_have_one_allowance(home, monkeypatch):
    size = sum(one.stat().st_size for one in home.rglob("*.*") if one.is_file())
    monkeypatch.setattr("hypernav.io.reading.MOST_BYTES", 20 * size)
    with pytest.raises(MemoryFolderError, match=r"can't be opened: .* all of a memory at most"):
        opened(home)
