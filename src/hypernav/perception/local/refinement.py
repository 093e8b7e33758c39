"""Refinement of a mask to a goal area: erosion, projection and dilation."""

import cv2
import numpy as np
from jaxtyping import Bool

from hypernav.core.embodiment import CameraConfig
from hypernav.core.observation import Observation
from hypernav.mapping.memory.goal_area import GoalArea, points_under_mask
from hypernav.perception.local.config import LocalConfig

_MANY_PIXELS = 4000  # above it only every second pixel in both directions is used
_LEAST_LEFT = 0.25  # share of a mask below which it is too thin to be eroded
_STRAY_SHARE = 0.05
"""Share of the points below which a separate part of a guessed mask belongs to another thing."""


def eroded(
    mask: Bool[np.ndarray, "height width"], config: LocalConfig
) -> Bool[np.ndarray, "height width"]:
    """A mask without its edge (paper: "erode the segmentation area").

    Args:
        mask: Mask of the goal's pixels.
        config: Size of the kernel, and whether a mask of which little would be left stays as it is:
            a thin object would vanish, which is worse than some background.
    """
    kernel = np.ones((config.erosion_px, config.erosion_px), np.uint8)
    inner = cv2.erode(mask.astype(np.uint8), kernel).astype(bool)
    vanishes = np.count_nonzero(inner) < _LEAST_LEFT * np.count_nonzero(mask)
    return mask if vanishes and config.keep_thin_masks else inner


def projected(
    mask: Bool[np.ndarray, "height width"],
    observation: Observation,
    config: LocalConfig,
    camera: CameraConfig,
    *,
    cell_size_m: float,
    is_guessed: bool = False,
) -> GoalArea | None:
    """The goal area under a mask; None if too few of its pixels have a depth within the range.

    Args:
        mask: Mask of the goal's pixels, already eroded if it is to be.
        observation: Frame that the mask was made from.
        config: Least number of points, dilation and choice of the cluster.
        camera: Camera, whose range of depth counts.
        cell_size_m: Side of a map cell, metres.
        is_guessed: Whether the mask was guessed from a box, so that small parts may be strays.
    """
    points = points_under_mask(
        mask,
        observation,
        min_depth_m=camera.min_depth_m,
        max_depth_m=camera.max_depth_m,
        stride=2 if np.count_nonzero(mask) > _MANY_PIXELS else 1,
    )
    if len(points) < config.min_points:
        return None
    return GoalArea.from_points(
        points,
        resolution_m=cell_size_m,
        kernel=config.dilation_kernel,
        iterations=config.dilation_iterations,
        largest_cluster_only=config.largest_cluster_only,
        stray_share=_STRAY_SHARE if is_guessed else 0.0,
    )
