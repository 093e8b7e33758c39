"""Ambient light: a grid of nodes, each lit from six sides.

A grid of nodes fills the scene. Each node holds the light that arrives from +x, -x, +y, -y, +z and
-z: a fixed set of rays is cast from the node, the open ones bring the light of a bright ceiling
above and of dimmer walls and floor, and an object nearby dims its direction (ambient occlusion). A
surface reads the eight nodes around the point just in front of it, so a table darkens the floor
under it and a corner darkens towards its edge. Nodes are computed when a camera first sees a
surface beside them and kept: a frame that shows nothing new costs nothing, and a node's value
depends only on its position, so the order of frames doesn't matter.
"""

import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from jaxtyping import Float32, Float64, Int64, UInt8

from hypernav.worlds.drawing.light_kernels import gather_light
from hypernav.worlds.scenes.scene import Scene

RAYS = 48
"""Directions in which a node looks for light."""
REACH_M = 2.0
"""Distance beyond which a hit does not block light."""
CONTRAST = 1.5
"""Exponent of the light; above 1 deepens the shade."""
_MAX_NODES = 8_000_000
_BATCH = 512
_STATE = 7

CastDistances = Callable[
    [Float32[np.ndarray, "rays 3"], Float32[np.ndarray, "rays 3"], float],
    Float32[np.ndarray, "rays"],
]
"""``(origins, directions, reach)`` to the distance of the first hit; negative or more if none."""


class LightGrid:
    """The nodes around a scene.

    Attributes:
        nodes: Bytes 0 to 5: light from +x, -x, +y, -y, +z, -z; byte 7: 1 where known.
        origin: Position of node (0, 0, 0), scene frame, metres.
        cell_m: Distance between nodes.
    """

    nodes: UInt8[np.ndarray, "z y x 8"]
    origin: Float64[np.ndarray, "3"]
    cell_m: float

    def __init__(
        self,
        low: Float64[np.ndarray, "3"],
        high: Float64[np.ndarray, "3"],
        cell_m: float,
        cast: CastDistances,
    ) -> None:
        """Cover a box with nodes; none is computed yet.

        Args:
            low: Lowest corner of the scene, metres.
            high: Highest corner.
            cell_m: Distance between nodes; grows for scenes that would need too many.
            cast: Function that measures distances in the scene.
        """
        self.origin, self.cell_m, shape = extent_of_grid(low, high, cell_m)
        self.nodes = np.zeros((*shape, 8), dtype=np.uint8)
        self._cast = cast
        self._directions = even_directions(RAYS)
        self._sky = sky_light(self._directions)

    def bake(self, cells: Int64[np.ndarray, "cells"], pool: ThreadPoolExecutor) -> None:
        """Compute the unknown ones of the eight nodes around each cell.

        Args:
            cells: Numbers of the cells' lowest nodes.
            pool: Thread pool that computes them.
        """
        _, rows, columns = self.nodes.shape[:3]
        corners = [z * rows * columns + y * columns + x for z, y, x in np.ndindex(2, 2, 2)]
        flat = self.nodes.reshape(-1, 8)
        numbers = np.unique(cells[:, None] + np.array(corners, dtype=np.int64))
        numbers = numbers[flat[numbers, _STATE] == 0]
        batches = [numbers[start : start + _BATCH] for start in range(0, len(numbers), _BATCH)]
        for batch, light in zip(batches, pool.map(self._light_at, batches), strict=True):
            flat[batch, :6] = light
            flat[batch, _STATE] = 1

    def _light_at(self, numbers: Int64[np.ndarray, "n"]) -> UInt8[np.ndarray, "n 6"]:
        z, y, x = np.unravel_index(numbers, self.nodes.shape[:3])
        positions = (np.stack([x, y, z], axis=1) * self.cell_m + self.origin).astype(np.float32)
        # All positions along one direction, then the next: neighbouring rays take similar paths.
        origins = np.tile(positions, (len(self._directions), 1))
        directions = np.repeat(self._directions, len(positions), axis=0)
        distances = self._cast(origins, directions, REACH_M)
        light = np.empty((len(positions), 6), dtype=np.uint8)
        shape = (len(self._directions), len(positions))
        gather_light(
            distances.reshape(shape), self._directions, self._sky, REACH_M, CONTRAST, light
        )
        return light


def box_of(scene: Scene) -> tuple[Float64[np.ndarray, "3"], Float64[np.ndarray, "3"]]:
    """Lowest and highest corner of a scene's triangles, metres."""
    used = np.zeros(len(scene.vertices), dtype=bool)
    used[scene.faces.ravel()] = True
    corners = scene.vertices[used].astype(np.float64)
    return corners.min(axis=0), corners.max(axis=0)


def extent_of_grid(
    low: Float64[np.ndarray, "3"], high: Float64[np.ndarray, "3"], cell_m: float
) -> tuple[Float64[np.ndarray, "3"], float, tuple[int, int, int]]:
    """Position of the first node, distance of the nodes, and their number along z, y and x.

    Args:
        low: Lowest corner of the scene, metres.
        high: Highest corner.
        cell_m: Distance between nodes; grows for scenes that would need too many.
    """
    margin = 3.0
    while np.prod((high - low) / cell_m + 2 * margin + 1) > _MAX_NODES:
        cell_m *= 1.25
    size = np.ceil((high - low) / cell_m + 2 * margin).astype(int) + 1
    return low - margin * cell_m, cell_m, (int(size[2]), int(size[1]), int(size[0]))


def even_directions(count: int) -> Float32[np.ndarray, "count 3"]:
    """Directions spread evenly over the sphere (Fibonacci lattice)."""
    index = np.arange(count) + 0.5
    z = 1.0 - 2.0 * index / count
    angle = index * math.pi * (3.0 - math.sqrt(5.0))
    across = np.sqrt(1.0 - z * z)
    return np.stack([across * np.cos(angle), across * np.sin(angle), z], axis=1).astype(np.float32)


def sky_light(directions: Float32[np.ndarray, "n 3"]) -> Float64[np.ndarray, "n"]:
    """Light from every direction of an empty room, at most 1.

    Brightest from above. A little brighter from one side, not parallel to the axes, so that the
    four sides of a box differ.
    """
    upward = directions[:, 2].astype(np.float64)
    sideways = directions[:, 0] * 0.8 + directions[:, 1] * 0.6
    return 0.66 + 0.22 * upward + 0.12 * sideways
