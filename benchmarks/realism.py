"""Measure whether a network trained on photographs recognises generated furniture.

Every object of eight COCO kinds is rendered from 1.2 to 3.5 m (camera to the middle of the object,
on the floor) at the camera's height, where the whole object lies in the image and at least 60%
of it is visible. Recognised means: a detection of that class with a score of at least 0.3 whose
box overlaps the box of the object's visible pixels with IoU of at least 0.5.

    python benchmarks/realism.py --model yolox_nano.onnx --first 3000 --count 50
"""

import json
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import cv2
import numpy as np
import tyro
from jaxtyping import Bool, UInt8

from hypernav.core.embodiment import CameraConfig
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.naming.labels import canonical
from hypernav.core.world import Instance
from hypernav.search.models.config import OnnxDetectorConfig
from hypernav.search.models.yolox import YoloxDetector
from hypernav.simulator.houses.building import house
from hypernav.simulator.houses.generator import generate
from hypernav.simulator.worlds.drawing.rays import RayCaster
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer
from hypernav.simulator.worlds.scenes.loading import read_scene
from hypernav.simulator.worlds.scenes.scene import Scene
from hypernav.simulator.worlds.surface.walkable import WalkableGrid

KINDS = (
    "bed",
    "chair",
    "couch",
    "toilet",
    "tv",
    "refrigerator",
    "potted plant",
    "dining table",
)
NEAR_M, FAR_M = 1.2, 3.5
LEAST_VISIBLE = 0.6
LEAST_IOU = 0.5
LEAST_SCORE = 0.3
TURN_DEG = 12.0


@dataclass
class View:
    """One view of one object, and the detection in its box."""

    house: int
    kind: str
    name: str
    distance_m: float
    visible: float
    recognised: bool
    best_iou: float
    said: str
    score: float


def kind_of(instance: Instance) -> str | None:
    """The COCO kind of an instance's category, if it is one of the eight."""
    if instance.label is None:
        return None
    own = canonical(instance.label.category)
    return next((kind for kind in KINDS if canonical(kind) == own), None)


def only(scene: Scene, instance: Instance) -> Scene:
    """The scene reduced to one object."""
    return scene.of_faces(scene.face_instance == instance.id)


def pixels_of(caster: RayCaster, number: int, pose: Transform) -> Bool[np.ndarray, "height width"]:
    """Mask of an instance's visible pixels, in an image of a quarter of the size."""
    camera = CameraConfig(width=160, height=120).intrinsics
    rays = camera.rays().reshape(-1, 3) @ pose.rotation.T
    origins = np.repeat(pose.translation[None].astype(np.float32), len(rays), axis=0)
    hit = caster.instances(origins, rays.astype(np.float32)) == number
    return hit.reshape(camera.height, camera.width)


def viewing_poses(
    scene: Scene, instance: Instance, grid: WalkableGrid, rng: np.random.Generator, count: int
) -> Iterator[Pose2]:
    """Poses that look at an object from the wanted distance, in random order."""
    centres = grid.centres()
    middle = (np.array(instance.box_min[:2]) + np.array(instance.box_max[:2])) / 2.0
    away = np.hypot(*(centres - middle).T)
    near = centres[(away >= NEAR_M) & (away <= FAR_M)]
    for x, y in near[rng.permutation(len(near))[:count]]:
        yaw = math.atan2(middle[1] - y, middle[0] - x)
        yield Pose2(float(x), float(y), yaw + math.radians(float(rng.uniform(-TURN_DEG, TURN_DEG))))


