"""Islands of a navigation mesh, numbered (a numba kernel)."""

import numpy as np
from numba import njit


@njit(cache=True)
def label_islands(mesh):
    """Island of every polygon; an island connects walkable polygons."""
    count = len(mesh.corner_count)
    labels = np.full(count, -1, dtype=np.int32)
    waiting = np.empty(count, dtype=np.int32)
    islands = 0
    for seed in range(count):
        if labels[seed] >= 0:
            continue
        labels[seed] = islands
        waiting[0] = seed
        depth = 1
        while depth > 0:
            depth -= 1
            polygon = waiting[depth]
            for link in range(mesh.link_start[polygon], mesh.link_start[polygon + 1]):
                neighbour = mesh.link_polygon[link]
                if labels[neighbour] < 0 and mesh.walkable[neighbour]:
                    labels[neighbour] = islands
                    waiting[depth] = neighbour
                    depth += 1
        islands += 1
    return labels
