"""What can be said to `hypernav eval`."""

from dataclasses import dataclass, field
from pathlib import Path

import tyro

from hypernav.cli.agent_options import AgentOptions, FlatAgentOptions
from hypernav.core.metrics import SUCCESS_DISTANCE_M
from hypernav.evaluation.save_choice import SaveChoice


@dataclass(frozen=True)
class Options:
    """Which episodes, who searches, on how many cores, and where the results go."""

    dataset: tyro.conf.Positional[str]
    """houses-val, houses-ovon, houses-train[#FIRST:END], scene:GLB[#STARTS] or habitat:FILE."""
    who: FlatAgentOptions = field(default_factory=AgentOptions)
    """How to build the agent."""
    out: Path | None = None
    """Folder of the run; runs/<dataset>-<agent> by default."""
    episodes: str | None = None
    """Only these, by place in the data set: FIRST:END (END is not included)."""
    scenes: str | None = None
    """Only these scenes, with commas between them: names, house numbers, or places from 0."""
    goals: str | None = None
    """Only these goals, with commas between them."""
    scenes_dir: Path | None = None
    """Folder of the scenes that habitat:FILE names; by default the folder of the file."""
    workers: int | None = None
    """Processes, each on one core; all cores by default."""
    ray: str | None = None
    """Run the workers on a Ray cluster instead: its address, or auto."""
    save: SaveChoice = "none"
    """Which episodes keep their page and video."""
    max_steps: int = 500
    """Step limit."""
    success_distance: float = SUCCESS_DISTANCE_M
    """Metres from a view point that count as reached; reports show all others, too."""
    seed: int = 0
    """Of all noise."""
    quiet: bool = False
    """Say nothing but errors."""
