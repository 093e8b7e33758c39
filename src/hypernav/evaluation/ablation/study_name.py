"""Names of the studies of `hypernav ablate`; this module imports nothing, for a fast start."""

from typing import Literal

StudyName = Literal["switches", "model", "refinement"]
