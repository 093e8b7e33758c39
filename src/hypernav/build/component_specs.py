"""Who sees and who thinks, as people write it."""

from dataclasses import dataclass
from typing import Literal

PresetName = Literal["default", "paper"]


@dataclass(frozen=True)
class ComponentSpecs:
    """Who sees and thinks. What is None is filled in to fit the rest.

    All but ``vlm`` are names of `hypernav.build.registries`, or ``package.module:Name``.

    Attributes:
        agent: Who searches: ``hypernav``, ``frontier``, an explorer or an agent of one's own.
        vlm: The chat model: ``openai:URL[#MODEL]``, ``local:ID`` or ``replay:FILE``.
        detector: Who sees the goal.
        reasoner: Who chooses the block to visit.
        segmenter: Who finds the pixels in a box.
    """

    agent: str = "hypernav"
    vlm: str | None = None
    detector: str | None = None
    reasoner: str | None = None
    segmenter: str | None = None
