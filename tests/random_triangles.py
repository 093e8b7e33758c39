"""Triangles of random scenes: rough terrain, boxes, stairs and storeys. Habitat's frame."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Int32

SIDES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (1, 5, 7, 3), (0, 2, 6, 4))
"""Corners of a box's sides; bit 0 of a corner says high along x, bit 1 along y, bit 2 along z."""


class Triangles(NamedTuple):
    """A scene.

    Attributes:
        vertices: Positions, y up, metres.
        faces: Vertex numbers, counter-clockwise seen from outside.
    """

    vertices: Float32[np.ndarray, "v 3"]
    faces: Int32[np.ndarray, "t 3"]


def boxes(corners: list[tuple[np.ndarray, np.ndarray]]) -> Triangles:
    """Boxes, each given by its lowest and highest corner."""
    bits = np.array([[i & 1, i >> 1 & 1, i >> 2] for i in range(8)])
    halves = np.array([[side[0], side[k + 1], side[k]] for side in SIDES for k in (1, 2)])
    vertices = [np.where(bits, high, low) for low, high in corners]
    faces = [halves + 8 * k for k in range(len(corners))]
    return Triangles(
        np.concatenate(vertices).astype(np.float32), np.concatenate(faces).astype(np.int32)
    )


def terrain(rng: np.random.Generator, extent: np.ndarray) -> Triangles:
    """A surface of random heights over a rectangle that begins at the origin."""
    rows, columns = rng.integers(3, 9, 2)
    x, z = np.meshgrid(np.linspace(0, extent[0], columns), np.linspace(0, extent[1], rows))
    y = rng.uniform(0.0, rng.choice([0.0, 0.05, 0.4, 1.2]), x.shape)
    vertices = np.stack([x, y, z], axis=-1).reshape(-1, 3).astype(np.float32)
    i = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = (part.ravel() for part in (i[:-1, :-1], i[:-1, 1:], i[1:, :-1], i[1:, 1:]))
    faces = np.concatenate([np.stack([a, c, b], 1), np.stack([b, c, d], 1)])
    return Triangles(vertices, faces.astype(np.int32))


def random_scene(rng: np.random.Generator) -> Triangles:
    """Terrain with boxes, storeys and stairs on it.

    It extends three quarters of a column of 0.05 m beyond a whole one, so that nothing lies on the
    border of the last column, where versions of Recast differ.
    """
    columns = rng.integers(60, 200, 2)
    extent = (columns + 0.75) * 0.05
    ground = terrain(rng, extent)
    solids = []
    for _ in range(rng.integers(0, 12)):
        size = rng.uniform(0.05, [1.5, 1.2, 1.5]) * rng.choice([0.1, 1.0])
        low = rng.uniform(0.0, 1.0, 3) * ([extent[0], 1.0, extent[1]] - size * [1, 0, 1])
        solids.append((low, low + size))
    for storey in range(rng.integers(0, 3)):
        size = np.array([rng.uniform(1.0, extent[0]), 0.15, rng.uniform(1.0, extent[1])])
        corner = rng.uniform(0.0, 1.0, 2) * (extent - size[[0, 2]])
        low = np.array([corner[0], rng.uniform(0.6, 1.6) + 1.5 * storey, corner[1]])
        solids.append((low, low + size))
    if rng.random() < 0.5:
        width, rise = rng.uniform(0.5, 1.0), rng.uniform(0.1, 0.25)
        at = rng.uniform(0.0, 1.0, 2) * (extent - [2.5, width])
        for step in range(8):
            low = np.array([at[0] + 0.3 * step, 0.0, at[1]])
            solids.append((low, low + np.array([0.3, rise * (step + 1), width])))
    if not solids:
        return ground
    rest = boxes(solids)
    return Triangles(
        np.concatenate([ground.vertices, rest.vertices]),
        np.concatenate([ground.faces, rest.faces + np.int32(len(ground.vertices))]),
    )
