"""Measure how a network errs on views of generated houses, by distance; NoisyDetector errs alike.

Every image is taken where a robot may stand, in a random direction. An object counts that covers at
least the share of the image that ground truth needs; its distance is the median depth of its
pixels. It is found if a detection of its kind overlaps the box of its visible pixels with IoU of at
least 0.3. What overlaps no object of its kind is a confusion if it overlaps another object as
much, else a false alarm. The kinds are those of benchmarks/realism.py.

    python benchmarks/detector_errors.py --model yolox_nano.onnx --first 3000 --count 20
"""

from collections import defaultdict
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import tyro
from realism import KINDS

from hypernav.core.embodiment import CameraConfig
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.observation import LabelledPixels
from hypernav.search.models.config import OnnxDetectorConfig
from hypernav.search.models.yolox import YoloxDetector
from hypernav.search.perception.local.stand_ins.ground_truth import true_detection, visible_objects
from hypernav.search.perception.local.stand_ins.noisy_detector import resembles
from hypernav.simulator.houses.building import Building
from hypernav.simulator.houses.generator import generate
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer
from hypernav.simulator.worlds.scenes.scene import Scene
from hypernav.simulator.worlds.surface.walkable import WalkableGrid

LEAST_IOU = 0.3
BINS_M = (0.0, 1.5, 2.5, 3.5, 5.0, np.inf)
OFTEN_SEEN = 4

Thing = tuple[int, str, int]
"""House, kind that is looked for, and number of an object."""


@dataclass
class Tally:
    """Everything counted, over all images.

    Attributes:
        images: Number of images.
        found: Whether an object was found, by bin of distance.
        looks: Whether an object nearer than 5 m was found, by object.
        alike: Whether an object that resembles the kind was taken for it, by object.
        other: The same for all other objects.
        false_alarms: Number of detections where nothing is.
        right: Scores of right detections.
        wrong: Scores of confusions and false alarms.
        edges_px: Errors of the edges of right boxes, pixels.
    """

    images: int = 0
    found: dict[int, list[bool]] = field(default_factory=lambda: defaultdict(list))
    looks: dict[Thing, list[bool]] = field(default_factory=lambda: defaultdict(list))
    alike: dict[Thing, list[bool]] = field(default_factory=lambda: defaultdict(list))
    other: dict[Thing, list[bool]] = field(default_factory=lambda: defaultdict(list))
    false_alarms: int = 0
    right: list[float] = field(default_factory=list)
    wrong: list[float] = field(default_factory=list)
    edges_px: list[float] = field(default_factory=list)

    def count(
        self,
        house: int,
        kind: str,
        things: dict[int, tuple[ObjectLabel, Box, float]],
        detections: list[Detection],
    ) -> None:
        """Enter one kind in one image.

        Args:
            house: Number of the house.
            kind: Kind that is looked for.
            things: Label, box and distance of everything visible, by number.
            detections: Detections of this kind.
        """
        goal, claimed = Goal(kind), set[int]()
        for detection in detections:
            overlaps = {i: detection.box.iou(box) for i, (_, box, _) in things.items()}
            there = [i for i, iou in overlaps.items() if iou >= LEAST_IOU]
            right = [i for i in there if things[i][0].satisfies(goal)]
            claimed.update(right or there)
            (self.right if right else self.wrong).append(detection.score)
            self.false_alarms += not there
            if right:
                box = things[max(right, key=overlaps.__getitem__)][1]
                self.edges_px += [
                    detection.box.x_min - box.x_min,
                    detection.box.y_min - box.y_min,
                    detection.box.x_max - box.x_max,
                    detection.box.y_max - box.y_max,
                ]
        for number, (label, _, distance_m) in things.items():
            thing, is_claimed = (house, kind, number), number in claimed
            if label.satisfies(goal):
                self.found[int(np.searchsorted(BINS_M, distance_m)) - 1].append(is_claimed)
                if distance_m < 5.0:
                    self.looks[thing].append(is_claimed)
            else:
                kept = self.alike if resembles(label, goal) else self.other
                kept[thing].append(is_claimed)

    def report(self) -> str:
        """All rates, as Markdown."""
        lines = ["| distance, m | seen | missed |", "| --- | ---: | ---: |"]
        for number, found in sorted(self.found.items()):
            low, high = BINS_M[number : number + 2]
            lines.append(f"| {low:g} to {high:g} | {len(found)} | {1 - np.mean(found):.0%} |")
        often = [found for found in self.looks.values() if len(found) >= OFTEN_SEEN]
        never = np.mean([not any(found) for found in often])
        per_kind = self.false_alarms / (self.images * len(KINDS))
        lines += [
            "",
            f"- {self.images} images; of {len(often)} objects that lie within 5 m in {OFTEN_SEEN} "
            f"images or more, {never:.0%} are found in none",
            f"- {per_kind:.4f} false alarms per image and kind",
            f"- taken for the kind: {_confused(self.alike)} of objects that resemble it, "
            f"{_confused(self.other)} of others",
            f"- scores: right {np.mean(self.right):.2f} ± {np.std(self.right):.2f}, "
            f"wrong {np.mean(self.wrong):.2f} ± {np.std(self.wrong):.2f}",
            f"- edges of right boxes: half are off by {np.median(np.abs(self.edges_px)):.1f} pixels"
            " at most",
        ]
        return "\n".join(lines)


def _confused(taken: dict[Thing, list[bool]]) -> str:
    """Shares of images and of objects."""
    looks = [one for looks in taken.values() for one in looks]
    ever = [any(looks) for looks in taken.values()]
    return (
        f"{np.mean(looks):.2%} of {len(looks)} images, "
        f"at least once {np.mean(ever):.2%} of {len(ever)}"
    )


def look_about(
    tally: Tally, house: int, scene: Scene, detector: YoloxDetector, images: int
) -> None:
    """Count the errors in random views of one house."""
    rng, config = np.random.default_rng(house), CameraConfig()
    grid, renderer = WalkableGrid.from_scene(scene), CpuRenderer(scene)
    camera: PinholeCamera = config.intrinsics
    labels = {one.id: one.label for one in scene.instances if one.label is not None}
    for _ in range(images):
        x, y = grid.random_point(rng)
        pose: Transform = Pose2(x, y, float(rng.uniform(-np.pi, np.pi))).to_transform(
            grid.height_at(x, y)
        )
        view = renderer.render(camera, pose @ config.camera_to_base)
        pixels = LabelledPixels(view.instance_ids, labels)
        things = {
            number: (labels[number], seen.box, float(np.median(view.depth[seen.mask])))
            for number in visible_objects(pixels)
            for seen in [true_detection(pixels, number)]
        }
        detections = detector.detect_all(view.rgb)
        tally.images += 1
        for kind in KINDS:
            tally.count(house, kind, things, [one for one in detections if one.label == kind])
    renderer.close()


def main(model: Path, first: int = 3000, count: int = 20, images: int = 60) -> None:
    """Count the errors in houses ``first`` to ``first + count - 1``.

    Args:
        model: ONNX export of a YOLOX network.
        first: Number of the first house.
        count: Number of houses.
        images: Number of images of each house.
    """
    detector, tally = YoloxDetector(model, OnnxDetectorConfig()), Tally()
    for house in range(first, first + count):
        look_about(tally, house, generate(Building("houses", house)), detector, images)
    print(tally.report())


if __name__ == "__main__":
    tyro.cli(main)
