"""Episodes of houses on disk, so that a house is only measured once."""

import contextlib
import hashlib
import tempfile
from functools import lru_cache
from pathlib import Path

from hypernav.core.errors import EpisodeError
from hypernav.datasets.habitat_files import read_episodes, write_episodes
from hypernav.datasets.habitat_format import EpisodeDataset
from hypernav.houses.episodes.house_episodes import EPISODES_VERSION, GoalStyle, house_episodes
from hypernav.houses.house_cache import cache_folder, cached_house, generator_version


def cached_episodes(number: int, style: GoalStyle, folder: Path | None = None) -> EpisodeDataset:
    """The episodes of a house from the cache; made and kept there if they are not.

    A broken file is replaced. A cache that cannot be written is done without.

    Args:
        number: Of the house.
        style: What is asked for.
        folder: Cache folder; the platform's own if None.

    Raises:
        EpisodeError: There is nothing in the house that could be searched for.
    """
    home = (folder or cache_folder()) / "house_episodes" / episodes_version()
    path = home / f"{style}-{number}.json.gz"
    if path.is_file():
        with contextlib.suppress(EpisodeError):
            return read_episodes(path)
    dataset = house_episodes(cached_house(number, folder), number, style)
    # The disk may be read-only or full: the episodes are good all the same.
    with contextlib.suppress(OSError):
        _write_atomically(dataset, path)
    return dataset


@lru_cache(maxsize=1)
def episodes_version() -> str:
    """Names what the episodes depend on: the houses, the version, and the sources in this folder.

    The sources are there for those who work on them: a forgotten version number must not leave
    yesterday's episodes.
    """
    digest = hashlib.sha256(generator_version().encode())
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.name.encode())
        digest.update(source.read_bytes())
    return f"v{EPISODES_VERSION}-{digest.hexdigest()[:12]}"


def _write_atomically(dataset: EpisodeDataset, path: Path) -> None:
    """Write a file so that nobody ever sees half of it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=".new-") as folder:
        fresh = Path(folder) / path.name
        write_episodes(dataset, fresh)
        fresh.replace(path)
