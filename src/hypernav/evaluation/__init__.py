"""Running episodes and telling how well they went."""

from hypernav.evaluation.episode import Episode, EpisodeResult, EpisodeStep
from hypernav.evaluation.outcome import Outcome

__all__ = ["Episode", "EpisodeResult", "EpisodeStep", "Outcome"]
