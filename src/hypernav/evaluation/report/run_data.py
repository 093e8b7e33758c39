"""The results of a run, read back from its folder."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hypernav.core.errors import RunFolderError
from hypernav.evaluation.record import EpisodeKey, EpisodeRecord
from hypernav.evaluation.store.run_store import read_configuration, read_records, read_sessions
from hypernav.evaluation.summary import counted


@dataclass(frozen=True)
class RunData:
    """One run.

    Attributes:
        folder: Where it is.
        name: Short and unlike those of the other runs in the same report.
        configuration: As in ``run.json``.
        records: All finished episodes.
        sessions: As in ``sessions.jsonl``.
    """

    folder: Path
    name: str
    configuration: dict[str, Any]
    records: list[EpisodeRecord]
    sessions: list[dict[str, Any]]

    @property
    def counted(self) -> list[EpisodeRecord]:
        """The episodes that say something about navigation."""
        return counted(self.records)

    @property
    def by_key(self) -> dict[EpisodeKey, EpisodeRecord]:
        """The counted episodes by scene and id."""
        return {record.key: record for record in self.counted}

    @property
    def who(self) -> dict[str, Any]:
        """Who searched, in words."""
        return self.configuration["who"]

    @property
    def dataset(self) -> str:
        """Name of the data set."""
        return self.configuration["dataset"]

    @property
    def wanted(self) -> int:
        """Episodes that the run shall have."""
        return self.configuration["episodes"]["count"]

    @property
    def is_told_truth(self) -> bool:
        """Whether the simulator told the robot what it sees."""
        return str(self.who.get("parts", {}).get("detector", "")) == "ground-truth"


def load_runs(folders: Sequence[Path]) -> list[RunData]:
    """Read runs.

    Raises:
        RunFolderError: A folder is not one of a run, is damaged, or holds no episode yet.
    """
    configurations = [read_configuration(folder) for folder in folders]
    runs = []
    for folder, name, configuration in zip(
        folders, _names(folders, configurations), configurations, strict=True
    ):
        records = read_records(folder)
        if not any(record.counts for record in records):
            raise RunFolderError(f"{folder} holds no episode that counts yet; run it first")
        runs.append(RunData(folder, name, configuration, records, read_sessions(folder)))
    return runs


def _names(folders: Sequence[Path], configurations: Sequence[dict[str, Any]]) -> list[str]:
    """The shortest way to tell runs apart: by agent, by preset as well, else by folder."""
    agents = [str(c["who"]["agent"]) for c in configurations]
    presets = [f"{c['who']['agent']} ({c['who']['preset']})" for c in configurations]
    for names in (agents, presets, [folder.name for folder in folders]):
        if len(set(names)) == len(names):
            return names
    return [str(folder) for folder in folders]
