"""The options of `hypernav ablate`: those of `hypernav eval`, and the choice of the variants."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import tyro

from hypernav.build.component_specs import PresetName
from hypernav.cli.options.agent import AgentOptions
from hypernav.cli.options.eval import Options as EvalOptions
from hypernav.evaluation.choices import StudyName


@dataclass(frozen=True)
class _VariedAgent(AgentOptions):
    """The agent; its preset is described as the one that is varied."""

    preset: Annotated[PresetName, tyro.conf.arg(name="of")] = "default"
    """Preset that is varied: with default, also every value that differs from the paper's."""


@dataclass(frozen=True)
class Options(EvalOptions):
    """The episodes, the method and its variants; other options are as in hypernav eval."""

    who: Annotated[_VariedAgent, tyro.conf.arg(name="")] = field(default_factory=_VariedAgent)
    """The options that configure the agent, in all variants."""
    out: Path | None = None
    """Folder of the page, with a folder for every variant; runs/<…>-ablation by default."""
    study: StudyName = "switches"
    """What is studied: the switches of the method, the quality of the model, or the step from a box
    to the goal area (refinement)."""
    only: str | None = None
    """Only these variants, separated by commas, and the unchanged method; --list names them."""
    list: bool = False
    """List the variants and what each of them sets, and run nothing."""
