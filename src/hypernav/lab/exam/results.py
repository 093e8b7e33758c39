"""The results of an exam as JSON and page, and the paired comparison of two exams."""

import hashlib
import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from hypernav.app.build.components.exam_file import VERSION
from hypernav.app.show.templating import data_uri, page_environment, plain
from hypernav.core.errors import OutputError
from hypernav.io.foreign_folder import read_own
from hypernav.io.writing import write_whole
from hypernav.lab.evaluation.checks.findings import Finding, State
from hypernav.lab.evaluation.statistics import Comparison, compare, holm
from hypernav.lab.exam.faults import faults_of
from hypernav.lab.exam.marks import TypeMarks, costs_of, marks_of
from hypernav.lab.exam.pictures import picture_of
from hypernav.lab.exam.prediction.calibration import calibration_of
from hypernav.lab.exam.prediction.outlook import Prediction
from hypernav.lab.exam.questions import KINDS, STRATA, Answered
from hypernav.lab.exam.sitting import Nameless
from hypernav.search.models.chat.answer_parsing import unwrapped

PAGE, RESULT = "index.html", "exam.json"
_MOST_WRONG, _MOST_RIGHT = 9, 3


@dataclass(frozen=True)
class Examined:
    """Who was examined, and with what.

    Attributes:
        model: Name of the model, or of the components.
        family: Configured family of the model's coordinates.
        bank: Description of the bank: name, size and version.
        wanted: Number of questions of the bank.
        who: Specifications of the components.
        prompts: Hashes of the texts of the questions.
        price_in_per_million: Price of a million prompt tokens; None if unknown.
        price_out_per_million: Price of a million answer tokens.
        nameless: Questions that the detector has no name for.
    """

    model: str
    family: str
    bank: str
    wanted: int
    who: dict[str, str]
    prompts: dict[str, str]
    price_in_per_million: float | None = None
    price_out_per_million: float | None = None
    nameless: Nameless = field(default_factory=Nameless)

    def cost(self, answers: Sequence[Answered]) -> float | None:
        """Price of these answers, in the currency of the prices; None without a price."""
        if self.price_in_per_million is None and self.price_out_per_million is None:
            return None
        told = [one for answer in answers for one in answer.exchanges if one.by_model]
        tokens_in, tokens_out = (sum(o.tokens_in for o in told), sum(o.tokens_out for o in told))
        prices = (self.price_in_per_million or 0.0, self.price_out_per_million or 0.0)
        return (tokens_in * prices[0] + tokens_out * prices[1]) / 1e6


@dataclass(frozen=True)
class Difference:
    """Two exams on the same questions of one type: the second minus the first.

    Attributes:
        words: Type of the questions.
        first: Mean score of the first exam.
        second: Mean score of the second exam.
        gap: Difference with interval; its p-value is corrected for the number of types (Holm).
    """

    words: str
    first: float
    second: float
    gap: Comparison


def write_results(
    folder: Path,
    examined: Examined,
    answers: Sequence[Answered],
    predictions: Sequence[Prediction] = (),
) -> Path:
    """Write ``exam.json`` and the page.

    Args:
        folder: Folder of the exam.
        examined: Who was examined.
        answers: All answers.
        predictions: What searches would reach, by preset.

    Returns:
        Path of the page, which is one file and needs no network.

    Raises:
        OutputError: The folder can't be written.
    """
    marks, cost = marks_of(answers), examined.cost(answers)
    faults = faults_of(answers, examined.model, examined.family)
    questions, wrappings = digest_of(answers), wrappings_of(answers)
    content = {
        "format": "hypernav-exam",
        "version": VERSION,
        **asdict(examined),
        "count": len(answers),
        "questions": questions,
        "worth": calibration_of(answers).model_dump(mode="json"),
        "predictions": [asdict(one) | {"leave_out": one.leave_out} for one in predictions],
        "costs": {kind: one.model_dump() for kind, one in costs_of(answers).items()},
        "types": [asdict(one) | {"verdict": one.verdict} for one in marks],
        "faults": [asdict(one) for one in faults],
        "cost": cost,
        "wrappings": wrappings,
    }
    page = page_environment("hypernav.lab.evaluation", "hypernav.lab.exam").get_template(
        "exam.html.j2"
    )
    text = page.render(
        examined=examined,
        questions=questions,
        answers=answers,
        marks=marks,
        predictions=predictions,
        count=predictions[0].spl.count if predictions else 0,
        faults=faults,
        lead=_lead(marks, faults, predictions),
        cost=cost,
        wrappings=wrappings,
        wrong=_examples(folder, _worst(answers)),
        right=_examples(folder, [one for one in answers if one.score][: _MOST_RIGHT * 40]),
        state=State,
        most_right=_MOST_RIGHT,
    )
    try:
        write_whole(folder / RESULT, json.dumps(_finite(plain(content)), indent=2) + "\n")
        write_whole(folder / PAGE, text)
    except OSError as error:
        raise OutputError(f"{folder} cannot be written ({error.strerror or error})") from error
    return folder / PAGE


def wrappings_of(answers: Sequence[Answered]) -> dict[str, int]:
    """What was taken off the model's answers before they were read, with the number of answers."""
    texts = [one.answer for answer in answers for one in answer.exchanges if one.by_model]
    found = Counter(name for text in texts for name in unwrapped(text).removed)
    return dict(found.most_common())


