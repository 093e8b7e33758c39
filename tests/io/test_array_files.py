"""Arrays of an archive are what NumPy wrote, or an error in words before memory is taken."""

import io
import struct
import zipfile
from contextlib import suppress

import numpy as np
import pytest

from hypernav.io.array_files import arrays_in

ARRAYS = {
    "a": np.arange(10),
    "b": np.arange(600_000, dtype=np.uint8).reshape(2, 3, 100_000),
    "c": np.float64(3.0),
    "d": np.empty((0, 2)),
    "e": np.array([True, False]),
}
MOST = dict.fromkeys(ARRAYS, 1_000_000)


def read(content: bytes) -> dict[str, np.ndarray]:
    return arrays_in(content, MOST, lambda size, what: None)


def member(array: np.ndarray) -> bytes:
    data = io.BytesIO()
    np.save(data, array)
    return data.getvalue()


def packed(content: bytes, name: str = "a.npy", method: int = zipfile.ZIP_DEFLATED) -> bytes:
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", method) as archive:
        archive.writestr(name, content)
    return data.getvalue()


@pytest.mark.parametrize("save", [np.savez, np.savez_compressed])
def test_what_numpy_writes_comes_back_and_may_be_changed(save):
    data, spent = io.BytesIO(), list[int]()
    save(data, **ARRAYS)
    found = arrays_in(data.getvalue(), MOST, lambda size, what: spent.append(size))
    assert found.keys() == ARRAYS.keys()
    for name, array in ARRAYS.items():
        assert found[name].dtype == np.asarray(array).dtype
        np.testing.assert_array_equal(found[name], array)
    assert sum(spent) == sum(np.asarray(one).nbytes for one in ARRAYS.values())
    found["a"][0] = 7


def test_nothing_is_unpacked_that_is_not_granted():
    def refuse(size: int, what: str) -> None:
        raise PermissionError(f"{size} {what}")

    with pytest.raises(PermissionError, match=r"80 the array a\.npy"):
        arrays_in(packed(member(np.arange(10))), MOST, refuse)
    with pytest.raises(ValueError, match=r"has 1,000,008 bytes, at most 1,000,000 are read"):
        read(packed(member(np.zeros(125_001))))


def headed(header: str, data: bytes = bytes(80)) -> bytes:
    text = header.encode() + b"\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text + data


WHOLE = "{'descr': '<i8', 'fortran_order': False, 'shape': (10,), }"


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"no magic at all",
        member(np.array([None])),
        member(np.array(["text"])),
        member(np.zeros(3, dtype=[("x", "<f8")])),
        member(np.asfortranarray(np.zeros((3, 4)))),
        headed(WHOLE, bytes(79)),
        headed(WHOLE, bytes(81)),
        headed("__import__('os').getpid()"),
        headed("(" * 60_000),
        headed("{'descr': '<i8', 'fortran_order': False, 'shape': (-1,), }"),
        headed("{'descr': '<i8', 'fortran_order': False, 'shape': (1,) * 9, }"),
        headed("{'descr': '<f9', 'fortran_order': False, 'shape': (10,), }"),
        headed("{'descr': '<i8', 'fortran_order': False, 'shape': (999999999999,), }"),
        headed(WHOLE)[:9],
        headed(WHOLE).replace(b"\x01\x00", b"\x02\x00", 1),
    ],
)
def test_a_member_that_is_no_plain_array_is_refused(content):
    assert read(packed(headed(WHOLE)))["a"].shape == (10,)
    with pytest.raises(ValueError, match=r"a\.npy (is|has)|no whole archive"):
        read(packed(content))


@pytest.mark.parametrize("method", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_a_member_is_stored_or_deflated(method):
    with pytest.raises(ValueError, match="packed in a way"):
        read(packed(headed(WHOLE), method=method))


def test_other_names_and_many_members_are_refused():
    with pytest.raises(ValueError, match="members of other names"):
        read(packed(headed(WHOLE), "../a.npy"))
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as archive:
        for k in range(6):
            archive.writestr(f"a{k}.npy", headed(WHOLE))
    with pytest.raises(ValueError, match="more than 5 members"):
        read(data.getvalue())


@pytest.mark.parametrize("size", [0, 1, 2000, 8127, 2**31])
def test_sizes_that_lie_cost_nothing(size):
    content = bytearray(packed(member(np.arange(1000))))
    for at in (22, content.find(b"PK\x01\x02") + 24):  # of the member and of the directory
        content[at : at + 4] = struct.pack("<I", size)
        if at == 22 or size > 8128:  # the array's own header counts
            np.testing.assert_array_equal(read(bytes(content))["a"], np.arange(1000))
        else:
            with pytest.raises(ValueError, match=r"no whole archive|another size|plain numbers"):
                read(bytes(content))


def test_any_changed_byte_gives_an_array_or_a_value_error():
    data, rng = io.BytesIO(), np.random.default_rng(0)
    np.savez_compressed(data, a=np.arange(10), c=np.float64(3.0))
    for _ in range(300):
        content = bytearray(data.getvalue())
        for at in rng.integers(0, len(content), 3):
            content[at] = rng.integers(256)
        with suppress(ValueError):
            read(bytes(content[: rng.integers(len(content) // 2, len(content) + 1)]))
