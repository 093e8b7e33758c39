"""The tree in which Detour searches for polygons near a position, as ``createBVTree`` makes it."""

import numpy as np
from jaxtyping import Float32

from hypernav.worlds.navmesh.files.file_format import TREE_NODE
from hypernav.worlds.navmesh.files.polygon_mesh import PolygonMesh

_MOST_STEPS = 0xFFFF


def search_tree(
    mesh: PolygonMesh, vertices: Float32[np.ndarray, "v 3"], quantisation: np.float32
) -> np.ndarray:
    """Nodes of the tree, parents first: records of type `file_format.TREE_NODE`.

    Args:
        mesh: Polygons.
        vertices: Their corners in Habitat's frame, metres.
        quantisation: Steps of the boxes per metre.
    """
    steps = (vertices - vertices.min(axis=0)) * quantisation
    corners = np.where(mesh.polygons >= 0, mesh.polygons, mesh.polygons[:, :1])
    low = np.clip(np.floor(steps[corners].min(axis=1)), 0, _MOST_STEPS).astype(np.uint16)
    high = np.clip(np.ceil(steps[corners].max(axis=1)), 0, _MOST_STEPS).astype(np.uint16)
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
