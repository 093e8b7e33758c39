"""The tree in which Detour searches for polygons near a position, as built by ``createBVTree``."""

import numpy as np
from jaxtyping import UInt16

from hypernav.worlds.navmesh.files.file_format import TREE_NODE

MOST_STEPS = 0xFFFF
"""Largest coordinate of a box."""


def search_tree(low: UInt16[np.ndarray, "p 3"], high: UInt16[np.ndarray, "p 3"]) -> np.ndarray:
    """Nodes of the tree, parents first: records of type `file_format.TREE_NODE`.

    Args:
        low: Lowest corner of every polygon's box, in steps from the lowest corner of the mesh.
        high: Its highest corner.
    """
    nodes: list[tuple[np.ndarray, np.ndarray, int]] = []
    # Each entry is a run of polygons, or the number of a node whose descendants are complete.
    waiting: list[np.ndarray | int] = [np.arange(len(low))]
    while waiting:
        run = waiting.pop()
        if isinstance(run, int):
            box_low, box_high, _ = nodes[run]
            nodes[run] = (box_low, box_high, run - len(nodes))
            continue
        box_low, box_high = low[run].min(axis=0), high[run].max(axis=0)
        nodes.append((box_low, box_high, int(run[0])))
        if len(run) > 1:
            axis = int(np.argmax(box_high - box_low))
            ordered = run[np.argsort(low[run, axis], kind="stable")]
            half = len(run) // 2
            waiting += [len(nodes) - 1, ordered[half:], ordered[:half]]
    return np.array(nodes, dtype=TREE_NODE)
