"""Configuration of the map."""

import math
from typing import Literal, NamedTuple

from pydantic import Field

from hypernav.core.config import RoomConfig
from hypernav.core.embodiment import BodyConfig
from hypernav.core.errors import ConfigError

MAX_LAYERS = 32
"""Number of voxel layers that fit into the bit mask that the map keeps for every cell."""
HIT_WEIGHT = 2
"""Evidence that a frame adds to a voxel that it hits."""
OCCUPIED_EVIDENCE = HIT_WEIGHT
"""Evidence of a voxel from which its cell is occupied: that of one hit, so that the robot avoids
an obstacle at once."""
MAX_EVIDENCE = 6
"""Upper bound of a voxel's evidence; it limits the frames that a removed object takes to
disappear."""
PASS_MARGIN_M, PASS_MARGIN_RATIO = 0.05, 0.01
"""Distance by which a measured surface must lie behind a voxel that was seen through, metres, and
its increase per metre of depth, since depth noise grows with depth."""
BUMP_PERSISTENCE = 30
"""Number of frames that must show the floor of a bumped cell before the bump is forgotten; a robot
often bumps into what its camera cannot see."""
UNEVEN_M, UNEVEN_SHARE = 0.05, 0.05
"""How far floor may seem lower than a step of the robot's before it is a drop: in metres, and as a
share of its depth, since a camera that points a little lower than is known lowers all floor."""
STAIRS_M = 0.45
"""Height above or below the floor, metres, to which stairs lead at least: three steps."""
CHUNK_CELLS = 128
"""Side of the chunks that the map grows by, so that it seldom has to be copied."""
MAX_SIDE_M = 500.0
"""Width of the map, metres, beyond which a pose is refused as wrong: no building is that large."""


class HeightBand(NamedTuple):
    """The heights at which obstacles hinder the robot.

    Attributes:
        bottom_m: Lower end of the band above the floor, metres.
        layers: Number of voxels on top of each other in the band.
    """

    bottom_m: float
    layers: int


def memory_of(cells: int, band: HeightBand) -> int:
    """Memory of this many cells of a map, bytes: one per voxel, and eight per cell."""
    return cells * (band.layers + 8)


class MappingConfig(RoomConfig):
    """Configuration of the map. Heights are above the floor that the robot stands on.

    The paper gives the order of work (depth to points, voxels, obstacles where a height band holds
    voxels, local maps merged into a global one) and no values: those here are ours, and so is the
    evidence that voxels gather.

    Attributes:
        cell_size_m: Side of a map cell, metres.
        voxel_height_m: Height of a voxel, metres; its sides are those of a cell.
        floor_noise_m: Height, metres, below which everything is floor. If the robot drives over
            higher edges (`BodyConfig.max_step_m`), the height band begins at that height instead:
            rugs and sills are floor.
        headroom_m: Top of the height band above the robot's height, metres; what is higher
            (ceilings, lamps, shelves) doesn't hinder it. Just below 0 by default, since the robot's
            height is rounded up already.
        min_points: Number of points in a voxel from which a frame hits it, so that single noisy
            pixels draw nothing.
        pass_weight: Evidence that a frame takes from a voxel that it sees through. With 0, what one
            frame draws stays (paper: local maps are merged).
        free_footprint: Whether the cells that the robot stands on become free.
        sees_drops: Whether cells without floor, as at the head of stairs, are obstacles for a robot
            that does not climb stairs, and unknown to one that does. So is the low part of a ramp
            down. The paper has none.
        frontier_min_size_m: Length of the shortest frontier, metres; shorter ones are noise, or too
            narrow for a robot.
        block_size_m: Side of a block, metres.
        block_min_area_m2: Reachable floor from which a square is a block, square metres.
        block_destination: Position in a block that the robot goes to: the reachable cell beside the
            middle of its largest "frontier", which may lie just outside it, or the one nearest to
            the "middle" of the block (paper: a free location within it).
    """

    cell_size_m: float = Field(default=0.05, ge=0.01, le=1.0)
    voxel_height_m: float = Field(default=0.05, ge=0.01, le=10.0)
    floor_noise_m: float = Field(default=0.05, ge=0.0, le=1.0)
    headroom_m: float = Field(default=-0.05, ge=-1.0, le=2.0)
    min_points: int = Field(default=2, ge=1, le=10_000)
    pass_weight: int = Field(default=1, ge=0, le=255)
    free_footprint: bool = True
    sees_drops: bool = True
    frontier_min_size_m: float = Field(default=0.5, ge=0.0, le=50.0)
    block_size_m: float = Field(default=2.0, ge=0.1, le=100.0)
    block_min_area_m2: float = Field(default=0.1, ge=0.0, le=10_000.0)
    block_destination: Literal["frontier", "middle"] = "frontier"

    def height_band(self, body: BodyConfig) -> HeightBand:
        """The heights between which obstacles hinder a robot.

        Raises:
            ConfigError: The band is empty, or holds more voxels than the map can keep.
        """
        bottom, top = max(body.max_step_m, self.floor_noise_m), body.height_m + self.headroom_m
        if bottom >= top:
            raise ConfigError(
                f"no obstacle hinders a robot whose height band goes from {bottom:g} m (the larger "
                f"of embodiment.body.max_step_m and mapping.floor_noise_m) to {top:g} m "
                "(embodiment.body.height_m and mapping.headroom_m); make the band higher"
            )
        layers = max(math.ceil((top - bottom) / self.voxel_height_m - 1e-6), 1)
        if layers > MAX_LAYERS:
            raise ConfigError(
                f"the height band from {bottom:g} to {top:g} m holds {layers} voxels, at most "
                f"{MAX_LAYERS} are possible; use a larger mapping.voxel_height_m"
            )
        return HeightBand(bottom, layers)
