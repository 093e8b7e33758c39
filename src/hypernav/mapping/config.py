"""How the map is drawn."""

import math
from typing import NamedTuple

from pydantic import Field, model_validator

from hypernav.core.config import RoomConfig
from hypernav.core.embodiment import BodyConfig
from hypernav.core.errors import ConfigError

MAX_LAYERS = 32
"""Layers of voxels that fit into the bit mask that the map keeps for every cell."""


class HeightBand(NamedTuple):
    """Where things hinder the robot, seen from the side.

    Attributes:
        bottom_m: Height above the floor from which on things hinder it.
        layers: Voxels on top of each other in the band.
    """

    bottom_m: float
    layers: int


class MappingConfig(RoomConfig):
    """How the map is drawn. Heights are above the floor that the robot stands on.

    Attributes:
        cell_size_m: Side of a map cell.
        voxel_height_m: Height of a voxel; its sides are those of a cell.
        floor_noise_m: Things that are lower are floor, however little the robot drives over. Else
            the height band begins at the edge that it drives over (rugs and sills are floor).
        headroom_m: Top of the height band above the robot's height: things above (ceilings, lamps,
            shelves) don't hinder it. Just below 0, since that height is rounded up already.
        min_points: Points that a voxel needs in one frame to count as hit. Noisy single pixels
            don't draw.
        hit_weight: Evidence that a frame adds to a voxel that it hits.
        pass_weight: Evidence that a frame takes from a voxel that it sees through.
        occupied_evidence: A cell is occupied where a voxel's evidence reaches this. Up to
            `hit_weight`, one frame suffices.
        max_evidence: Upper bound; how many frames it takes to believe that a thing is gone.
        pass_margin_m: How far behind a voxel the measured surface must lie to see through it.
        pass_margin_ratio: Added to `pass_margin_m` per metre of depth, as depth noise grows.
        bump_persistence: Frames with a clear view of its floor before a bumped cell is believed
            free again; what the robot bumps into is often what its camera cannot see.
        chunk_cells: The map grows by multiples of this many cells.
        max_side_m: A pose that would make the map wider than this is refused as wrong.
        frontier_min_size_m: Shorter boundaries to the unknown are noise, or too narrow for a robot.
        block_size_m: Side of the numbered squares.
        block_min_area_m2: Squares with less reachable floor get no number.
    """

    cell_size_m: float = Field(default=0.05, gt=0.0)
    voxel_height_m: float = Field(default=0.05, gt=0.0)
    floor_noise_m: float = Field(default=0.05, ge=0.0, le=1.0)
    headroom_m: float = Field(default=-0.05, ge=-1.0, le=2.0)
    min_points: int = Field(default=2, ge=1)
    hit_weight: int = Field(default=2, ge=1, le=255)
    pass_weight: int = Field(default=1, ge=0, le=255)
    occupied_evidence: int = Field(default=2, ge=1, le=255)
    max_evidence: int = Field(default=6, ge=1, le=255)
    pass_margin_m: float = Field(default=0.05, ge=0.0)
    pass_margin_ratio: float = Field(default=0.01, ge=0.0)
    bump_persistence: int = Field(default=30, ge=1, le=255)
    chunk_cells: int = Field(default=128, ge=1)
    max_side_m: float = Field(default=500.0, gt=0.0)
    frontier_min_size_m: float = Field(default=0.5, ge=0.0)
    block_size_m: float = Field(default=2.0, gt=0.0)
    block_min_area_m2: float = Field(default=0.1, ge=0.0)

    @model_validator(mode="after")
    def _check_ranges(self) -> "MappingConfig":
        if self.occupied_evidence > self.max_evidence:
            raise ValueError(
                "occupied_evidence must not exceed max_evidence, got "
                f"{self.occupied_evidence} and {self.max_evidence}"
            )
        return self

    def height_band(self, body: BodyConfig) -> HeightBand:
        """The heights between which things hinder a robot.

        Raises:
            ConfigError: They leave no room, or more than the map can keep.
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