def digest_of(answers: Sequence[Answered]) -> str:
    """A hash of all questions with their true answers and what their images show.

    Two exams with the same one asked the same, even if another version of the search or of the
    drawing made the questions.
    """
    told = [(o.id, o.conditions, o.options, o.right, o.costs, o.true_boxes) for o in answers]
    return hashlib.sha256(json.dumps(told).encode()).hexdigest()[:12]


def differences_of(first: Sequence[Answered], second: Sequence[Answered]) -> list[Difference]:
    """The second exam minus the first, type by type, on the questions that both have."""
    by_id = {one.id: one for one in second}
    pairs = [
        (one, by_id[one.id]) for one in first if one.id in by_id and _is_same(one, by_id[one.id])
    ]
    found = []
    for kind, words in KINDS.items():
        of_kind = [(a, b) for a, b in pairs if a.kind == kind]
        if of_kind:
            scores = [a.score for a, _ in of_kind], [b.score for _, b in of_kind]
            gap = compare(*scores, [a.scene for a, _ in of_kind])
            first_mean, second_mean = (float(np.mean(one)) for one in scores)
            found.append(Difference(words, first_mean, second_mean, gap))
    corrected = holm([one.gap.p_value for one in found])
    return [
        Difference(one.words, one.first, one.second, replace(one.gap, p_value=p))
        for one, p in zip(found, corrected, strict=True)
    ]


def _is_same(a: Answered, b: Answered) -> bool:
    """Whether two answers are to the same question."""
    return (a.options, a.right, a.true_boxes) == (b.options, b.right, b.true_boxes)


def write_comparison(folder: Path, names: tuple[str, str], found: Sequence[Difference]) -> Path:
    """Write ``comparison.json`` and the page of two exams.

    Raises:
        OutputError: The folder can't be written.
    """
    page = page_environment("hypernav.lab.evaluation", "hypernav.lab.exam").get_template(
        "exam_comparison.html.j2"
    )
    content = {"names": names, "types": [asdict(one) for one in found]}
    try:
        write_whole(folder / "comparison.json", json.dumps(_finite(plain(content)), indent=2))
        write_whole(folder / PAGE, page.render(names=names, found=found))
    except OSError as error:
        raise OutputError(f"{folder} cannot be written ({error.strerror or error})") from error
    return folder / PAGE


def _lead(
    marks: Sequence[TypeMarks], faults: Sequence[Finding], predictions: Sequence[Prediction]
) -> str:
    count = sum(one.count for one in marks)
    told = f"{count:,} questions about buildings that nobody has seen, with known answers. "
    told += {0: "No systematic fault is shown.", 1: "One systematic fault is shown."}.get(
        len(faults), f"{len(faults)} systematic faults are shown."
    )
    if predictions:
        first = predictions[0]
        told += f" Predicted: {first.success.mean:.0%} of goals found, SPL {first.spl.mean:.2f}"
        return f"{told} with {first.preset}."
    block = next((one for one in marks if one.kind == "block"), None)
    return told if block is None else f"{told} For the choice of blocks: {block.verdict}"


def _worst(answers: Sequence[Answered]) -> list[Answered]:
    """Wrong answers, the types in turn; of each, usable, far off and sure ones first."""

    def badness(one: Answered) -> tuple[bool, float]:
        return (not one.unusable, (one.regret_m or 0.0) + (one.probability or 0.0))

    by_kind = {
        kind: sorted((o for o in answers if o.kind == kind and not o.score), key=badness)[::-1]
        for kind in KINDS
    }
    longest = max(map(len, by_kind.values()))
    return [wrong[k] for k in range(longest) for wrong in by_kind.values() if k < len(wrong)]


def _examples(folder: Path, answers: Sequence[Answered]) -> list[dict[str, Any]]:
    """Images and texts of at most nine answers, of as many types as possible."""
    found, kinds = [], set[str]()
    for one in sorted(answers, key=lambda one: one.kind in kinds or bool(kinds.add(one.kind))):
        try:
            picture = read_own(picture_of(folder, one.id))
        except OSError:
            continue
        said = next((e.answer for e in one.exchanges if e.by_model), "")
        truth = f"{len(one.true_boxes)} in the image" if one.true_boxes else "not in the image"
        found.append(
            {
                "image": data_uri(picture, "image/webp"),
                "words": KINDS[one.kind],
                "goal": one.goal,
                "part": STRATA.get((one.kind, one.stratum), ""),
                "right": " or ".join(one.right) if one.right else truth,
                "chosen": _chosen(one),
                "regret_m": one.regret_m,
                "said": said[:300],
            }
        )
        if len(found) == _MOST_WRONG:
            break
    return found


def _chosen(one: Answered) -> str:
    if one.unusable:
        return f"unusable: {one.unusable}"
    if one.kind == "mask":
        return f"overlap {one.overlap or 0.0:.0%}"
    if one.kind == "boxes":
        return f"{len(one.boxes) or 'no'} box{'es' if len(one.boxes) != 1 else ''}"
    return one.chosen or "none"


def _finite(value: Any) -> Any:
    """JSON data with null for numbers that are not finite."""
    if isinstance(value, dict):
        return {key: _finite(one) for key, one in value.items()}
    if isinstance(value, list):
        return [_finite(one) for one in value]
    return None if isinstance(value, float) and not np.isfinite(value) else value
