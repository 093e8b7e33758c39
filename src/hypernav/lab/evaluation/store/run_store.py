"""The folder of a run: its configuration, and one line for every episode that is done.

======================= ============================================================================
``run.json``            the whole configuration; never changes
``episodes.jsonl``      one `EpisodeRecord` per line, in the order in which they were done
``retried.jsonl``       records that were withdrawn because their episodes run again
``sessions.jsonl``      one line for every start of the program: workers, time, memory
``scenes.json``         hash, sizes and times of the files of every scene (`scene_files`)
``episodes/``           pages and videos of single episodes, if they are kept
======================= ============================================================================
"""

import json
import logging
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from hypernav.core.errors import RunFolderError
from hypernav.io.folder_lock import folder_lock
from hypernav.io.foreign_folder import read_own
from hypernav.io.parsing import parse_json
from hypernav.lab.evaluation.record import Count, EpisodeKey, EpisodeRecord
from hypernav.lab.evaluation.store.record_file import (
    RecordFile,
    append_line,
    file_content,
    read_record_file,
    write_whole,
)

UNENDED = "killed, or still running"
"""Value of ``ended`` until the session ends."""


class Session(BaseModel):
    """One start of the program.

    Attributes:
        began: Time of the start, ISO 8601.
        commit: Commit of the program; empty if it is unknown.
        ended: How it ended, in words; `UNENDED` from the start on.
        seconds: Wall-clock time.
        cpu_seconds: Processor time of its workers.
        workers: Maximum number of workers.
        cores: Number of cores that it could use.
        episodes: Number of episodes that it finished.
        peak_memory_mb: Peak memory by worker, megabytes.
        workers_lost: Number of lost workers.
        crashes: Tracebacks of episodes whose worker's program failed, by scene and episode.
    """

    model_config = ConfigDict(frozen=True, allow_inf_nan=False)

    began: str
    commit: str = ""
    ended: str = UNENDED
    seconds: float = 0.0
    cpu_seconds: float = 0.0
    workers: Count = 0
    cores: Count = 0
    episodes: Count = 0
    peak_memory_mb: dict[str, float] = Field(default_factory=dict)
    workers_lost: Count = 0
    crashes: dict[str, str] = Field(default_factory=dict)


RUN_FILE = "run.json"
EPISODES_FILE = "episodes.jsonl"
RETRIED_FILE = "retried.jsonl"
SESSIONS_FILE = "sessions.jsonl"
RUN_FILES = (RUN_FILE, EPISODES_FILE, RETRIED_FILE, SESSIONS_FILE)
"""Names of the files that a store writes to its folder."""
SAVED_FOLDER = "episodes"
"""Name of the folder of pages and videos of single episodes, in a run's."""

_LOGGER = logging.getLogger(__name__)


class RunStore:
    """The folder of a run, locked by its only writer.

    Attributes:
        folder: Folder of the run.
        records: Records of the finished episodes, by key.
    """

    def __init__(self, folder: Path, configuration: Mapping[str, Any]) -> None:
        """Create it; the ``with`` block opens the folder.

        Args:
            folder: Folder of the run; created if missing.
            configuration: Everything that decides about results, as JSON data. A folder with
                another configuration is refused.
        """
        self.folder = folder
        self.records: dict[EpisodeKey, EpisodeRecord] = {}
        self._configuration = configuration
        self._earlier_sessions = b""
        self._stack = ExitStack()

    def __enter__(self) -> "RunStore":
        """Lock the folder, check it, and read the finished episodes.

        Raises:
            RunFolderError: The folder is in use, of another configuration, damaged, or read-only.
        """
        with ExitStack() as stack:
            stack.enter_context(folder_lock(self.folder))
            self._check_configuration()
            self._file = RecordFile(self.folder / EPISODES_FILE, EpisodeRecord)
            self.records = self._file.records
            self._earlier_sessions = _whole_lines(self.folder / SESSIONS_FILE)
            self._stack = stack.pop_all()
        return self

    def __exit__(self, *error: object) -> None:
        """Release the folder."""
        self._stack.close()

    def add(self, record: EpisodeRecord) -> None:
        """Write the record of one episode to the disk.

        Raises:
            RunFolderError: The episode has a record already, or the disk is full.
        """
        self._file.add(record)

    def withdraw(self, unwanted: Callable[[EpisodeRecord], bool]) -> int:
        """Withdraw records, so that their episodes run again; ``retried.jsonl`` keeps them.

        Returns:
            Number of withdrawn records.
        """
        out = [record for record in self.records.values() if unwanted(record)]
        if out:
            for record in out:
                append_line(self.folder / RETRIED_FILE, record.model_dump_json())
                del self.records[record.key]
            lines = [record.model_dump_json() + "\n" for record in self.records.values()]
            write_whole(self.folder / EPISODES_FILE, "".join(lines))
        return len(out)

    def write_session(self, session: Session) -> None:
        """Write the figures of this session, replacing those written before.

        Raises:
            RunFolderError: The disk is full; the file is unchanged.
        """
        line = session.model_dump_json().encode() + b"\n"
        write_whole(self.folder / SESSIONS_FILE, self._earlier_sessions + line)

    def _check_configuration(self) -> None:
        if not (self.folder / RUN_FILE).exists() and (self.folder / EPISODES_FILE).exists():
            raise RunFolderError(
                f"{self.folder} holds {EPISODES_FILE} but no {RUN_FILE}, so it is unknown how "
                "its episodes were made; choose another --out"
            )
        keep_configuration(self.folder, self._configuration)


