"""The options of `hypernav serve`."""

from dataclasses import dataclass, field
from pathlib import Path

from hypernav.cli.options.agent import AgentOptions, FlatAgentOptions


@dataclass(frozen=True)
class Options:
    """The address, who may come in, the agent, and the folder of all searches."""

    host: str = "127.0.0.1"
    """Address to listen on; all but this machine's own need --token-file."""
    port: int = 8765
    """Port to listen on; 0 takes a free one."""
    token_file: Path | None = None
    """File with a secret that every request must carry: 'Authorization: Bearer SECRET'."""
    state: Path = Path("runs/robot")
    """Folder of all searches; those under way go on from it after a restart."""
    max_searches: int = 8
    """Maximum number of searches under way at once."""
    idle_minutes: float = 60.0
    """Minutes without a word of its robot after which a search ends if another needs the slot."""
    who: FlatAgentOptions = field(default_factory=AgentOptions)
    """The options that configure the agents."""
