"""Opens the memory of a building that is kept in a folder."""

from pathlib import Path
from typing import TYPE_CHECKING

from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.components.registry import require
from hypernav.core.config import check_option
from hypernav.core.errors import OutputError
from hypernav.core.naming.words import number_of
from hypernav.io.writing import write_whole
from hypernav.search.memory.key_images import LARGEST_BYTES
from hypernav.search.memory.store.memory_folder import MemoryFolder

if TYPE_CHECKING:
    import pandas


class BuildingMemory(MemoryFolder):
    """The memory of a building. In a notebook it shows the plans of its floors and its things."""

    def save_page(self, file: str | Path) -> Path:
        """Write the page that ``hypernav memory`` writes, which needs no network.

        Returns:
            The page.

        Raises:
            OutputError: It can't be written.
        """
        from hypernav.app.build.memories.memory_page import memory_page  # searches draw no page

        try:
            write_whole(Path(file), memory_page(self))
        except OSError as error:
            raise OutputError(f"{file} cannot be written ({error.strerror or error})") from error
        return Path(file)

    def to_pandas(self) -> "pandas.DataFrame":
        """A row for every remembered thing: where it is, its size, how often and when it was seen.

        Lengths are metres of the ``map`` frame, heights those above the floor. ``chance``, 0 to 1,
        is that it is what its label says; ``missed`` counts images that should show it and don't.

        Raises:
            MissingExtraError: pandas is not installed.
        """
        from hypernav.app.build.memories.memory_page import thing_rows

        return require("pandas", extra="notebook").DataFrame(thing_rows(self.memory))

    def __repr__(self) -> str:
        """One line."""
        floors = self.memory.floors
        things = number_of(sum(len(one.things.known) for one in floors), "thing")
        searches = number_of(len(self.history), "search", "searches")
        return f"BuildingMemory({self.folder}: {searches}, {things}, floors: {len(floors)})"

    def _repr_html_(self) -> str:
        from hypernav.app.build.memories.memory_page import in_short

        return in_short(self.memory)


def open_memory(
    folder: Path | str,
    config: HyPerNavConfig | None = None,
    *,
    most_megabytes: float | None = None,
    patience_s: float = 0.0,
) -> BuildingMemory:
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
    return BuildingMemory(
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
        check_option(name, size_mb, (1.0, most), "megabytes")