def keep_configuration(folder: Path, configuration: Mapping[str, Any]) -> None:
    """Write the configuration into a new folder, or compare it with the one that is there.

    Raises:
        RunFolderError: The folder was begun with another configuration, or can't be written.
    """
    path = folder / RUN_FILE
    as_read = json.loads(json.dumps(configuration))
    if not path.exists():
        content = {
            "created": datetime.now(UTC).isoformat(timespec="seconds"),
            "configuration": as_read,
        }
        write_whole(path, json.dumps(content, indent=2, ensure_ascii=False) + "\n")
        return
    found = differences(read_configuration(folder), as_read)
    if found:
        shown = "; ".join(found[:8]) + ("; …" if len(found) > 8 else "")
        raise RunFolderError(
            f"{folder} was begun with another configuration: {shown}. Use the same options "
            "again, or choose another --out"
        )


def read_configuration(folder: Path) -> dict[str, Any]:
    """The configuration of a run.

    Raises:
        RunFolderError: The folder is not that of a run.
    """
    path = folder / RUN_FILE
    try:
        content = parse_json(read_own(path))
    except FileNotFoundError as error:
        if not folder.is_dir():
            raise RunFolderError(f"there is no folder {folder}; check the path") from error
        raise RunFolderError(
            f"{folder} is not the folder of an evaluation: there is no {RUN_FILE} in it; to see "
            "single searches: hypernav runs"
        ) from error
    except OSError as error:
        raise RunFolderError(f"{path} cannot be read: {error.strerror or error}") from error
    except ValueError as error:
        raise RunFolderError(f"{path} cannot be read: {error}") from error
    if not isinstance(content, dict) or not isinstance(content.get("configuration"), dict):
        raise RunFolderError(f"{path} holds no configuration; was it edited?")
    return content["configuration"]


def read_records(folder: Path) -> list[EpisodeRecord]:
    """All finished episodes of a run, in the order in which they were done.

    Raises:
        RunFolderError: A line cannot be read, or an episode is there twice.
    """
    return list(read_record_file(folder / EPISODES_FILE, EpisodeRecord).values())


def read_sessions(folder: Path) -> list[Session]:
    """The figures of all sessions; unreadable lines are left out."""
    path = folder / SESSIONS_FILE
    sessions = []
    for line in _whole_lines(path).splitlines():
        try:
            sessions.append(Session.model_validate_json(line))
        except ValidationError:
            _LOGGER.warning("%s: a line cannot be read and is left out", path)
    return sessions


def differences(old: Mapping[str, Any], new: Mapping[str, Any]) -> list[str]:
    """Differences of two configurations, such as "search.endurance_steps was 40, is now 60"."""
    before, after = flat(old), flat(new)
    return [
        f"{key} was {_shown(before, key)}, is now {_shown(after, key)}"
        for key in sorted(before.keys() | after.keys())
        if _shown(before, key) != _shown(after, key)
    ]


def flat(value: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """The values of a nested configuration by their whole names."""
    found: dict[str, Any] = {}
    for key, item in value.items():
        if isinstance(item, Mapping):
            found.update(flat(item, f"{prefix}{key}."))
        else:
            found[f"{prefix}{key}"] = item
    return found


def _shown(values: Mapping[str, Any], key: str) -> str:
    return json.dumps(values[key], ensure_ascii=False) if key in values else "absent"


def _whole_lines(path: Path) -> bytes:
    """The content of a file of lines, its last line terminated; empty if there is no file."""
    content = file_content(path)
    return content if content.endswith(b"\n") or not content else content + b"\n"


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