def box_of(mask: Bool[np.ndarray, "height width"]) -> Box:
    """The rectangle around a mask's pixels."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    return Box(float(columns[0]), float(rows[0]), float(columns[-1] + 1), float(rows[-1] + 1))


def judge(view: View, box: Box, detections: list[Detection]) -> View:
    """Enter into a view whether the object was recognised, and what was detected in its box."""
    right = [d.box.iou(box) for d in detections if canonical(d.label) == canonical(view.kind)]
    view.best_iou = max(right, default=0.0)
    view.recognised = view.best_iou >= LEAST_IOU
    there = [d for d in detections if d.box.iou(box) >= LEAST_IOU]
    if there:
        best = max(there, key=lambda d: d.score)
        view.said, view.score = best.label, best.score
    return view


class Album:
    """A folder of images of hits and misses, for people to look at."""

    def __init__(self, folder: Path | None) -> None:
        """Keep images in a folder; None keeps no images."""
        self.folder = folder
        self.counts: dict[str, int] = {}
        if folder is not None:
            folder.mkdir(parents=True, exist_ok=True)

    def keep(
        self,
        view: View,
        rgb: UInt8[np.ndarray, "height width 3"],
        box: Box,
        detections: list[Detection],
    ) -> None:
        """Save one view with its boxes."""
        if self.folder is None:
            return
        key = f"{view.kind.replace(' ', '_')}-{'hit' if view.recognised else 'miss'}"
        number = self.counts[key] = self.counts.get(key, 0) + 1
        if number > 60:
            return
        image = np.ascontiguousarray(rgb[..., ::-1])
        for d in detections:
            a, b, c, e = d.box.pixels()
            cv2.rectangle(image, (a, b), (c, e), (0, 200, 255), 1)
            cv2.putText(image, f"{d.label} {d.score:.2f}", (a + 2, b + 12), 0, 0.42, (0, 0, 255), 1)
        a, b, c, e = box.pixels()
        cv2.rectangle(image, (a, b), (c, e), (0, 255, 0), 2)
        cv2.imwrite(str(self.folder / f"{key}-{number:02d}-{view.house}.jpg"), image)


def look_around(
    scene: Scene, house: int, detector: YoloxDetector, *, views_per_object: int, album: Album
) -> Iterator[View]:
    """All views of one scene."""
    wanted = [(instance, kind) for instance in scene.instances if (kind := kind_of(instance))]
    if not wanted:
        return
    config = CameraConfig()
    renderer, grid, everything = (
        CpuRenderer(scene),
        WalkableGrid.from_scene(scene),
        RayCaster(scene),
    )
    for instance, kind in wanted:
        rng = np.random.default_rng([house, instance.id])
        caster = RayCaster(only(scene, instance))
        corners = scene.vertices[np.unique(scene.faces[scene.face_instance == instance.id])].astype(
            np.float64
        )
        left = views_per_object
        for stand in viewing_poses(scene, instance, grid, rng, 40):
            height = grid.height_at(stand.x, stand.y)
            pose = stand.to_transform(height) @ config.camera_to_base
            uv = config.intrinsics.project(pose.inverse().apply(corners))
            if (
                np.isnan(uv).any()
                or (uv < 1).any()
                or (uv[:, 0] > config.width - 1).any()
                or (uv[:, 1] > config.height - 1).any()
            ):
                continue
            share = pixels_of(everything, instance.id, pose).sum() / max(
                pixels_of(caster, instance.id, pose).sum(), 1
            )
            if share < LEAST_VISIBLE:
                continue
            image = renderer.render(config.intrinsics, pose)
            mask = image.instance_ids == instance.id
            detections = detector.detect_all(image.rgb)
            middle = (np.array(instance.box_min[:2]) + np.array(instance.box_max[:2])) / 2.0
            view = View(
                house,
                kind,
                instance.name,
                stand.distance_to(*middle),
                float(share),
                False,
                0.0,
                "",
                0.0,
            )
            judge(view, box_of(mask), detections)
            album.keep(view, image.rgb, box_of(mask), detections)
            yield view
            left -= 1
            if left == 0:
                break


def table(views: list[View], houses: int) -> str:
    """Recall per kind, as Markdown."""
    lines = [
        "| kind | objects | views | recall | named instead |",
        "| --- | ---: | ---: | ---: | --- |",
    ]
    recalls = []
    for kind in KINDS:
        own = [v for v in views if v.kind == kind]
        if not own:
            lines.append(f"| {kind} | 0 | 0 | - | |")
            continue
        recall = sum(v.recognised for v in own) / len(own)
        recalls.append(recall)
        wrong = [
            v.said
            for v in own
            if not v.recognised and v.said and canonical(v.said) != canonical(kind)
        ]
        common = sorted(set(wrong), key=lambda w: (-wrong.count(w), w))[:3]
        objects = len({(v.house, v.name) for v in own})
        said = ", ".join(f"{w} {wrong.count(w)}" for w in common)
        lines.append(f"| {kind} | {objects} | {len(own)} | {recall:.2f} | {said} |")
    mean = sum(recalls) / max(len(recalls), 1)
    lines.append(
        f"| **mean of {len(recalls)} kinds, {houses} houses** | | {len(views)} | **{mean:.2f}** | |"
    )
    return "\n".join(lines)


def main(
    model: Path,
    first: int = 3000,
    count: int = 50,
    views_per_object: int = 3,
    scene: Path | None = None,
    album: Path | None = None,
    out: Path | None = None,
    kinds: Annotated[tuple[str, ...], tyro.conf.arg(help="only these, for tuning")] = (),
) -> None:
    """Measure recall over houses ``first`` to ``first + count - 1``, or in one scene file.

    Args:
        model: ONNX export of a YOLOX network.
        first: Number of the first house.
        count: Number of houses.
        views_per_object: Maximum number of views of one object.
        scene: A GLB to measure instead of houses.
        album: Folder of images of hits and misses.
        out: JSON file with all views.
        kinds: Kinds to measure; all eight if empty.
    """
    detector = YoloxDetector(model, OnnxDetectorConfig(score_threshold=LEAST_SCORE))
    images = Album(album)
    views: list[View] = []
    numbers = [0] if scene is not None else list(range(first, first + count))
    for number in numbers:
        one = read_scene(scene) if scene is not None else generate(house(number))
        if kinds:
            one = replace(
                one,
                instances=tuple(
                    i if kind_of(i) in kinds else replace(i, label=None) for i in one.instances
                ),
            )
        views += look_around(one, number, detector, views_per_object=views_per_object, album=images)
    print(table(views, len(numbers)))
    if out is not None:
        out.write_text(json.dumps([vars(v) for v in views], indent=1))


if __name__ == "__main__":
    tyro.cli(main)
