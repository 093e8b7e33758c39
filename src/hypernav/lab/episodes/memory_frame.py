"""A world in the ``map`` frame of a memory on disk, for an episode in the same building."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from hypernav.core.episode import Episode
from hypernav.core.errors import ConfigError
from hypernav.core.geometry.transforms import Transform
from hypernav.core.world import KeepsMapFrame, World
from hypernav.search.memory.store.memory_folder import MemoryFolder


def building_of(episode: Episode) -> str:
    """Name of an episode's building in a memory: of a file its name and that of its folder."""
    path = Path(episode.scene_id)
    return "/".join(path.resolve().parts[-2:]) if path.is_file() else episode.scene_id


@contextmanager
def map_frame_of(
    folder: MemoryFolder | None, world: World, episode: Episode, found: Transform | None
) -> Iterator[None]:
    """Let a world that is reset in the block begin in a memory's ``map`` frame, as far as known."""
    if folder is None or folder.place is None:
        yield
        return
    folder.check_building(building_of(episode))
    if not isinstance(world, KeepsMapFrame):
        raise ConfigError(
            f"{type(world).__name__} begins a map frame at every start; a memory needs a world "
            "with keep_map_frame"
        )
    world.keep_map_frame(folder.place.map_to_scene if found is None else found)
    try:
        yield
    finally:
        world.keep_map_frame(None)
