r"""Keep what a network detects in views of training buildings, with the truth, for other scripts.

Every image is taken where a robot may stand, in a random direction. One file a view holds depth,
true instances, the pose of the camera in a map whose floor is at 0, and every detection with the
mask that the depth cut gives it.

    python benchmarks/detection_bank.py --model yolox_nano.onnx --out bank \
        --scenes houses:3000 offices:3000 shops:3000 SCENE.glb --images 50
"""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import tyro
from jaxtyping import Bool

from hypernav.app.build.data.scenes import load_scene
from hypernav.core.embodiment import CameraConfig
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.observation import LabelledPixels, Observation
from hypernav.search.models.config import OnnxDetectorConfig
from hypernav.search.models.yolox import YoloxDetector
from hypernav.search.perception.local.depth_cut import DepthCutSegmenter
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer
from hypernav.simulator.worlds.surface.walkable import WalkableGrid

LEAST_SCORE = 0.1
_MOST_DEPTH_M = 5.0


@dataclass(frozen=True, eq=False)
class KeptView:
    """One view of a bank.

    Attributes:
        scene: Name of the scene.
        observation: Depth within the sensor's range, camera, and true labels; the image is black.
        detections: All that the network reports, with masks.
    """

    scene: str
    observation: Observation
    detections: list[Detection]


def views_of(bank: Path) -> Iterator[KeptView]:
    """All views of a bank, scene by scene."""
    for labels_file in sorted(bank.glob("*/labels.json")):
        raw = json.loads(labels_file.read_text())
        labels = {
            int(number): ObjectLabel(one["category"], tuple(one["synonyms"]))
            for number, one in raw["labels"].items()
        }
        for file in sorted(labels_file.parent.glob("*.npz")):
            yield _read(file, raw["scene"], labels)


def _read(file: Path, scene: str, labels: dict[int, ObjectLabel]) -> KeptView:
    with np.load(file) as kept:
        depth = kept["depth_mm"].astype(np.float32) / np.float32(1000.0)
        pose = Transform(kept["rotation"], kept["translation"])
        masks = np.unpackbits(kept["masks"], axis=2, count=depth.shape[1]).astype(bool)
        detections = [
            Detection(Box(*box.tolist()), float(score), str(label), mask)
            for box, score, label, mask in zip(
                kept["boxes"], kept["scores"], kept["said"], masks, strict=True
            )
        ]
        truth = LabelledPixels(kept["ids"].astype(np.int32), labels)
    rgb = np.zeros((*depth.shape, 3), np.uint8)
    camera = CameraConfig().intrinsics
    return KeptView(
        scene, Observation(rgb, depth, camera, pose, Pose2(0.0, 0.0, 0.0), truth), detections
    )


def keep_scene(name: str, folder: Path, detector: YoloxDetector, images: int, seed: int) -> None:
    """Keep random views of one scene."""
    folder.mkdir(parents=True, exist_ok=True)
    rng, config, scene = np.random.default_rng(seed), CameraConfig(), load_scene(name)
    grid, renderer = WalkableGrid.from_scene(scene), CpuRenderer(scene)
    segmenter, camera = DepthCutSegmenter(), config.intrinsics
    labels = {one.id: one.label for one in scene.instances if one.label is not None}
    for number in range(images):
        x, y = grid.random_point(rng)
        pose = Pose2(x, y, float(rng.uniform(-np.pi, np.pi)))
        base = pose.to_transform(grid.height_at(x, y))
        view = renderer.render(camera, base @ config.camera_to_base)
        seen = Observation(
            view.rgb,
            np.where(view.depth <= _MOST_DEPTH_M, view.depth, np.float32(0.0)),
            camera,
            pose.to_transform(0.0) @ config.camera_to_base,
            pose,
        )
        detections = detector.detect_all(view.rgb)
        masks = [segmenter.segment(seen, one.box) for one in detections]
        _write(folder / f"{number:04d}.npz", camera, seen, view.instance_ids, detections, masks)
    renderer.close()
    named = {
        k: {"category": one.category, "synonyms": list(one.synonyms)} for k, one in labels.items()
    }
    (folder / "labels.json").write_text(json.dumps({"scene": scene.name, "labels": named}))


def _write(
    file: Path,
    camera: PinholeCamera,
    seen: Observation,
    ids: np.ndarray,
    detections: list[Detection],
    masks: list[Bool[np.ndarray, "height width"]],
) -> None:
    boxes = [(d.box.x_min, d.box.y_min, d.box.x_max, d.box.y_max) for d in detections]
    np.savez_compressed(
        file,
        depth_mm=np.rint(seen.depth * 1000.0).astype(np.uint16),
        ids=ids.astype(np.int16),
        rotation=seen.camera_to_map.rotation,
        translation=seen.camera_to_map.translation,
        boxes=np.array(boxes, dtype=np.float64).reshape(-1, 4),
        scores=np.array([one.score for one in detections]),
        said=np.array([one.label for one in detections], dtype=str),
        masks=np.packbits(
            np.array(masks, dtype=bool).reshape(-1, camera.height, camera.width), axis=2
        ),
    )


def main(
    model: Path,
    out: Path,
    scenes: Annotated[list[str], tyro.conf.arg(aliases=["-s"])],
    images: int = 50,
) -> None:
    """Keep views of scenes.

    Args:
        model: ONNX export of a YOLOX network.
        out: Folder of the bank.
        scenes: Names of scenes, or files.
        images: Number of images of each.
    """
    detector = YoloxDetector(model, OnnxDetectorConfig(score_threshold=LEAST_SCORE))
    for number, name in enumerate(scenes):
        keep_scene(name, out / f"{number:02d}", detector, images, number)
        print(f"{name}: {images} views", flush=True)


if __name__ == "__main__":
    tyro.cli(main)
