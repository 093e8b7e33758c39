"""A cache that cannot be used: one warning, and the work goes on."""

import pytest

from hypernav.io.cache_folder import CACHE_VARIABLE, cache_folder


@pytest.mark.parametrize("name", ["file", "file/below", "x" * 300])
def test_one_that_cannot_be_used_is_one_warning(name, tmp_path, monkeypatch, caplog):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path / name))
    assert cache_folder() == cache_folder() == tmp_path / name
    assert [one.message.count("cannot be used") for one in caplog.records] == [1]


@pytest.mark.parametrize("name", ["", "not there yet/nor this"])
def test_one_that_is_empty_or_missing_is_none(name, tmp_path, monkeypatch, caplog):
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path / name))
    cache_folder()
    assert not caplog.records
