"""The options of `hypernav find`."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import tyro

from hypernav.cli.options.agent import AgentOptions, FlatAgentOptions
from hypernav.cli.options.views import FlatViewOptions, ViewOptions


@dataclass(frozen=True)
class Options:
    """The goal, the building, the agent, and the folder of the results."""

    goal: tyro.conf.Positional[str]
    """The object to find: bed, "L-shaped sofa", …"""
    scene: str = "builtin"
    """The building: builtin, houses:N, offices:N, shops:N, crowded:N or storeys:N (any whole number
    N), or the path of a GLB, another model or a Gazebo world."""
    world: str = "native"
    """Simulator: native, habitat if it is installed, or module:Name of one of your own."""
    who: FlatAgentOptions = field(default_factory=AgentOptions)
    """The options that configure the agent."""
    start: Annotated[tuple[float, ...] | None, tyro.conf.arg(metavar="X Y YAW [Z]")] = None
    """Start pose in the scene: metres, and degrees counter-clockwise from x; then the height of its
    floor in metres, where it isn't the main one. Random by default."""
    seed: int = 0
    """Seed of the random start and of all noise."""
    max_steps: int | None = None
    """Maximum number of steps; 500 by default, or those of --native."""
    memory: Path | None = None
    """Folder with what earlier searches learned of the building; this one adds to it."""
    memory_mb: float | None = None
    """Size of that folder, MB, beyond which the images that tell least are forgotten, from now on;
    at first 50."""
    relocalize: bool = False
    """Start without knowing where in the memory, and find out by turning once around; where that
    fails, search without the memory."""
    out: Path | None = None
    """Folder of the results; runs/<time>-<goal> by default."""
    views: FlatViewOptions = field(default_factory=ViewOptions)
    """The options that choose views."""
    quiet: bool = False
    """Print errors only."""
