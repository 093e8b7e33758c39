"""Running episodes and telling how well they went."""

from hypernav.evaluation.episode import Episode, EpisodeResult, EpisodeStep
from hypernav.evaluation.failures import Failure
from hypernav.evaluation.outcome import Outcome
from hypernav.evaluation.protocol import Protocol, StopRule
from hypernav.evaluation.record import EpisodeRecord

__all__ = [
    "Episode",
    "EpisodeRecord",
    "EpisodeResult",
    "EpisodeStep",
    "Failure",
    "Outcome",
    "Protocol",
    "StopRule",
]
