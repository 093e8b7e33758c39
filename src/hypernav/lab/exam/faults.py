"""Names the systematic faults of a model, from all its answers together.

Each fault needs a rate with an interval or a significance test, so chance alone names none.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace

from scipy.stats import binomtest

from hypernav.core.errors import ConfigError
from hypernav.core.geometry.boxes import Box
from hypernav.lab.evaluation.checks.findings import Finding, State
from hypernav.lab.exam.marks import rate
from hypernav.lab.exam.questions import NO_IMAGE, RIGHT_IOU, Answered, Kind
from hypernav.search.models.chat.vlm_families import VlmFamily, family_named, family_of
from hypernav.search.perception.image_recall import IMAGES_PER_QUESTION
from hypernav.search.perception.local.grounding_format import read_grounding

_LEAST = 8
"""Number of answers below which no fault is named."""
_CLEAR = 0.001
"""p-value below which a bias is named."""
_OFTEN = 0.1
"""Share of images without the goal from which boxes in them are named."""
_PAIRS = 5
"""Number of pairs of names that are told."""
_READINGS = ("pixels", "thousandths", "unit")


def faults_of(answers: Sequence[Answered], model: str, family: str) -> list[Finding]:
    """All faults that the answers show.

    Args:
        answers: All answers of an exam.
        model: Name of the model.
        family: Configured family of models for its coordinates; "auto" reads it off the name.
    """
    return [
        *_unusable(answers),
        *_coordinates(answers, model, family),
        *_yes_or_no(answers),
        *_absence(answers),
        *_first_option(answers),
        *_left_or_right(answers),
        *_images(answers),
        *_certainty(answers),
    ]


def _unusable(answers: Sequence[Answered]) -> Iterator[Finding]:
    asked = [one for one in answers if one.exchanges]
    reasons = Counter(one.unusable for one in asked if one.unusable)
    share = rate(reasons.total(), len(asked))
    if len(asked) >= _LEAST and share.low > 0.05:
        told = "; ".join(f"{reason}: {n}" for reason, n in reasons.most_common(4))
        yield Finding(
            "unusable answers",
            State.FAULT,
            f"{share.mean:.0%} of the answers can't be used ({told})",
            "see the worst examples below; a larger --set block_choice.max_tokens and "
            "grounding.max_tokens helps against cut answers, --set block_choice.mode=constrained "
            "against prose",
        )


def _coordinates(answers: Sequence[Answered], model: str, family: str) -> Iterator[Finding]:
    """Whether the same texts, read by another convention, put more boxes in the right place."""
    seen = [one for one in answers if one.kind == "boxes" and one.true_boxes]
    texts = [_text_of(one) for one in seen]
    told = [
        (one, text) for one, text in zip(seen, texts, strict=True) if any(map(str.isdigit, text))
    ]
    if len(told) < _LEAST:
        return
    try:
        own = family_of(model) if family == "auto" else family_named(family)
    except ConfigError:
        return
    readings = {"configured": own}
    readings["with x and y swapped"] = replace(own, rows_first=not own.rows_first)
    for name in _READINGS:
        space = family_named(name).space
        if space != own.space:
            readings[_SPACES[space]] = replace(own, space=space)
            readings[f"{_SPACES[space]}, with x and y swapped"] = replace(
                own, space=space, rows_first=not own.rows_first
            )
    hits = {name: [_hits(*one, how) for one in told] for name, how in readings.items()}
    best = max(hits, key=lambda name: sum(hits[name]))
    gained = sum(b and not a for a, b in zip(hits["configured"], hits[best], strict=True))
    lost = sum(a and not b for a, b in zip(hits["configured"], hits[best], strict=True))
    if gained + lost and binomtest(gained, gained + lost, alternative="greater").pvalue < _CLEAR:
        yield Finding(
            "coordinates",
            State.FAULT,
            f"boxes look as if they were given {best}: read so, "
            f"{sum(hits[best])} of {len(told)} are right, read {own.name}'s way "
            f"{sum(hits['configured'])}",
            f"--set grounding.family={_family_for(readings[best])}",
        )


_SPACES = {"pixels": "pixels", "thousandths": "0 to 1000", "unit": "0 to 1"}


def _family_for(reading: VlmFamily) -> str:
    if reading.rows_first:
        known = {"thousandths": "gemini"}
        return known.get(reading.space, "… (none of the families has swapped axes in this space)")
    return reading.space


def _text_of(answered: Answered) -> str:
    return next((one.answer for one in answered.exchanges if one.kind == "ground"), "")


def _hits(answered: Answered, text: str, reading: VlmFamily) -> bool:
    boxes = read_grounding(text, reading, *answered.image_size).boxes
    true = [Box(*corners) for corners in answered.true_boxes]
    return any(one.box.iou(box) >= RIGHT_IOU for one in boxes for box in true)


def _yes_or_no(answers: Sequence[Answered]) -> Iterator[Finding]:
    for kind, words, remedy in (
        ("presence", "whether the goal is there", "--set presence.enabled=false"),
        ("near", "whether the goal is likely close by", "another --reasoner for --agent vlfm"),
    ):
        usable = [one for one in answers if one.kind == kind and one.chosen is not None]
        for said, other in (("yes", "no"), ("no", "yes")):
            wrong = [one for one in usable if other in one.right]
            share = rate(sum(one.chosen == said for one in wrong), len(wrong))
            of_all = sum(one.chosen == said for one in usable) / max(len(usable), 1)
            if len(wrong) >= _LEAST and share.low > 0.5 and of_all > 0.8:
                always = "always" if of_all == 1.0 else f"in {of_all:.0%} of all cases"
                yield Finding(
                    f"says {said}",
                    State.FAULT,
                    f"asked {words} it says “{said}” {always}, also where the right answer is "
                    f"“{other}” ({share.mean:.0%} of {share.count})",
                    f"a larger model, or leave the question out: {remedy}",
                )


def _absence(answers: Sequence[Answered]) -> Iterator[Finding]:
    absent = [one for one in answers if one.kind == "boxes" and not one.true_boxes]
    told = [one for one in absent if not one.unusable]
    share = rate(sum(one.raw_boxes for one in told), len(told))
    if len(told) >= _LEAST and share.low > 0.5:
        left = rate(sum(bool(one.boxes) for one in told), len(told))
        yield Finding(
            "ignores absence",
            State.FAULT,
            f"it gives a box in {share.mean:.0%} of {share.count} images without the goal; "
            f"{left.mean:.0%} still have one after the look at the crop",
            "--set grounding.score_crops=2 grounding.min_score=0.5 asks about each box once "
            "more; another --detector if that does not help",
        )
        return
    mistaken = rate(sum(bool(one.boxes) for one in told), len(told))
    if len(told) >= _LEAST and mistaken.low > _OFTEN:
        yield Finding(
            "takes other things for the goal",
            State.NOTE,
            f"it gives a box in {mistaken.mean:.0%} of {len(told)} images without the goal, most "
            f"often of {_taken_for(told)}",
            "--detector, if another knows them apart",
        )


def _taken_for(without: Sequence[Answered]) -> str:
    """The names that most often get a box, in images without the goal."""
    shown, boxed = Counter[str](), Counter[str]()
    for one in without:
        for thing in one.things:
            pair = f"{thing.name} for {one.goal}"
            shown[pair] += 1
            boxed[pair] += thing.boxed
    told = [f"{pair} ({n} of {shown[pair]})" for pair, n in boxed.most_common(_PAIRS) if n]
    return ", ".join(told) or "nothing that has a name"


def _first_option(answers: Sequence[Answered]) -> Iterator[Finding]:
    """Whether the model prefers the first option, or low numbers."""
    kinds: tuple[tuple[Kind, str], ...] = (("block", "block"), ("arrow", "arrow"))
    for kind, word in kinds:
        usable = [o for o in answers if o.kind == kind and o.chosen in o.options and o.options]
        if len(usable) < _LEAST:
            continue
        numbers = [sorted(map(int, set(one.options) - {"0"})) for one in usable]
        first = sum(o.chosen == str(n[0]) for o, n in zip(usable, numbers, strict=True))
        right = sum(str(n[0]) in o.right for o, n in zip(usable, numbers, strict=True))
        expected = max(right, sum(1.0 / len(n) for n in numbers)) / len(usable)
        if binomtest(first, len(usable), expected, alternative="greater").pvalue < _CLEAR:
            firsts = [o for o, n in zip(usable, numbers, strict=True) if o.chosen == str(n[0])]
            # Who names block 1 where there is none is asked again, and has to take another.
            own = [one for one in firsts if len(one.exchanges) < 2] or firsts
            ones = sum(one.chosen == "1" for one in own)
            named = f"{word} 1" if ones >= 0.9 * len(own) else f"the first {word} on the list"
            yield Finding(
                f"prefers {named}",
                State.FAULT,
                f"it answers {named} in {first} of {len(usable)} cases; that was right in {right}",
                "--reasoner geometric" if kind == "block" else "another --agent",
            )
            continue
        low = sum(
            int(str(o.chosen)) in n[: len(n) // 2] for o, n in zip(usable, numbers, strict=True)
        )
        share = sum((len(n) // 2) / len(n) for n in numbers) / len(usable)
        if binomtest(low, len(usable), share, alternative="greater").pvalue < _CLEAR:
            yield Finding(
                "prefers low numbers",
                State.NOTE,
                f"{low} of {len(usable)} times it answers a {word} of the lower half of the "
                f"numbers, {share:.0%} would be chance",
            )


def _left_or_right(answers: Sequence[Answered]) -> Iterator[Finding]:
    usable = [o for o in answers if o.kind == "direction" and o.chosen is not None]
    said = Counter(one.chosen for one in usable)
    for side, count in said.items():
        right = sum(str(side) in one.right for one in usable)
        expected = max(right / max(len(usable), 1), 0.25)
        clear = len(usable) >= _LEAST and expected < 1.0
        if clear and binomtest(count, len(usable), expected, alternative="greater").pvalue < _CLEAR:
            yield Finding(
                f"prefers “{side}”",
                State.FAULT,
                f"of {len(usable)} directions {count} are “{side}”, which was right {right} times",
                "another --agent than navvlm",
            )


def _images(answers: Sequence[Answered]) -> Iterator[Finding]:
    """Whether the model names an image where none shows the goal, or always the first."""
    usable = [o for o in answers if o.kind == "images" and o.chosen is not None]
    remedy = "--set image_recall.max_questions=0"
    empty = [one for one in usable if NO_IMAGE in one.right]
    share = rate(sum(one.chosen != NO_IMAGE for one in empty), len(empty))
    if len(empty) >= _LEAST and share.low > 0.5:
        yield Finding(
            "names images without the goal",
            State.FAULT,
            f"it names an image in {share.mean:.0%} of {share.count} questions about six images of "
            "which none shows the goal",
            remedy,
        )
    shown = [one for one in usable if NO_IMAGE not in one.right]
    first = sum(one.chosen == "1" for one in shown)
    right = sum("1" in one.right for one in shown)
    if len(shown) < _LEAST or right == len(shown):
        return
    expected = max(right / len(shown), 1.0 / IMAGES_PER_QUESTION)
    if binomtest(first, len(shown), expected, alternative="greater").pvalue < _CLEAR:
        yield Finding(
            "prefers image 1",
            State.FAULT,
            f"it answers image 1 alone in {first} of {len(shown)} questions about six images; that "
            f"shows the goal in {right}",
            remedy,
        )


def _certainty(answers: Sequence[Answered]) -> Iterator[Finding]:
    told = [o for o in answers if o.kind != "boxes" and o.probability is not None]
    wrong = [one for one in told if not one.score]
    share = rate(sum((o.probability or 0.0) >= 0.9 for o in wrong), len(wrong))
    if len(wrong) >= _LEAST and share.low > 0.5:
        yield Finding(
            "too sure",
            State.NOTE,
            f"{share.mean:.0%} of its {len(wrong)} wrong answers come with a probability of 90% or "
            "more, so that its probabilities say little",
        )
