"""A search that was run to its end and recorded: it shows itself, saves itself, becomes a table."""

import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from hypernav.app.show.templating import data_uri, html_table
from hypernav.core.components.registry import require
from hypernav.core.errors import OutputError
from hypernav.core.trace import StepTrace
from hypernav.lab.episodes.episode_run import EpisodeResult, EpisodeRun
from hypernav.lab.episodes.recorder import EpisodeRecorder

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True, eq=False)
class SearchRecord:
    """A recorded search. In a notebook it shows its film, its map and its figures.

    Attributes:
        folder: The files that `hypernav find` writes too, ``index.html`` among them.
        result: How the search ended.
        steps: What the robot did in every step, and why.
    """

    folder: Path
    result: EpisodeResult
    steps: Sequence[StepTrace]
    _temporary: TemporaryDirectory[str] | None = None

    def save(self, folder: str | Path) -> Path:
        """Copy all files to a folder, which is created if missing.

        Returns:
            The page, which needs no network.

        Raises:
            OutputError: It cannot be written.
        """
        try:
            shutil.copytree(self.folder, folder, dirs_exist_ok=True)
        except OSError as error:
            raise OutputError(f"{folder} cannot be written ({error.strerror or error})") from error
        return Path(folder) / "index.html"

    def to_pandas(self) -> "pandas.DataFrame":
        """A row for every step: pose in the ``map`` frame (metres, radians), mode, reason, …

        Raises:
            MissingExtraError: pandas is not installed.
        """
        frames = require("pandas", extra="notebook")
        return frames.DataFrame([_row(step) for step in self.steps])

    def _repr_html_(self) -> str:
        """Film, map and figures, for notebooks."""
        film = data_uri((self.folder / "episode.mp4").read_bytes(), "video/mp4")
        drawn = self.folder / "map.png"
        uri = data_uri(drawn.read_bytes(), "image/png") if drawn.exists() else ""
        image = f'<img src="{uri}" alt="map" style="max-width: 30em">' if uri else ""
        figures = html_table([list(_figures(self.result))], list(_figures(self.result).values()))
        return f'<video controls src="{film}" style="max-width: 100%"></video>{image}{figures}'
