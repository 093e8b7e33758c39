"""Shortest paths over grids by SciPy, to compare with."""

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra


def cost_to_go(costs: np.ndarray, start: tuple[int, int]) -> np.ndarray:
    """Cost from a cell to every other, 8-connected, without cutting corners; 0 is closed."""
    rows, columns = costs.shape
    padded = np.zeros((rows + 2, columns + 2))
    padded[1:-1, 1:-1] = costs
    number = np.arange(padded.size).reshape(padded.shape)
    is_open = padded > 0
    sources, ends, weights = [], [], []
    for dr, dc in ((0, 1), (1, 0), (1, 1), (1, -1)):
        here = (slice(1, -1), slice(1, -1))
        there = (slice(1 + dr, rows + 1 + dr), slice(1 + dc, columns + 1 + dc))
        passable = is_open[here] & is_open[there]
        if dr and dc:
            passable &= is_open[slice(1 + dr, rows + 1 + dr), 1:-1]
            passable &= is_open[1:-1, slice(1 + dc, columns + 1 + dc)]
        sources.append(number[here][passable])
        ends.append(number[there][passable])
        weights.append(np.hypot(dr, dc) * (padded[here] + padded[there])[passable] / 2.0)
    graph = coo_matrix(
        (np.concatenate(weights), (np.concatenate(sources), np.concatenate(ends))),
        shape=(padded.size, padded.size),
    ).tocsr()
    distances = dijkstra(graph, directed=False, indices=number[start[0] + 1, start[1] + 1])
    return distances.reshape(padded.shape)[1:-1, 1:-1]
