"""The options that configure an agent: the same ones, in the same words, for every command.

What builds the agent is loaded only to build it: help and mistakes are answered without.
"""

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from hypernav.build.component_specs import ComponentSpecs, PresetName

if TYPE_CHECKING:
    from hypernav.build.agents import BuiltAgent
    from hypernav.build.presets import HyPerNavConfig


@dataclass(frozen=True)
class AgentOptions:
    """Who searches. Can be pickled, so that each process of many builds an agent of its own."""

    agent: str = "hypernav"
    """How it explores: hypernav (blocks of the map), frontier (nearest) or package.module:Name."""
    preset: PresetName = "default"
    """Values of the method: the published ones, or those that we measured to be better."""
    vlm: str | None = None
    """A chat model that sees and thinks: openai:URL[#MODEL], local:PATH_OR_ID or replay:FILE."""
    detector: str | None = None
    """Who sees the goal, if not --vlm: ground-truth, yolox:PATH.onnx, vlm, zero-shot:ID, …"""
    reasoner: str | None = None
    """Who chooses where to look, if not --vlm: geometric or vlm."""
    segmenter: str | None = None
    """Who finds the goal's pixels in a box: depth-cut, sam:ID or onnx-sam:ENC.onnx,DEC.onnx."""
    record: Path | None = None
    """Write every exchange with the model of --vlm to this file, for --vlm replay:FILE."""
    config: Path | None = None
    """YAML file with sections like those of result.json's config; only what differs."""
    set: Annotated[tuple[str, ...], tyro.conf.arg(metavar="SECTION.KEY=VALUE")] = field(
        default_factory=tuple
    )
    """Single values of the configuration, for example search.endurance_steps=60."""

    @property
    def specs(self) -> ComponentSpecs:
        """Who sees and thinks, as it was asked for."""
        return ComponentSpecs(self.agent, self.vlm, self.detector, self.reasoner, self.segmenter)

    def resolve(self) -> "HyPerNavConfig":
        """The whole configuration: preset, file, environment and single values, in this order.

        Raises:
            ConfigError: A file that cannot be read, a wrong key or an impossible value.
        """
        from hypernav.build.choosing import choose_components, with_own_sections
        from hypernav.build.presets import preset
        from hypernav.core.config import layered

        config = layered(preset(self.preset), file=self.config, assignments=self.set)
        chosen = choose_components(self.specs, presence=config.presence.enabled)
        return with_own_sections(config, chosen)

    def build(self, config: "HyPerNavConfig | None" = None) -> "BuiltAgent":
        """The agent.

        Args:
            config: From `resolve`, if it was called before.

        Raises:
            ConfigError: Options that do not exist or contradict each other.
            ModelError: A model's file cannot be used.
            RecordingError: A recording is missing, broken or in the way.
            MissingExtraError: A part needs a package that is not installed.
        """
        from hypernav.build.agents import build_agent

        return build_agent(config or self.resolve(), self.specs, record=self.record)

    def describe(self, parts: "BuiltAgent") -> dict[str, Any]:
        """Who searched, for ``result.json``: words for people, specifications for repeating it."""
        return {
            "agent": self.agent,
            "preset": self.preset,
            "detector": parts.detector_words,
            "reasoner": parts.reasoner_words,
            "segmenter": parts.segmenter_words,
            "parts": parts.chosen.as_dict(),
        }


FlatAgentOptions = Annotated[AgentOptions, tyro.conf.arg(name="")]
"""For a command's dataclass: the options without a prefix."""
