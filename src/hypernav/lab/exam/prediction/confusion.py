"""How a model erred in an exam, so that stand-ins can err alike in searches (`mimics`)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from hypernav.lab.exam.prediction.agreement import agreement_of
from hypernav.lab.exam.prediction.choices import BlockChoices, choices_of
from hypernav.lab.exam.prediction.sight import Sight, sight_of
from hypernav.lab.exam.questions import Answered, Role, Shown
from hypernav.search.perception.local.stand_ins.systematic_detector import SAME_NAME_SAID

_NAMES_AGREE = 0.3
"""How alike answers about things of one name are taken to be, if the exam doesn't tell; ours."""
_About = tuple[str, int, str]
"""Building and number of a thing, and the goal that it was or wasn't taken for."""


@dataclass(frozen=True)
class Alarms:
    """How things that aren't the goal are taken for it.

    Whether one is, is drawn by a standard normal number, of which a part belongs to the two names,
    so that a model takes every sofa for the bed, a part to the thing, and the rest to the view.

    Attributes:
        rate: Probability that such a thing is taken for the goal in a view.
        by_names: Share of the variance that belongs to the names, 0 to 1.
        by_thing: Share that belongs to the thing.
        scores: Scores of the boxes, of which there is at least one if the rate isn't 0.
    """

    rate: float
    by_names: float
    by_thing: float
    scores: tuple[float, ...]


@dataclass(frozen=True)
class Confusion:
    """The answers of an exam, so that the same errors can be made in searches.

    Attributes:
        blocks: Which blocks it chooses how often; None if it was not asked.
        sight: How it finds the goal in images of it; None if it was not asked.
        alarms: How things alike and others are taken for the goal; empty if it was not asked.
        most_alarms: Largest number of boxes in an image without the goal.
        presence: By stratum whether the answer was that the goal is there, each "yes" first, then
            None for those that can't be used; empty if it was not asked.
    """

    blocks: BlockChoices | None
    sight: Sight | None
    alarms: Mapping[Role, Alarms]
    most_alarms: int
    presence: Mapping[str, tuple[bool | None, ...]]


def confusion_of(answers: Sequence[Answered]) -> Confusion:
    """How a model erred in an exam, by all its answers."""
    images = [one for one in answers if one.kind == "boxes"]
    without = [one for one in images if not one.true_boxes]
    presence: dict[str, list[bool | None]] = {}
    for one in answers:
        if one.kind == "presence":
            is_yes = None if one.chosen is None else one.chosen == "yes"
            presence.setdefault(one.stratum, []).append(is_yes)
    return Confusion(
        blocks=choices_of(answers),
        sight=sight_of([one for one in images if one.true_boxes]),
        alarms=_alarms_of(without),
        most_alarms=max((len(one.boxes) for one in without), default=0),
        presence=_completed(presence),
    )


def _alarms_of(without: Sequence[Answered]) -> dict[Role, Alarms]:
    """How things are taken for goals that aren't in the image; one role stands in for another."""
    by_role: dict[Role, list[tuple[Answered, Shown]]] = {}
    for answered in without:
        for thing in answered.things:
            by_role.setdefault(thing.role, []).append((answered, thing))
    found: dict[Role, Alarms] = {role: _alarms(some) for role, some in by_role.items()}
    if "alike" not in found and "other" in found:
        found["alike"] = found["other"]
    if "other" not in found and "alike" in found:
        found["other"] = found["alike"]
    return found


def _alarms(shown: Sequence[tuple[Answered, Shown]]) -> Alarms:
    boxed = [(answered, thing) for answered, thing in shown if thing.boxed]
    rate = len(boxed) / len(shown)
    if not boxed:
        return Alarms(0.0, 0.0, 0.0, ())
    # Of each thing one image from each side, which are hardly two, and for the names one in all.
    views: dict[tuple[_About, tuple[int, int, bool]], bool] = {}
    things: dict[_About, tuple[str, bool]] = {}
    for answered, thing in shown:
        about = (answered.scene, thing.number, answered.goal)
        views[about, thing.view] = thing.boxed
        things[about] = (thing.name, thing.boxed)
    same = agreement_of(
        list(views.values()), [rate] * len(views), [about for about, _ in views], SAME_NAME_SAID
    )
    names = agreement_of(
        [is_boxed for _, is_boxed in things.values()],
        [rate] * len(things),
        [(goal, name) for (_, _, goal), (name, _) in things.items()],
        _NAMES_AGREE,
    )
    by_names = min(names, same)
    scores = [1.0 if one.probability is None else one.probability for one, _ in boxed]
    return Alarms(rate, by_names, same - by_names, tuple(scores))


def _completed(
    by_stratum: dict[str, list[bool | None]],
) -> dict[str, tuple[bool | None, ...]]:
    """The answers, "yes" first; what is alike and what isn't stand in for each other."""
    order = (True, None, False).index
    found = {stratum: tuple(sorted(some, key=order)) for stratum, some in by_stratum.items()}
    for stratum, other in (("not there", "look-alike"), ("look-alike", "not there")):
        if stratum not in found and other in found:
            found[stratum] = found[other]
    return found
