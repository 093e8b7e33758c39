"""What a model that was examined reaches in searches, by those of its stand-ins."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hypernav.lab.evaluation.statistics import Comparison, Estimate, compare, mean_with_interval
from hypernav.lab.exam.marks import share
from hypernav.lab.exam.prediction.searches import Searched, SearchedEpisode, Variant
from hypernav.lab.exam.questions import Kind

LEFT_OUT: dict[Variant, Kind] = {"rule": "block", "unchecked": "presence"}
"""The question that a variant leaves out."""


@dataclass(frozen=True)
class Prediction:
    """What a search with a preset reaches.

    Attributes:
        preset: The preset.
        success: Share of goals found.
        spl: Success weighted by path length.
        without: By question: SPL without asking it, less SPL with it.
        steps: Mean number of steps.
        asked: Mean number of questions of a search, by kind.
        asked_without: By question: the same without asking it, so that searches take other paths.
        seconds: Mean processor time of a search without the model's, seconds.
    """

    preset: str
    success: Estimate
    spl: Estimate
    without: dict[Kind, Comparison]
    steps: float
    asked: dict[str, float]
    asked_without: dict[Kind, dict[str, float]]
    seconds: float

    @property
    def leave_out(self) -> tuple[Kind, ...]:
        """The questions that are better not asked: the search is no worse without them.

        Where it finds nothing with or without a question, nothing is said.
        """
        least = 0.0 if self.spl.mean > 0.0 else 1e-9
        return tuple(k for k, gap in self.without.items() if gap.difference.mean >= least)


def predictions_of(episodes: Sequence[SearchedEpisode]) -> list[Prediction]:
    """A prediction for every preset."""
    presets = dict.fromkeys(one.preset for episode in episodes for one in episode.searches)
    return [_prediction(preset, episodes) for preset in presets]


def _prediction(preset: str, episodes: Sequence[SearchedEpisode]) -> Prediction:
    scenes = [episode.scene_id for episode in episodes]
    by_variant: dict[Variant, list[Searched]] = {}
    for episode in episodes:
        for one in episode.searches:
            if one.preset == preset:
                by_variant.setdefault(one.variant, []).append(one)
    done = by_variant["model"]
    spl = [one.spl for one in done]
    left_out: dict[Kind, list[Searched]] = {
        kind: by_variant[variant] for variant, kind in LEFT_OUT.items() if variant in by_variant
    }
    return Prediction(
        preset=preset,
        success=share([one.success for one in done], scenes),
        spl=mean_with_interval(spl, scenes),
        without={k: compare(spl, [o.spl for o in some], scenes) for k, some in left_out.items()},
        steps=float(np.mean([one.steps for one in done])),
        asked=_mean_asked(done),
        asked_without={kind: _mean_asked(some) for kind, some in left_out.items()},
        seconds=float(np.mean([one.seconds for one in done])),
    )


def _mean_asked(searches: Sequence[Searched]) -> dict[str, float]:
    kinds = sorted({kind for one in searches for kind in one.asked})
    return {kind: float(np.mean([one.asked.get(kind, 0) for one in searches])) for kind in kinds}
