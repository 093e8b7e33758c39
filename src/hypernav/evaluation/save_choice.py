"""The choice of episodes that keep their page and video."""

from typing import Literal

SaveChoice = Literal["videos", "failures", "none"]
"""All episodes keep page and video, those that failed, or none."""
