"""The figures of one start of a run: a line of ``sessions.jsonl``."""

from pydantic import BaseModel, ConfigDict, Field

UNENDED = "killed, or still running"
"""Value of ``ended`` until the session ends."""


class Session(BaseModel):
    """One start of the program.

    Attributes:
        began: Time of the start, ISO 8601.
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
    ended: str = UNENDED
    seconds: float = 0.0
    cpu_seconds: float = 0.0
    workers: int = 0
    cores: int = 0
    episodes: int = 0
    peak_memory_mb: dict[str, float] = Field(default_factory=dict)
    workers_lost: int = 0
    crashes: dict[str, str] = Field(default_factory=dict)
