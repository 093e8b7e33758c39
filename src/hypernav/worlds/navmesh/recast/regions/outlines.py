"""Outlines of regions, followed from edge to edge.

An edge is the side of a span in one direction: its number is four times the span's, and the
direction.
"""

import numpy as np
from jaxtyping import Bool, Int32

from hypernav.worlds.navmesh.recast.voxels.open_space import NOTHING, OpenSpace

_MOST_STEPS = 40_000


class Outlines:
    """The edges beyond which there is another region or none."""

    def __init__(self, space: OpenSpace, regions: Int32[np.ndarray, " s"]) -> None:
        """Find them.

        Args:
            space: Open space.
            regions: Region of every span; 0 for none, which has no edges.
        """
        beside = space.neighbours
        self.beyond: Int32[np.ndarray, "s 4"] = np.where(beside == NOTHING, 0, regions[beside])
        """Region beyond each side of every span."""
        self.is_edge: Bool[np.ndarray, "s 4"] = (self.beyond != regions[:, None]) & (
            regions[:, None] != 0
        )
        """Whether that is another one."""
        self._neighbours: list[int] = beside.ravel().tolist()
        self._edges: list[bool] = self.is_edge.ravel().tolist()

    def follow(self, first: int) -> list[int]:
        """The edges of an outline, from this one on."""
        found, edge = [], first
        for _ in range(_MOST_STEPS - 1):
            if self._edges[edge]:
                found.append(edge)
                edge = edge & ~3 | edge + 1 & 3
            else:
                edge = 4 * self._neighbours[edge] + (edge + 3 & 3)
            if edge == first:
                break
        return found
