"""The options of `hypernav doctor`."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import tyro


@dataclass(frozen=True)
class Options:
    """The model or the data to examine, and how a model is asked."""

    vlm: str | None = None
    """Model to examine: openai:URL[#MODEL] or local:PATH_OR_ID."""
    data: Path | None = None
    """Data folder to examine, as in hm3d:DIR: which parts of the benchmarks are there?"""
    config: Path | None = None
    """YAML file with sections like those of result.json's config; only values that differ."""
    set: Annotated[tuple[str, ...], tyro.conf.arg(metavar="SECTION.KEY=VALUE")] = field(
        default_factory=tuple
    )
    """Single values that override the configuration, for example grounding.family=qwen3-vl."""
