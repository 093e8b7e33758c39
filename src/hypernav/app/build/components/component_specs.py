"""Specifications of components, as written in options."""

from dataclasses import dataclass
from typing import Literal

RobotPresetName = Literal["default", "paper"]
"""Presets that a robot may ask a server for."""

PresetName = Literal[
    "default",
    "paper",
    "vlfm-as-released",
    "navvlm-as-released",
    "vlmnav-as-released",
    "pivot-as-released",
]

BenchmarkName = Literal[
    "hm3d", "mp3d", "ovon", "goat", "hypernav-paper-hm3d", "hypernav-paper-ovon"
]
"""Benchmarks whose robot and limits a run can take (`hypernav.lab.datasets.benchmarks`)."""


@dataclass(frozen=True)
class ComponentSpecs:
    """Specifications of an agent's components. Those that are None are chosen to fit the rest.

    All but ``vlm`` are names of `app.build.components.registries`, or ``package.module:Name``.

    Attributes:
        agent: Agent or explorer: ``hypernav``, ``frontier``, a published method, or a user's own.
        vlm: Chat model: ``openai:URL[#MODEL]``, ``local:ID`` or ``replay:FILE``.
        detector: Detector of the goal.
        reasoner: Reasoner that the agent asks where to go, or what a view is worth.
        segmenter: Segmenter of the pixels in a box.
        native: Whether the agent has its own published stop and moves, if it has any; its
            configuration is then that of `hypernav.native_config`.
        similarity: Model that compares key images of a memory with the goal's words; None for none.
    """

    agent: str = "hypernav"
    vlm: str | None = None
    detector: str | None = None
    reasoner: str | None = None
    segmenter: str | None = None
    native: bool = False
    similarity: str | None = None

    @property
    def name(self) -> str:
        """Name of the agent for people; it says whether the mode is native."""
        return f"{self.agent} (native)" if self.native else self.agent
