"""Depth images of boxes, computed by hand: no renderer, no scene, no mesh."""

from collections.abc import Sequence

import numpy as np

from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.observation import Observation

SolidBox = tuple[Sequence[float], Sequence[float]]
"""Lowest and highest corner, metres, ``map`` frame."""

CAMERA = PinholeCamera.from_hfov(320, 240, 79.0)
FLOOR: SolidBox = ((-30.0, -30.0, -1.0), (30.0, 30.0, 0.0))


def room(width: float, depth: float, *, height: float = 2.5) -> list[SolidBox]:
    """Floor, ceiling and four walls around (0, 0) to (width, depth)."""
    return [
        FLOOR,
        ((-30.0, -30.0, height), (30.0, 30.0, height + 0.1)),
        ((-0.2, -0.2, 0.0), (width + 0.2, 0.0, height)),
        ((-0.2, depth, 0.0), (width + 0.2, depth + 0.2, height)),
        ((-0.2, 0.0, 0.0), (0.0, depth, height)),
        ((width, 0.0, 0.0), (width + 0.2, depth, height)),
    ]


def view_of(
    boxes: Sequence[SolidBox],
    robot: Pose2,
    *,
    camera: PinholeCamera = CAMERA,
    height_m: float = 0.88,
    pitch_deg: float = 0.0,
    max_depth_m: float = 5.0,
) -> Observation:
    """What a robot sees of solid boxes; depth is 0 where nothing is within range."""
    camera_to_map = robot.to_transform() @ optical_to_base(height_m, pitch_deg)
    rays = np.moveaxis(camera.rays() @ camera_to_map.rotation.T, 2, 0)
    depth = np.full(rays.shape[1:], np.inf)
    at = camera_to_map.translation
    with np.errstate(divide="ignore", invalid="ignore"):
        for low, high in boxes:
            enter, leave = np.full((2, *depth.shape), np.nan)
            for axis, ray in enumerate(rays):  # fmax and fmin pass over the NaN of a side in line
                to_low, to_high = (low[axis] - at[axis]) / ray, (high[axis] - at[axis]) / ray
                np.fmax(enter, np.minimum(to_low, to_high), out=enter)
                np.fmin(leave, np.maximum(to_low, to_high), out=leave)
            hit = (enter <= leave) & (enter > 0.0) & (enter < depth)
            depth[hit] = enter[hit]
    depth[depth > max_depth_m] = 0.0
    return frame(depth.astype(np.float32), robot, camera, height_m, pitch_deg)


def frame(
    depth: np.ndarray,
    robot: Pose2,
    camera: PinholeCamera = CAMERA,
    height_m: float = 0.88,
    pitch_deg: float = 0.0,
) -> Observation:
    """An observation of this depth, with a black image."""
    return Observation(
        rgb=np.zeros((camera.height, camera.width, 3), np.uint8),
        depth=depth,
        camera=camera,
        camera_to_map=robot.to_transform() @ optical_to_base(height_m, pitch_deg),
        robot=robot,
    )


def turning(x: float, y: float, turns: int = 12) -> list[Pose2]:
    """Poses of a robot that turns around in place."""
    return [Pose2(x, y, 2.0 * np.pi * k / turns) for k in range(turns)]


def distance_to_boxes(
    points: np.ndarray, boxes: Sequence[SolidBox], low_m: float, high_m: float
) -> np.ndarray:
    """Distance, seen from above, of every ``(x, y)`` to the nearest box in a band of heights."""
    distance = np.full(len(points), np.inf)
    for low, high in boxes:
        if high[2] > low_m and low[2] < high_m:
            beside = np.maximum(np.array(low[:2]) - points, points - np.array(high[:2]))
            distance = np.minimum(distance, np.hypot(*np.maximum(beside, 0.0).T))
    return distance
