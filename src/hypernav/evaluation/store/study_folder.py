"""The folder of a study, locked for one process, and for one configuration only."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from hypernav.evaluation.store.run_store import keep_configuration
from hypernav.io.folder_lock import folder_lock


@contextmanager
def held_folder(folder: Path, configuration: Mapping[str, Any]) -> Iterator[None]:
    """Lock a folder while the ``with`` block runs, and store its configuration in it.

    Args:
        folder: Folder of the study; created if missing.
        configuration: Everything that decides about its results, as JSON data. A folder with
            another configuration is refused before anything in it changes.

    Raises:
        RunFolderError: The folder is in use, of another configuration, damaged, or read-only.
    """
    with folder_lock(folder):
        keep_configuration(folder, configuration)
        yield
