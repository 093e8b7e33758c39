"""Choices of the command line; this module imports nothing of the package, for a fast start."""

from typing import Literal

SaveChoice = Literal["videos", "failures", "none"]
"""All episodes keep page and video, those that failed, or none."""


StudyName = Literal["switches", "model", "refinement"]
