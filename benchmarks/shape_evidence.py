"""Measure alone what shape says of a network's detections: how many false ones it removes.

A detection of a bank of benchmarks/detection_bank.py is right if it overlaps a thing of its kind
with IoU of at least 0.3, as in benchmarks/persistent_errors.py. It is removed where its form
shifts the log-odds to the limit or below. The kinds are the network's indoor classes.

    python benchmarks/shape_evidence.py bank
"""

from collections import defaultdict
from pathlib import Path

import numpy as np
import tyro
from detection_bank import KeptView, views_of
from persistent_errors import LEAST_IOU, is_named

from hypernav.core.geometry.boxes import Detection
from hypernav.core.naming.kind_shapes import kind_shape
from hypernav.search.perception.local.shape import measured_form, shape_evidence
from hypernav.search.perception.local.stand_ins.ground_truth import true_detection, visible_objects

Shifts = dict[tuple[str, bool], list[float]]


def judge(view: KeptView, detections: list[Detection], shifts: Shifts) -> None:
    """Enter the shift of every detection of a view, by kind and whether it is right."""
    truth = view.observation.truth
    assert truth is not None
    things = [(truth.labels[k], true_detection(truth, k).box) for k in visible_objects(truth)]
    for one in detections:
        kind = kind_shape(one.label)
        assert one.mask is not None
        is_right = any(
            one.box.iou(box) >= LEAST_IOU and is_named(label, one) for label, box in things
        )
        form = measured_form(view.observation, one.mask, one.box) if kind is not None else None
        shift = 0.0 if kind is None or form is None else shape_evidence(form, kind).log_odds
        shifts[one.label, is_right].append(shift)


def _cells(shifts: Shifts, kinds: list[str], is_right: bool, limit: float) -> str:
    all_of = np.array([shift for kind in kinds for shift in shifts[kind, is_right]])
    return f"{len(all_of)} | {np.mean(all_of <= limit):.0%}" if len(all_of) else "0 | "


def main(bank: tyro.conf.Positional[Path], limit: float = -1.0, least_score: float = 0.3) -> None:
    """Judge a bank.

    Args:
        bank: Folder of the bank.
        limit: Log-odds at which a detection is removed.
        least_score: Score of the least sure detections that count.
    """
    shifts: Shifts = defaultdict(list)
    for view in views_of(bank):
        judge(view, [one for one in view.detections if one.score >= least_score], shifts)
    kinds = sorted({kind for kind, _ in shifts})
    print("| kind | false | removed | true | lost |\n| --- | ---: | ---: | ---: | ---: |")
    for name, members in [*((kind, [kind]) for kind in kinds), ("all", kinds)]:
        false, true = (_cells(shifts, members, right, limit) for right in (False, True))
        print(f"| {name} | {false} | {true} |")


if __name__ == "__main__":
    tyro.cli(main)
