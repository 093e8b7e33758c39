"""Observations: all that an agent may know about one moment."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Float32, Float64, Int32, Int64, UInt8

from hypernav.core.errors import CameraError
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform, wrap_angle
from hypernav.core.naming.labels import ObjectLabel


@dataclass(frozen=True, eq=False)
class LabelledPixels:
    """Ground truth of an image, which a simulated world may add.

    Attributes:
        ids: Instance of every pixel, -1 where there is none.
        labels: Label of each instance; walls, floor and ceiling have none.
    """

    ids: Int32[np.ndarray, "height width"]
    labels: Mapping[int, ObjectLabel]


@dataclass(frozen=True, eq=False)
class Observation:
    """One RGB-D frame with camera model and poses.

    Attributes:
        rgb: Colour image.
        depth: Depth image, metres along the optical axis; 0 where there is no return.
        camera: Intrinsics of both images.
        camera_to_map: Pose of the camera, optical frame to ``map`` frame.
        robot: Pose of the robot's base in the ``map`` frame.
        truth: Labels of the pixels, in simulation only.
    """

    rgb: UInt8[np.ndarray, "height width 3"]
    depth: Float32[np.ndarray, "height width"]
    camera: PinholeCamera
    camera_to_map: Transform
    robot: Pose2
    truth: LabelledPixels | None = None

    def __post_init__(self) -> None:
        """Check that images and camera belong together."""
        size = (self.camera.height, self.camera.width)
        if self.rgb.shape[:2] != size or self.depth.shape != size:
            raise CameraError(
                f"camera, colour and depth must have the same size, got camera {size}, "
                f"colour {self.rgb.shape[:2]}, depth {self.depth.shape}"
            )

    @cached_property
    def farthest_m(self) -> Float32[np.ndarray, " width"]:
        """Largest depth in every column of the image, metres."""
        return self.depth.max(axis=0)

    def in_frame(self, map_to_other: Transform) -> "Observation":
        """The same observation with its poses in another upright frame.

        Args:
            map_to_other: The transform from the present frame to the other.
        """
        x, y, _ = map_to_other.apply(np.array([[self.robot.x, self.robot.y, 0.0]]))[0].tolist()
        yaw = wrap_angle(self.robot.yaw + map_to_other.yaw)
        moved = map_to_other @ self.camera_to_map
        return replace(self, camera_to_map=moved, robot=Pose2(x, y, yaw))

    def part(self, rows: slice, columns: slice) -> "Observation":
        """A rectangle of the image as an image of its own, with the camera that would take it.

        Args:
            rows: Its rows, from 0 on; those beyond the image are left out.
            columns: Its columns.
        """
        window = np.s_[rows, columns]
        depth, camera, truth = self.depth[window], self.camera, self.truth
        height, width = depth.shape
        return replace(
            self,
            rgb=self.rgb[window],
            depth=depth,
            camera=replace(
                camera,
                width=width,
                height=height,
                cx=camera.cx - columns.start,
                cy=camera.cy - rows.start,
            ),
            truth=None if truth is None else replace(truth, ids=truth.ids[window]),
        )

    def points_at(
        self, rows: Int64[np.ndarray, " n"], columns: Int64[np.ndarray, " n"]
    ) -> Float64[np.ndarray, "n 3"]:
        """Points that pixels show, ``map`` frame, metres; every pixel must have a depth."""
        points = self.camera.unproject_pixels(rows, columns, self.depth[rows, columns])
        return self.camera_to_map.apply(points)
