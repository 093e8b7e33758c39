"""What can be said to `hypernav find`."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import tyro

from hypernav.cli.agent_options import AgentOptions, FlatAgentOptions


@dataclass(frozen=True)
class Options:
    """Which goal, where, who searches, and where the results go."""

    goal: tyro.conf.Positional[str]
    """What to find: bed, "L-shaped sofa", …"""
    scene: str = "builtin"
    """The building: builtin, houses:N (any whole number N), or the path of a GLB."""
    who: FlatAgentOptions = field(default_factory=AgentOptions)
    """How to build the agent."""
    start: Annotated[tuple[float, float, float] | None, tyro.conf.arg(metavar="X Y YAW")] = None
    """Where to start in the scene: metres, and degrees counter-clockwise from x; else at random."""
    seed: int = 0
    """Of the random start and of all noise."""
    max_steps: int = 500
    """Step limit."""
    out: Path | None = None
    """Folder for the results; runs/<time>-<goal> by default."""
    quiet: bool = False
    """Say nothing but errors."""
