"""Protocols of the surface that a simulated robot stands on."""

from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Bool, Float64

from hypernav.core.world import Position, Walkable


@runtime_checkable
class PathField(Protocol):
    """Shortest paths to the nearest of a set of goals. Scene frame, metres."""

    def distance(self, x: float, y: float, z: float | None = None) -> float:
        """Geodesic distance; infinite if no path leads there."""
        ...

    def path(self, x: float, y: float, z: float | None = None) -> list[tuple[float, float]]:
        """The path over all bends to the nearest goal, seen from above; empty if there is none."""
        ...


@runtime_checkable
class WalkableSurface(Walkable, Protocol):
    """A surface to stand on, of one storey or several: a grid of cells, or a navigation mesh."""

    def is_on_storey(self, z: Float64[np.ndarray, "n"]) -> Bool[np.ndarray, "n"]:
        """Whether heights belong to a storey of this surface."""
        ...

    def floor_near(
        self, low: Position, high: Position, reach_m: float
    ) -> Float64[np.ndarray, "n 3"]:
        """Positions on the largest part, a few centimetres apart, around a box on its storey."""
        ...

    def goal_field(self, goals: Float64[np.ndarray, "n 3"]) -> PathField:
        """Shortest paths to the nearest of these positions; those off the surface don't count."""
        ...
