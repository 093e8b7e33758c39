"""Synthetic observations: a coloured thing in front of a wall; a key image of colours."""

import cv2
import numpy as np
from jaxtyping import Bool

from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.observation import LabelledPixels, Observation
from hypernav.search.memory.key_images import KeyImage

CAMERA = PinholeCamera.from_hfov(160, 120, 79.0)
THING = 3


def thing_pixels(observation: Observation) -> Bool[np.ndarray, "height width"]:
    """Which pixels show the thing."""
    assert observation.truth is not None
    return observation.truth.ids == THING


def thing_before_wall(
    *,
    thing_m: float = 2.0,
    wall_m: float = 4.0,
    box: tuple[int, int, int, int] = (60, 40, 100, 80),
    robot: Pose2 | None = None,
    label: ObjectLabel | None = None,
    with_truth: bool = True,
) -> Observation:
    """A red thing that fills a box of pixels, before a grey wall that fills the rest."""
    robot = robot or Pose2(0.0, 0.0, 0.0)
    depth = np.full((CAMERA.height, CAMERA.width), wall_m, dtype=np.float32)
    rgb = np.full((CAMERA.height, CAMERA.width, 3), 150, dtype=np.uint8)
    ids = np.full(depth.shape, 0, dtype=np.int32)
    x0, y0, x1, y1 = box
    depth[y0:y1, x0:x1] = thing_m
    rgb[y0:y1, x0:x1] = (200, 30, 30)
    ids[y0:y1, x0:x1] = THING
    labels = {THING: label or ObjectLabel("bed")}
    return Observation(
        rgb=rgb,
        depth=depth,
        camera=CAMERA,
        camera_to_map=robot.to_transform() @ optical_to_base(0.88),
        robot=robot,
        truth=LabelledPixels(ids, labels) if with_truth else None,
    )


def key_image(number: int, rgb: np.ndarray) -> KeyImage:
    """A key image of nothing but colours."""
    height, width, _ = rgb.shape
    camera = PinholeCamera.from_hfov(width, height, 79.0)
    _, jpeg = cv2.imencode(".jpg", rgb[..., ::-1])
    pose = Transform.identity()
    patches = np.array([number], np.int64)
    return KeyImage(number, 0, 1, jpeg.tobytes(), b"", camera, pose, Pose2(0.0, 0.0, 0.0), patches)
