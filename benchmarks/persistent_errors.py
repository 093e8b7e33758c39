"""Measure which errors of a network stick to things, on a bank of benchmarks/detection_bank.py.

A thing counts in a view if it covers at least the share of the image that ground truth needs. It is
found if a detection of its kind, with at least the usual score, overlaps its box with IoU of at
least 0.3. A detection that overlaps a thing of another kind so is taken from it; one that overlaps
none is taken from the building. What is said of a thing sticks to it if it is said again in other
views.

    python benchmarks/persistent_errors.py bank
"""

from collections import Counter, defaultdict
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import tyro
from detection_bank import KeptView, views_of

from hypernav.core.errors import GoalError
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel
from hypernav.search.models.closed_set import COCO_CLASSES, class_for
from hypernav.search.perception.local.stand_ins.ground_truth import true_detection, visible_objects

USUAL_SCORE = 0.3
LEAST_IOU = 0.3
SIDES_PX = (0.0, 30.0, 60.0, 120.0, 240.0, np.inf)
OFTEN = 4
LEAST_TIMES = 5
Thing = tuple[str, int]


@dataclass
class Tally:
    """Everything counted.

    Attributes:
        views: Number of views.
        found: Whether a thing of a known kind was found, by bin of size and whether it is cut off.
        looks: The same by thing.
        kinds: The same by kind.
        said: What was said in every view of a thing of another kind, by thing ("" for nothing).
        taken: Kinds that were said of things of a kind.
        building: Kinds that were said where no thing is.
        seen: Views of things of every kind.
        right: Scores of right detections.
        wrong: Scores of the others.
    """

    views: int = 0
    found: dict[tuple[int, bool], list[bool]] = field(default_factory=lambda: defaultdict(list))
    looks: dict[Thing, list[bool]] = field(default_factory=lambda: defaultdict(list))
    kinds: dict[str, list[bool]] = field(default_factory=lambda: defaultdict(list))
    said: dict[Thing, list[set[str]]] = field(default_factory=lambda: defaultdict(list))
    taken: Counter[tuple[str, str]] = field(default_factory=Counter)
    building: Counter[str] = field(default_factory=Counter)
    seen: Counter[str] = field(default_factory=Counter)
    right: list[float] = field(default_factory=list)
    wrong: list[float] = field(default_factory=list)

    def count(self, view: KeptView) -> None:
        """Enter one view."""
        truth = view.observation.truth
        assert truth is not None
        self.views += 1
        height, width = truth.ids.shape
        sure = [one for one in view.detections if one.score >= USUAL_SCORE]
        things = {number: true_detection(truth, number).box for number in visible_objects(truth)}
        wrong_of: dict[int, set[str]] = {number: set() for number in things}
        found: set[int] = set()
        for one in sure:
            over = {k: iou for k, box in things.items() if (iou := one.box.iou(box)) >= LEAST_IOU}
            right_ones = {k for k in over if is_named(truth.labels[k], one)}
            found |= right_ones
            (self.right if right_ones else self.wrong).append(one.score)
            if not over:
                self.building[one.label] += 1
            elif not right_ones:
                wrong_of[max(over, key=over.__getitem__)].add(one.label)
        for number, box in things.items():
            label, thing = truth.labels[number], (view.scene, number)
            kind, right, wrong = _class_of(label), number in found, wrong_of[number]
            self.seen[label.category] += 1
            if kind is not None:
                size = int(np.searchsorted(SIDES_PX, box.area**0.5)) - 1
                self.found[size, _is_cut(box, width, height)].append(right)
                self.looks[thing].append(right)
                self.kinds[kind].append(right)
            self.taken.update((label.category, said) for said in wrong)
            self.said[thing].append(wrong)

    def report(self) -> str:
        """All rates, as Markdown."""
        lines = [f"{self.views} views", "", "| side, px | whole | cut off |", "| --- | --- | --- |"]
        for size in range(len(SIDES_PX) - 1):
            cells = [_share(self.found[size, cut]) for cut in (False, True)]
            lines.append(f"| {SIDES_PX[size]:g} to {SIDES_PX[size + 1]:g} | {' | '.join(cells)} |")
        often = [looks for looks in self.looks.values() if len(looks) >= OFTEN]
        shares = np.array([np.mean(looks) for looks in often])
        lines += [
            "",
            f"- {len(often)} things of known kinds in {OFTEN} views or more: found in none "
            f"{np.mean(shares == 0):.0%}, in fewer than a quarter {np.mean(shares < 0.25):.0%}, in "
            f"three quarters or more {np.mean(shares >= 0.75):.0%}",
            f"- an object is found again where it was found in another view: {_again(often)}",
            f"- a wrong name is said again: {_again(self._repeats())}",
            f"- views in which a thing gets a wrong name: {self._wrong():.2%}; things that "
            f"ever do: {np.mean([any(s) for s in self.said.values()]):.1%} of {len(self.said)}",
            f"- names said of the building: {sum(self.building.values()) / self.views:.3f} a view "
            f"({_most(self.building)})",
            f"- scores: right {np.mean(self.right):.2f} ± {np.std(self.right):.2f}, "
            f"wrong {np.mean(self.wrong):.2f} ± {np.std(self.wrong):.2f}",
            f"- a name that is not in the table below, in a view of a thing: {self._other():.5f}",
            "",
            "| kind | found |",
            "| --- | --- |",
            *(f"| {kind} | {_share(found)} |" for kind, found in sorted(self.kinds.items())),
            "",
            "| thing | taken for | share of views |",
            "| --- | --- | ---: |",
            *(
                f"| {thing} | {said} | {n / self.seen[thing]:.3f} of {self.seen[thing]} |"
                for (thing, said), n in self._often()
            ),
        ]
        return "\n".join(lines)

    def _often(self) -> list[tuple[tuple[str, str], int]]:
        """Pairs that are confused at least five times, the most frequent first."""
        return [(pair, n) for pair, n in self.taken.most_common() if n >= LEAST_TIMES]

    def _other(self) -> float:
        """Rate of any one wrong name in a view of a thing, of the pairs that are rarer."""
        rare = sum(self.taken.values()) - sum(n for _, n in self._often())
        return rare / (sum(self.seen.values()) * len(COCO_CLASSES))

    def _wrong(self) -> float:
        return float(np.mean([bool(one) for views in self.said.values() for one in views]))

    def _repeats(self) -> list[list[bool]]:
        """For every thing and wrong name that was ever said of it, whether it was, by view."""
        return [
            [name in one for one in views]
            for views in self.said.values()
            if len(views) >= OFTEN
            for name in sorted(set().union(*views))
        ]


