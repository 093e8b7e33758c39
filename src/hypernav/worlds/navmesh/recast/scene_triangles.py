"""The triangles from which habitat-sim computes a scene's navigation mesh."""

import numpy as np
from jaxtyping import Float32

from hypernav.worlds.scenes.scene import Scene

_HALF_ANGLE = np.float32(0.70710683)
"""habitat-sim's sine and cosine of half a right angle: a rounding error above the true ones."""


def habitat_vertices(scene: Scene) -> Float32[np.ndarray, "v 3"]:
    """All vertices of a scene in Habitat's frame, metres, equal to habitat-sim's.

    A scan is stored z up. habitat-sim turns it by a matrix in single precision that is not exactly
    a rotation (``CoordinateFrame::rotationFrameToWorld``), which sometimes changes a voxel.
    """
    x, y, z = scene.vertices.T
    if not scene.stored_z_up:
        return np.ascontiguousarray(np.stack([x, z, -y], axis=1))
    turned = np.float32(2.0) * (_HALF_ANGLE * _HALF_ANGLE)
    left = np.float32(1.0) - turned
    return np.ascontiguousarray(
        np.stack([x, left * y + turned * z, -turned * y + left * z], axis=1)
    )
