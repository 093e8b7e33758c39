"""Cache of episodes on disk, so that those of a building are generated only once."""

import contextlib
import hashlib
from functools import lru_cache
from pathlib import Path

from hypernav.core.errors import EpisodeError
from hypernav.datasets.habitat_files import read_episodes, write_episodes
from hypernav.datasets.habitat_format import EpisodeDataset
from hypernav.houses.building import Building
from hypernav.houses.episodes.house_episodes import EPISODES_VERSION, GoalStyle, house_episodes
from hypernav.houses.house_cache import cached_building, generator_version
from hypernav.io.cache_folder import cache_folder


def cached_episodes(
    building: Building, style: GoalStyle, folder: Path | None = None
) -> EpisodeDataset:
    """Episodes of a building, from the cache if possible; otherwise generated and cached.

    A broken file is replaced. Without a writable folder nothing is cached.

    Args:
        building: The building.
        style: What they ask for.
        folder: Cache folder; the platform's own if None.

    Raises:
        EpisodeError: The building contains no possible goal.
    """
    home = (folder or cache_folder()) / f"{building.noun}_episodes" / episodes_version()
    path = home / f"{style}-{building.number}.json.gz"
    with contextlib.suppress(EpisodeError, OSError):
        if path.is_file():
            return read_episodes(path)
    dataset = house_episodes(cached_building(building, folder), building, style)
    # The disk may be read-only or full; the episodes are still valid.
    with contextlib.suppress(OSError):
        write_episodes(dataset, path)
    return dataset


@lru_cache(maxsize=1)
def episodes_version() -> str:
    """Version of buildings and episodes together with a digest of the sources in this folder.

    The digest is for developers of the generator: without it, if they forgot to increase the
    version, outdated episodes would be used.
    """
    digest = hashlib.sha256(generator_version().encode())
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.name.encode())
        digest.update(source.read_bytes())
    return f"v{EPISODES_VERSION}-{digest.hexdigest()[:12]}"
