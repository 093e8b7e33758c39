"""What a run will cost, by what one search costs: from an exam, or from its first episodes."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from hypernav.app.build.components.choosing import ChosenComponents
from hypernav.app.build.components.construction import asked_by
from hypernav.app.build.components.exam_file import ExamFile
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.errors import ConfigError
from hypernav.lab.evaluation.record import EpisodeRecord

SWITCHES = {
    "crop": "--set grounding.score_crops=0",
    "choose block": "--reasoner geometric",
    "verify": "--set presence.enabled=false",
    "choose images": "--set image_recall.max_questions=0",
}
"""Switches that leave a kind of question out."""
_KINDS = {
    "detector": ("ground", "crop"),
    "reasoner": ("choose block", "summarise", "score view", "choose arrow", "choose direction"),
}
"""Kinds of questions that a component asks a model, as in traces."""
FEWER_LOOKS = "--set search.looks=at-destinations"
TYPICAL = {"ground": 32.0, "crop": 20.0, "choose block": 0.4, "verify": 1.0}
"""Questions of a search with `default`, by kind, in a dozen searches; docs/models.md says which."""


@dataclass(frozen=True)
class SearchCost:
    """Means over searches.

    Attributes:
        calls: Number of calls of the model, by kind of question.
        tokens_in: Number of prompt tokens.
        tokens_out: Number of answer tokens.
        seconds: Time, seconds.
        images: Number of images about which the detector would be asked with `FEWER_LOOKS`.
    """

    calls: Mapping[str, float]
    tokens_in: float
    tokens_out: float
    seconds: float
    images: float

    def saved_by(self) -> dict[str, float]:
        """Share of the calls that each switch saves, the largest first."""
        total = sum(self.calls.values())
        if not total:
            return {}
        saved = {SWITCHES[kind]: n / total for kind, n in self.calls.items() if kind in SWITCHES}
        ground = self.calls.get("ground", 0.0)
        looks = 1.0 - min(self.images / ground, 1.0) if ground else 0.0
        of_images = ground + self.calls.get("crop", 0.0)
        saved[FEWER_LOOKS] = looks * of_images / total
        return dict(sorted(saved.items(), key=lambda one: -one[1]))


def kinds_asked(chosen: ChosenComponents) -> list[str]:
    """Kinds of questions that the model is asked."""
    kinds = []
    for component, own in _KINDS.items():
        choice = chosen.by_kind.get(component)
        if choice is not None and "chat" in asked_by(choice):
            kinds += own
    return [*kinds, "verify"] if chosen.presence else kinds


def pace_words(seconds: float, config: HyPerNavConfig, kinds: Iterable[str] = TYPICAL) -> str:
    """How long a search takes at the pace of an answer, for people.

    Args:
        seconds: Time of an answer about an image.
        config: Configuration of the search.
        kinds: Kinds of questions that the model is asked.
    """
    images = TYPICAL["ground"]
    if config.search.looks == "at-destinations":
        images = min(images, _images_at_destinations(config, TYPICAL["choose block"]))
    calls = {kind: TYPICAL[kind] for kind in TYPICAL if kind in kinds}
    for kind in {"ground", "crop"} & calls.keys():
        calls[kind] *= images / TYPICAL["ground"]
    if not config.grounding.score_crops:
        calls.pop("crop", None)
    count = sum(calls.values())
    said = f"an answer takes {seconds:.2g} s"
    if not count:  # no count of other methods' questions is known
        return said
    took = _hours(count * seconds / 3600.0)
    return f"{said}; at this pace a search of about {count:.0f} questions takes {took}"


def cost_by_exam(
    exam: ExamFile, preset: str, config: HyPerNavConfig, kinds: Sequence[str]
) -> SearchCost:
    """What a search costs by the exam's questions and its searches with stand-ins.

    Raises:
        ConfigError: The exam predicted no searches.
    """
    predicted = exam.predicted(preset)
    if predicted is None:
        raise ConfigError(
            "--plan: this exam predicted no searches; the same hypernav exam with --predict 40 "
            "does, and asks the model nothing again"
        )
    if "choose block" not in kinds:
        searched = predicted.asked_without.get("block", predicted.asked)
    elif "verify" not in kinds:
        searched = predicted.asked_without.get("presence", predicted.asked)
    else:
        searched = predicted.asked
    asked = {kind: n for kind, n in searched.items() if kind in kinds}
    images = _images_at_destinations(config, predicted.asked.get("choose block", 0.0))
    if config.search.looks == "at-destinations" and asked.get("ground"):
        left = min(images / asked["ground"], 1.0)
        asked |= {kind: asked[kind] * left for kind in ("ground", "crop") if kind in asked}
    if not config.grounding.score_crops:
        asked.pop("crop", None)
    costs = {kind: exam.costs[kind] for kind in asked if kind in exam.costs}
    return SearchCost(
        calls={kind: asked[kind] * one.calls for kind, one in costs.items()},
        tokens_in=sum(asked[kind] * one.tokens_in for kind, one in costs.items()),
        tokens_out=sum(asked[kind] * one.tokens_out for kind, one in costs.items()),
        seconds=predicted.seconds + sum(asked[kind] * one.seconds for kind, one in costs.items()),
        images=images,
    )


def cost_by_episodes(
    records: Sequence[EpisodeRecord], config: HyPerNavConfig, kinds: Sequence[str]
) -> SearchCost:
    """What a search cost in finished episodes.

    Args:
        records: Their records, at least one.
        config: Configuration of the run.
        kinds: Kinds of questions that the model of the run is asked.
    """
    count = len(records)
    calls = {
        kind: sum(one.questions.get(kind, 0) for one in records) / count
        for kind in kinds
        if any(kind in one.questions for one in records)
    }
    return SearchCost(
        calls=calls,
        tokens_in=sum(one.tokens_in for one in records) / count,
        tokens_out=sum(one.tokens_out for one in records) / count,
        seconds=sum(one.seconds.get("total", 0.0) for one in records) / count,
        images=_images_at_destinations(
            config, sum(one.questions.get("choose block", 0) for one in records) / count
        ),
    )


def cost_lines(cost: SearchCost, count: int, workers: int, config: HyPerNavConfig) -> list[str]:
    """What a run costs, for people."""
    per_search = sum(cost.calls.values())
    hours = count * cost.seconds / workers / 3600.0
    lines = [f"{count} episodes: about {_hours(hours)} with {workers} at a time"]
    if not per_search:
        return [*lines, "no model is asked"]
    lines += [
        f"{count * per_search:,.0f} calls of the model, {per_search:.0f} in a search"
        + "".join(f"; {kind} {n:.1f}" for kind, n in cost.calls.items()),
        f"{count * cost.tokens_in:,.0f} tokens in, {count * cost.tokens_out:,.0f} out",
    ]
    price = config.price
    if price.in_per_million is not None or price.out_per_million is not None:
        spent = cost.tokens_in * (price.in_per_million or 0.0)
        spent += cost.tokens_out * (price.out_per_million or 0.0)
        lines.append(f"{count * spent / 1e6:.4g} in money")
    lines += [
        f"{switch} saves {share:.0%} of the calls"
        for switch, share in cost.saved_by().items()
        if share >= 0.005 and not (switch == FEWER_LOOKS and config.search.looks != "always")
    ]
    return lines


def _images_at_destinations(config: HyPerNavConfig, choices: float) -> float:
    """Number of images with `FEWER_LOOKS`: a turn at the start and at every destination."""
    return config.embodiment.motion.turns_of_a_circle * (choices + 1.0)


def _hours(hours: float) -> str:
    if hours < 1.0 / 60.0:
        return f"{hours * 3600.0:.0f} s"
    return f"{hours * 60.0:.0f} min" if hours < 2.0 else f"{hours:.1f} h"
