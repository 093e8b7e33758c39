"""Surfaces that have to be seen from both sides in a simulator that draws only fronts."""

from dataclasses import replace

import numpy as np
from jaxtyping import Bool
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from hypernav.houses.assembly import CompactScene


def with_backs(house: CompactScene) -> CompactScene:
    """The same house, in which open surfaces, such as leaves, have a second face from behind.

    habitat-sim leaves out triangles that are seen from behind, also of materials that glTF calls
    double-sided, unless it draws with physically based shading.
    """
    behind = np.flatnonzero(_is_open(house))
    face = np.concatenate([np.arange(len(house.faces)), behind])
    faces = np.concatenate([house.faces, house.faces[behind][:, ::-1]])
    # The faces of an instance follow each other.
    order = np.argsort(house.face_instance[face], kind="stable")
    return replace(
        house,
        faces=faces[order],
        face_instance=house.face_instance[face[order]],
        face_material=house.face_material[face[order]],
    )


def _is_open(house: CompactScene) -> Bool[np.ndarray, " faces"]:
    """Whether each face is part of a surface with a border, which closes around nothing."""
    corners = np.column_stack(
        [house.positions[house.faces.ravel()], np.repeat(house.face_instance, 3)]
    )
    _, places = np.unique(corners, axis=0, return_inverse=True)
    places = places.reshape(-1, 3)
    edges = np.sort(np.stack([places, np.roll(places, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    _, number, uses = np.unique(edges, axis=0, return_inverse=True, return_counts=True)
    count = int(places.max()) + 1
    links = coo_array((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(count, count))
    _, part = connected_components(links, directed=False)
    open_parts = np.unique(part[edges[uses[number.ravel()] == 1, 0]])
    return np.isin(part[places[:, 0]], open_parts)
