"""A cache that cannot be used: one warning, and the work goes on."""

from pathlib import Path

import pytest

from hypernav.io.cache_folder import CACHE_VARIABLE, cache_folder
from hypernav.io.kept_arrays import keep


@pytest.mark.parametrize("name", ["file", "file/below", "x" * 300])
def test_one_that_cannot_be_used_is_one_warning(name, tmp_path, monkeypatch, caplog):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path / name))
    assert cache_folder() == cache_folder() == tmp_path / name
    assert [one.message.count("cannot be used") for one in caplog.records] == [1]


def test_one_that_is_full_or_read_only_is_one_warning(tmp_path, monkeypatch, caplog):
    def write(path: Path) -> None:
        raise OSError("9 requested and 0 written")  # what NumPy says on a full disk

    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path))
    for name in ("a.npz", "b.npz"):
        keep(cache_folder() / name, write)
    (warning,) = caplog.messages
    assert f"{tmp_path} cannot be used (9 requested and 0 written)" in warning
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["", "not there yet/nor this"])
def test_one_that_is_empty_or_missing_is_none(name, tmp_path, monkeypatch, caplog):
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path / name))
    cache_folder()
    assert not caplog.records
