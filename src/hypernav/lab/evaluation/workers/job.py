"""What a worker is told to do: plain data, known without loading what a search consists of."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.components.protocols import Agent
from hypernav.core.world import Simulator
from hypernav.lab.evaluation.choices import SaveChoice

OpenWorld = Callable[[str, HyPerNavConfig], Simulator]
"""Opens the scene of a name for a robot."""


@dataclass(frozen=True)
class Job:
    """How a worker runs the episodes of a run. It can be pickled for another process.

    Attributes:
        folder: Folder of the run, for pages and videos.
        config: Values of the method, the robot and the camera.
        specs: Specifications of agent, model, detector, reasoner and segmenter.
        seed: Seed of all noise.
        save: Choice of episodes that keep page and video.
        make_agent: Factory of an agent of your own, in place of the configured one.
        world: Name of the simulator that scenes are opened in, or a function like those of
            `hypernav.app.build.worlds.WORLDS` for scenes of your own.
        fresh_memory: Whether every goal of a life begins without memory.
    """

    folder: Path
    config: HyPerNavConfig = field(default_factory=HyPerNavConfig)
    specs: ComponentSpecs = field(default_factory=ComponentSpecs)
    seed: int = 0
    save: SaveChoice = "none"
    make_agent: Callable[[], Agent] | None = None
    world: str | OpenWorld = "native"
    fresh_memory: bool = False


def factory_name(make_agent: Callable[[], Agent]) -> str:
    """The name of a factory for people: that of its function or class."""
    return getattr(make_agent, "__name__", type(make_agent).__name__)
