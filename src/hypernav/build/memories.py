"""Opens the memory of a building that is kept in a folder."""

from pathlib import Path

from hypernav.build.presets import HyPerNavConfig
from hypernav.core.config import check_option
from hypernav.mapping.memory.memory_folder import MOST_MEGABYTES, MemoryFolder


def open_memory(
    folder: Path | str,
    config: HyPerNavConfig | None = None,
    *,
    most_megabytes: float = MOST_MEGABYTES,
    patience_s: float = 0.0,
) -> MemoryFolder:
    """Open the memory of a building, for `find` and for a robot of your own.

    Args:
        folder: Its folder; an empty or missing one begins a memory.
        config: Values of the robot and its maps; the preset ``default`` unless given.
        most_megabytes: Size beyond which the key images that tell least are forgotten.
        patience_s: Longest wait for another search that uses it, seconds.

    Raises:
        ConfigError: The size is impossible.
        MemoryFolderError: The folder holds no memory, a broken one, or that of another robot.
        RunFolderError: Another process uses it, or it can't be written.
    """
    check_option("most_megabytes", most_megabytes, (1.0, 1e6), "maps alone take about 1 MB")
    config = config or HyPerNavConfig()
    return MemoryFolder(
        Path(folder),
        config.mapping,
        config.embodiment,
        most_megabytes=most_megabytes,
        patience_s=patience_s,
    )
