"""The options of `hypernav serve`."""

from dataclasses import dataclass, field
from pathlib import Path

from hypernav.cli.options.agent import AgentOptions, FlatAgentOptions


@dataclass(frozen=True)
class Options:
    """The address, the access, the agent, and the folder of all searches."""

    host: str = "127.0.0.1"
    """Address to listen on; --token-file is needed unless only this machine can reach it."""
    port: int = 8765
    """Port to listen on; 0 takes a free one."""
    token_file: Path | None = None
    """File with a secret that every request must carry: 'Authorization: Bearer SECRET'."""
    state: Path = Path("runs/robot")
    """Folder of all searches; those under way are continued from it after a restart."""
    max_searches: int = 16
    """Maximum number of searches under way at once."""
    idle_minutes: float = 10.0
    """Minutes without a message of its robot after which a search ends."""
    memory: Path | None = None
    """Folder of a memory of the building: every search begins with what earlier ones learned."""
    memory_mb: float | None = None
    """Size of that folder, MB, beyond which the images that tell least are forgotten, from now on;
    at first 50."""
    relocalize: bool = False
    """Let robots turn once around at the start of a search to find out where they are in it: poses
    may be in any frame."""
    who: FlatAgentOptions = field(default_factory=AgentOptions)
    """The options that configure the agents."""
