"""Which episodes of an evaluation keep their page and video."""

from typing import Literal

SaveChoice = Literal["videos", "failures", "none"]
"""All episodes, those that failed, or none."""
