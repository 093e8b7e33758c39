"""Arrays kept in the cache: computed once, the same again, and never half written."""

from pathlib import Path

import numpy as np
import pytest

from hypernav.io.kept_arrays import digest_of, keep, kept_arrays

ARRAYS = {"a": np.arange(12.0).reshape(3, 4), "none": np.zeros((0, 3), np.int32)}


def never():
    raise AssertionError("it is in the cache")


def same(one, other) -> bool:
    return one.keys() == other.keys() and all(
        np.array_equal(one[k], other[k]) and one[k].dtype == other[k].dtype for k in one
    )


def test_they_are_computed_once_and_come_back_the_same(tmp_path: Path):
    assert same(kept_arrays(tmp_path, "x-1", lambda: ARRAYS), ARRAYS)
    assert same(kept_arrays(tmp_path, "x-1", never), ARRAYS)
    with pytest.raises(AssertionError, match="in the cache"):
        kept_arrays(tmp_path, "x-2", never)


def test_what_is_changed_in_memory_stays_as_it_was_on_the_disk(tmp_path: Path):
    kept_arrays(tmp_path, "x", lambda: ARRAYS)
    kept_arrays(tmp_path, "x", never)["a"][:] = 7.0
    assert same(kept_arrays(tmp_path, "x", never), ARRAYS)


def test_without_a_folder_or_where_nothing_can_be_written_they_are_computed(tmp_path: Path):
    (tmp_path / "file").write_text("in the way")
    for folder in (None, tmp_path / "file"):
        for _ in range(2):
            assert same(kept_arrays(folder, "x", lambda: ARRAYS), ARRAYS)


@pytest.mark.parametrize("content", [b"", b"\x93NUMPY\x01\x00", b"no array at all, but bytes"])
def test_what_is_broken_is_written_again(tmp_path: Path, content, caplog):
    kept_arrays(tmp_path, "x", lambda: ARRAYS)
    path = tmp_path / "x" / "a.npy"
    path.write_bytes(content or path.read_bytes()[:-8])
    assert same(kept_arrays(tmp_path, "x", lambda: ARRAYS), ARRAYS)
    assert "is broken" in caplog.text
    assert same(kept_arrays(tmp_path, "x", never), ARRAYS)


def test_arrays_that_are_not_those_that_were_kept_are_written_again(tmp_path: Path, caplog):
    def lose(home: Path) -> None:
        (home / "a.npy").unlink()

    def swap(home: Path) -> None:
        np.save(home / "a.npy", ARRAYS["a"].T.copy())

    def add(home: Path) -> None:
        np.save(home / "b.npy", ARRAYS["a"])

    def forget(home: Path) -> None:
        (home / "arrays.json").unlink()

    for number, damage in enumerate((lose, swap, add, forget)):
        name = f"x-{number}"
        kept_arrays(tmp_path, name, lambda: ARRAYS)
        damage(tmp_path / name)
        caplog.clear()
        assert same(kept_arrays(tmp_path, name, lambda: ARRAYS), ARRAYS)
        assert "is broken" in caplog.text
        assert same(kept_arrays(tmp_path, name, never), ARRAYS)


def test_nobody_sees_a_folder_that_is_half_written(tmp_path: Path):
    def write(folder: Path) -> None:
        folder.mkdir()
        (folder / "first").write_text("1")
        assert not (tmp_path / "x").exists()
        raise OSError("disk full")

    keep(tmp_path / "x", write)
    assert list(tmp_path.iterdir()) == []


def test_a_digest_changes_with_the_sources(tmp_path: Path):
    source = tmp_path / "kernels.py"
    source.write_text("a = 1")
    before = digest_of([source])
    source.write_text("a = 2")
    assert digest_of([source]) != before