def _again(looks: list[list[bool]]) -> str:
    """Probability that one look says what another look at the same thing said."""
    pairs = sum(sum(one) * (len(one) - 1) for one in looks)
    both = sum(sum(one) * (sum(one) - 1) for one in looks)
    return f"{both / max(pairs, 1):.0%} of {pairs} pairs"


def _class_of(label: ObjectLabel) -> str | None:
    try:
        return COCO_CLASSES[class_for(Goal(label.category), COCO_CLASSES)]
    except GoalError:
        return None


def is_named(label: ObjectLabel, detection: Detection) -> bool:
    """Whether a detection names a thing rightly."""
    return label.is_named(detection.label) or _class_of(label) == detection.label


def _is_cut(box: Box, width: int, height: int) -> bool:
    return box.x_min < 1 or box.y_min < 1 or box.x_max > width - 1 or box.y_max > height - 1


def _share(found: list[bool]) -> str:
    return f"{np.mean(found):.0%} of {len(found)}" if found else ""


def _most(names: Counter[str]) -> str:
    return ", ".join(f"{name} {count}" for name, count in names.most_common(8))


def main(bank: tyro.conf.Positional[Path]) -> None:
    """Count the errors in a bank."""
    tally = Tally()
    for view in views_of(bank):
        tally.count(view)
    print(tally.report())


if __name__ == "__main__":
    tyro.cli(main)
