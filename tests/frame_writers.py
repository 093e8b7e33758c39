"""Small recordings in files, drawn in a scene of two rooms."""

from pathlib import Path

import numpy as np
from PIL import Image
from scipy.spatial.transform import Rotation

from hypernav.core.geometry.transforms import Pose2, Transform
from small_worlds import two_rooms

POSES = [Pose2(2.0, 1.0, 0.3), Pose2(2.4, 1.2, 0.5), Pose2(2.8, 1.3, 0.8)]
_Y_UP = Transform(np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]), np.array([7.0, -3.0, 2.0]))
"""From the scene to a world with y up and its origin somewhere."""


def views():
    world = two_rooms()
    to_base = world.embodiment.camera.camera_to_base
    for pose in POSES:
        camera_to_scene = pose.to_transform() @ to_base
        yield world.view_from(camera_to_scene), _Y_UP @ camera_to_scene


def _save(folder: Path, stem: str, view, per_metre: float) -> None:
    Image.fromarray(view.rgb).save(folder / f"{stem}.color.png")
    depth = np.rint(view.depth * per_metre).astype(np.uint16)
    Image.fromarray(depth).save(folder / f"{stem}.depth.png")


def write_matched_frames(folder: Path) -> None:
    camera = two_rooms().embodiment.camera.intrinsics
    matrix = [[camera.fx, 0, camera.cx - 0.5], [0, camera.fy, camera.cy - 0.5], [0, 0, 1]]
    np.savetxt(folder / "camera-intrinsics.txt", matrix)
    for number, (view, pose) in enumerate(views()):
        _save(folder, f"frame-{number:06d}", view, 1000.0)
        np.savetxt(folder / f"frame-{number:06d}.pose.txt", pose.matrix)


def write_tum(folder: Path) -> None:
    camera = two_rooms().embodiment.camera.intrinsics
    numbers = [[camera.fx, camera.fy, camera.cx - 0.5, camera.cy - 0.5]]
    np.savetxt(folder / "camera.txt", numbers)
    lists = {"rgb": "# colour\n", "depth": "# depth\n", "groundtruth": "# poses\n"}
    for number, (view, pose) in enumerate(views()):
        _save(folder, str(number), view, 5000.0)
        lists["rgb"] += f"{number}.000 {number}.color.png\n"
        lists["depth"] += f"{number}.010 {number}.depth.png\n"
        where = [*pose.translation, *Rotation.from_matrix(pose.rotation).as_quat()]
        lists["groundtruth"] += f"{number}.005 {' '.join(map(str, where))}\n"
    for name, text in lists.items():
        (folder / f"{name}.txt").write_text(text)


def write_scannet(folder: Path) -> None:
    """Colour has twice the size of depth."""
    camera = two_rooms().embodiment.camera.intrinsics
    matrix = np.eye(4)
    matrix[[0, 1, 0, 1], [0, 1, 2, 2]] = camera.fx, camera.fy, camera.cx - 0.5, camera.cy - 0.5
    for name in ("color", "depth", "pose", "intrinsic"):
        (folder / name).mkdir()
    np.savetxt(folder / "intrinsic" / "intrinsic_depth.txt", matrix)
    for number, (view, pose) in enumerate(views()):
        large = view.rgb.repeat(2, axis=0).repeat(2, axis=1)
        Image.fromarray(large).save(folder / "color" / f"{number}.png")
        depth = np.rint(view.depth * 1000.0).astype(np.uint16)
        Image.fromarray(depth).save(folder / "depth" / f"{number}.png")
        np.savetxt(folder / "pose" / f"{number}.txt", pose.matrix)
