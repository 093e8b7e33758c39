"""Records survive whatever cuts the file short: all but the last, whole."""

from contextlib import closing

import pytest

from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.errors import RunFolderError
from hypernav.robot.server.searches.journal import (
    EndRecord,
    Journal,
    RecordFile,
    SearchRecord,
    _write_whole,
)
from hypernav.robot.wire.replies import SearchEnding
from hypernav.robot.wire.requests import OpenSearch
from leads import lead

RECORDS = [b"first", b"", b"\x00" * 40, b"last of all"]


def written(path) -> bytes:
    file = RecordFile(path)
    for record in RECORDS:
        file.append(record, sync=True)
    file.close()
    return path.read_bytes()


def all_of(file: RecordFile) -> list[bytes]:
    return [file.read(number) for number in range(len(file))]


def test_a_file_cut_anywhere_holds_a_prefix_and_goes_on(tmp_path):
    whole, kept = written(tmp_path / "whole"), 0
    for size in range(len(whole)):
        path = tmp_path / str(size)
        path.write_bytes(whole[:size])
        file = RecordFile(path)
        kept = len(file)
        assert all_of(file) == RECORDS[:kept]
        file.append(b"new", sync=False)
        file.close()
        again = RecordFile(path)
        assert all_of(again) == [*RECORDS[:kept], b"new"]
        again.close()
    assert kept == len(RECORDS) - 1


def test_half_of_the_last_record_is_left_for_its_writer(tmp_path):
    path = tmp_path / "file"
    path.write_bytes(written(path)[:-3])
    size = path.stat().st_size
    reader = RecordFile(path, to_read=True)
    assert all_of(reader) == RECORDS[:-1]
    reader.close()
    assert path.stat().st_size == size


def test_zeros_after_a_loss_of_power_are_no_records(tmp_path):
    path = tmp_path / "file"
    whole = written(path)
    path.write_bytes(whole[:-5] + bytes(5))
    file = RecordFile(path)
    assert all_of(file) == RECORDS[:-1]
    file.close()


def test_damage_in_the_middle_is_an_error(tmp_path):
    path = tmp_path / "file"
    whole = bytearray(written(path))
    whole[9] ^= 1
    path.write_bytes(bytes(whole))
    file = RecordFile(path)
    with pytest.raises(RunFolderError, match="record 0 was damaged"):
        file.read(0)
    assert file.read(3) == RECORDS[3]
    file.close()


def test_cutting_keeps_the_first_records(tmp_path):
    path = tmp_path / "file"
    written(path)
    file = RecordFile(path)
    file.cut(2)
    assert all_of(file) == RECORDS[:2]
    file.append(b"new", sync=False)
    assert all_of(file) == [*RECORDS[:2], b"new"]
    file.close()


def test_a_folder_in_its_place_is_an_error(tmp_path):
    with pytest.raises(RunFolderError, match="cannot be written"):
        RecordFile(tmp_path)


def test_zeros_after_the_last_record_are_no_records(tmp_path):
    path = tmp_path / "file"
    path.write_bytes(written(path) + bytes(4096))
    file = RecordFile(path)
    assert all_of(file) == RECORDS
    file.append(b"new", sync=False)
    assert all_of(file) == [*RECORDS, b"new"]
    file.close()


SEARCH = SearchRecord(
    id="0" * 32,
    opened_s=0.0,
    version="0",
    words="",
    request=OpenSearch(goal="bed"),
    specs=ComponentSpecs(),
    config=HyPerNavConfig(),
)


@pytest.mark.parametrize("name", [".end.json.new", "paused", "search.json"])
@pytest.mark.parametrize("kind", ["link", "hard link", "pipe"])
def test_a_search_from_a_stranger_leads_to_no_file_elsewhere(tmp_path, name, kind):
    mine, folder = tmp_path / "mine", tmp_path / "search"
    Journal.create(folder, SEARCH).close()
    mine.write_bytes((folder / "search.json").read_bytes())
    (folder / name).unlink(missing_ok=True)
    lead(folder / name, kind, mine)
    before, told = mine.read_bytes(), ""
    try:
        with closing(Journal(folder)) as journal:
            journal.write_paused(True)
            journal.write_end(EndRecord(ending=SearchEnding.FOUND), {}, last_floor=1)
    except RunFolderError as error:
        told = str(error)
    assert mine.read_bytes() == before
    assert bool(told) != (kind == "hard link" and name == "search.json"), told  # only read


def test_the_reserved_room_is_used_and_the_rest_given_back(tmp_path):
    (tmp_path / ".end.json.new").write_bytes(bytes(4096))
    _write_whole(tmp_path / "end.json", SEARCH)
    assert SearchRecord.model_validate_json((tmp_path / "end.json").read_text()) == SEARCH
    assert [one.name for one in tmp_path.iterdir()] == ["end.json"]
