"""Opens the memory of a building that is kept in a folder."""

from pathlib import Path

from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.config import check_option
from hypernav.search.mapping.memory.key_images import LARGEST_BYTES
from hypernav.search.mapping.storage.memory_folder import MemoryFolder


def open_memory(
    folder: Path | str,
    config: HyPerNavConfig | None = None,
    *,
    most_megabytes: float | None = None,
    patience_s: float = 0.0,
) -> MemoryFolder:
    """Open the memory of a building, for `find` and for a robot of your own.

    Args:
        folder: Its folder; an empty or missing one begins a memory.
        config: Values of the robot and its maps; the preset ``default`` unless given.
        most_megabytes: Size beyond which the key images that tell least are forgotten, from now on;
            None for the memory's own, at first 50.
        patience_s: Longest wait for another search that uses it, seconds.

    Raises:
        ConfigError: The size is impossible.
        MemoryFolderError: The folder holds no memory, a broken one, or that of another robot.
        RunFolderError: Another process uses it, or it can't be written.
    """
    check_memory_size("most_megabytes", most_megabytes)
    config = config or HyPerNavConfig()
    return MemoryFolder(
        Path(folder),
        config.mapping,
        config.embodiment,
        most_megabytes=most_megabytes,
        patience_s=patience_s,
    )


def check_memory_size(name: str, size_mb: float | None) -> None:
    """Refuse an impossible size of a memory.

    Args:
        name: Name of the option, or of the argument.
        size_mb: The size, megabytes; None if none was given.

    Raises:
        ConfigError: It is too small, too large, or not a number.
    """
    if size_mb is not None:
        most = LARGEST_BYTES / 1e6
        check_option(name, size_mb, (1.0, most), "maps alone take about 1 MB, and all is read")
