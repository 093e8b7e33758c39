"""Arrays that are computed once and kept in the cache, mapped into memory when they are needed.

They are in a folder of their own, which is written under another name and then renamed, so that
it is never seen incomplete. A list beside them says which they are. Arrays that are broken, or not
those of the list, are computed and written again; without a writable cache nothing is kept, as one
warning says.
"""

import hashlib
import json
import logging
import shutil
import tempfile
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

import numpy as np

from hypernav.io.cache_folder import named_cache_folder, warn_unusable

_LIST = "arrays.json"
_LOGGER = logging.getLogger(__name__)


def kept_arrays(
    folder: Path | None, name: str, compute: Callable[[], Mapping[str, np.ndarray]]
) -> Mapping[str, np.ndarray]:
    """Arrays from the cache; if they are not there, they are computed and kept.

    Args:
        folder: Cache folder of the source that they are computed from; None keeps nothing.
        name: Name of the arrays. It has to change with everything that they depend on besides the
            source, such as the code that computes them (`digest_of`).
        compute: Function that computes them; it must always return the same names.
    """
    if folder is None:
        return compute()
    home = folder / name
    try:
        if home.is_dir():
            return _read(home)
    except (OSError, ValueError) as error:
        _LOGGER.warning("%s is broken (%s) and is written again", home, error)
    arrays = compute()
    keep(home, lambda fresh: _save(fresh, arrays))
    return arrays


def keep(home: Path, write: Callable[[Path], object]) -> None:
    """Write a file or folder of the cache completely or not at all; the first error is a warning.

    Args:
        home: The file or folder; what was there before is replaced.
        write: Function that makes it under another name.
    """
    try:
        home.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=home.parent, prefix=".new-") as parent:
            fresh = Path(parent) / home.name
            write(fresh)
            shutil.rmtree(home, ignore_errors=True)
            fresh.replace(home)
    except OSError as error:
        warn_unusable(named_cache_folder(), error)


def mapped_array(path: Path) -> np.ndarray:
    """An array whose bytes stay on the disk until they are used; changes stay in memory.

    Raises:
        OSError: The file cannot be read.
        ValueError: It holds no array, or only a part of one.
    """
    with path.open("rb") as file:
        np.lib.format.read_magic(file)
        shape, _, dtype = np.lib.format.read_array_header_1_0(file)
        begin = file.tell()
    if 0 in shape:
        return np.empty(shape, dtype)
    return np.asarray(np.memmap(path, dtype, mode="c", offset=begin, shape=shape))


def digest_of(sources: Iterable[Path]) -> str:
    """A short name that changes with the content of source files."""
    digest = hashlib.sha256()
    for source in sources:
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def _read(folder: Path) -> dict[str, np.ndarray]:
    """The arrays of a folder.

    Raises:
        OSError: A file cannot be read.
        ValueError: They are not those that were kept.
    """
    listed = json.loads((folder / _LIST).read_text(encoding="utf-8"))
    arrays = {path.stem: mapped_array(path) for path in sorted(folder.glob("*.npy"))}
    if _listed(arrays) != listed:
        raise ValueError(f"its arrays are not those of {_LIST}")
    return arrays


def _save(folder: Path, arrays: Mapping[str, np.ndarray]) -> None:
    folder.mkdir()
    for name, array in arrays.items():
        np.save(folder / f"{name}.npy", array)
    (folder / _LIST).write_text(json.dumps(_listed(arrays)), encoding="utf-8")


def _listed(arrays: Mapping[str, np.ndarray]) -> dict[str, list[str | int]]:
    """Type and shape of every array by its name."""
    return {name: [array.dtype.str, *array.shape] for name, array in arrays.items()}
