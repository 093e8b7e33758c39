"""The folder of a study of goal refinement: a line for every episode that is done."""

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError

from hypernav.core.episode import Episode
from hypernav.core.errors import RunFolderError
from hypernav.evaluation.record import EpisodeKey
from hypernav.evaluation.refinement.area_record import AreaRecord
from hypernav.evaluation.store.run_files import append_line, write_whole
from hypernav.evaluation.store.study_folder import held_folder

LINES_FILE = "refinement.jsonl"


class _Line(BaseModel):
    """What an episode gave; nothing where the goal was never within the range of depth."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    key: EpisodeKey
    records: tuple[AreaRecord, ...]


class RefinementStore:
    """The folder, locked by its only writer. A study that was interrupted goes on from its lines.

    Attributes:
        done: Records of the finished episodes, by key.
    """

    def __init__(self, folder: Path, configuration: Mapping[str, Any]) -> None:
        """Name the folder.

        Args:
            folder: Folder of the study; created if missing.
            configuration: Everything that decides about results, as JSON data. A folder with
                another configuration is refused.
        """
        self.done: dict[EpisodeKey, tuple[AreaRecord, ...]] = {}
        self._folder = folder
        self._configuration = configuration
        self._stack = ExitStack()

    def __enter__(self) -> "RefinementStore":
        """Lock the folder, check it, and read the finished episodes.

        Raises:
            RunFolderError: The folder is in use, of another configuration, damaged, or read-only.
        """
        with ExitStack() as stack:
            stack.enter_context(held_folder(self._folder, self._configuration))
            try:
                lines = self._whole_lines()
            except OSError as error:
                raise RunFolderError(
                    f"{self._folder} cannot be used: {error.strerror or error}"
                ) from error
            self.done = {line.key: line.records for line in lines}
            self._stack = stack.pop_all()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Release the folder."""
        self._stack.close()

    def add(self, episode: Episode, records: Sequence[AreaRecord]) -> None:
        """Write what one episode gave to the disk.

        Raises:
            RunFolderError: The disk is full.
        """
        line = _Line(key=episode.key, records=tuple(records))
        append_line(self._folder / LINES_FILE, line.model_dump_json())
        self.done[line.key] = line.records

    @property
    def records(self) -> list[AreaRecord]:
        """All records, in the order of scenes and episodes."""
        return [record for _, records in sorted(self.done.items()) for record in records]

    def _whole_lines(self) -> list[_Line]:
        """The finished episodes; a last line that was not written to its end is cut off."""
        path = self._folder / LINES_FILE
        content = path.read_bytes() if path.exists() else b""
        whole = content[: content.rfind(b"\n") + 1]
        if whole != content:
            write_whole(path, whole)
        try:
            return [_Line.model_validate_json(line) for line in whole.splitlines()]
        except ValidationError as error:
            raise RunFolderError(
                f"{path} is damaged ({error.errors()[0]['msg']}); choose another --out"
            ) from error
