"""How the map is drawn."""

import math

from pydantic import Field, model_validator

from hypernav.core.config import RoomConfig

MAX_LAYERS = 32
"""Layers of voxels that fit into the bit mask that the map keeps for every cell."""


class MappingConfig(RoomConfig):
    """How the map is drawn. Heights are above the floor that the robot stands on.

    Attributes:
        cell_size_m: Side of a map cell.
        voxel_height_m: Height of a voxel; its sides are those of a cell.
        obstacle_min_height_m: Bottom of the height band. Lower things (rugs, sills, the floor with
            its noise) are floor.
        obstacle_max_height_m: Top of the height band: the robot's height and a margin. Things above
            (ceilings, lamps, shelves) don't hinder the robot.
        min_depth_m: Depth up to here is no measurement (Habitat clamps to it).
        max_depth_m: Depth from here on is no measurement (saturated, clamped or too noisy).
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
        robot_radius_m: The robot's own footprint is free.
        chunk_cells: The map grows by multiples of this many cells.
        max_side_m: A pose that would make the map wider than this is refused as wrong.
        frontier_min_size_m: Shorter boundaries to the unknown are noise, or too narrow for a robot.
        block_size_m: Side of the numbered squares.
        block_min_area_m2: Squares with less reachable floor get no number.
        clearance_m: How far from obstacles a place must be to count as reachable, where the caller
            hands in no travel field of its planner.
        squeeze_m: Where nothing is left to explore at this clearance, what can be reached with so
            much less is explored too; 0 (paper) gives up instead.
    """

    cell_size_m: float = Field(default=0.05, gt=0.0)
    voxel_height_m: float = Field(default=0.05, gt=0.0)
    obstacle_min_height_m: float = Field(default=0.10, ge=0.0)
    obstacle_max_height_m: float = 0.95
    min_depth_m: float = Field(default=0.5, ge=0.0)
    max_depth_m: float = 5.0
    min_points: int = Field(default=2, ge=1)
    hit_weight: int = Field(default=2, ge=1, le=255)
    pass_weight: int = Field(default=1, ge=0, le=255)
    occupied_evidence: int = Field(default=2, ge=1, le=255)
    max_evidence: int = Field(default=6, ge=1, le=255)
    pass_margin_m: float = Field(default=0.05, ge=0.0)
    pass_margin_ratio: float = Field(default=0.01, ge=0.0)
    bump_persistence: int = Field(default=30, ge=1, le=255)
    robot_radius_m: float = Field(default=0.18, ge=0.0)
    chunk_cells: int = Field(default=128, ge=1)
    max_side_m: float = Field(default=500.0, gt=0.0)
    frontier_min_size_m: float = Field(default=0.5, ge=0.0)
    block_size_m: float = Field(default=2.0, gt=0.0)
    block_min_area_m2: float = Field(default=0.1, ge=0.0)
    clearance_m: float = Field(default=0.22, ge=0.0)
    squeeze_m: float = Field(default=0.04, ge=0.0)

    @model_validator(mode="after")
    def _check_ranges(self) -> "MappingConfig":
        if not self.obstacle_min_height_m < self.obstacle_max_height_m:
            raise ValueError(
                "obstacle_min_height_m must be less than obstacle_max_height_m, got "
                f"{self.obstacle_min_height_m} and {self.obstacle_max_height_m}"
            )
        if not self.min_depth_m < self.max_depth_m:
            raise ValueError(
                "min_depth_m must be less than max_depth_m, got "
                f"{self.min_depth_m} and {self.max_depth_m}"
            )
        if self.occupied_evidence > self.max_evidence:
            raise ValueError(
                "occupied_evidence must not exceed max_evidence, got "
                f"{self.occupied_evidence} and {self.max_evidence}"
            )
        if self.layers > MAX_LAYERS:
            raise ValueError(
                f"the height band holds {self.layers} voxels, at most {MAX_LAYERS} are possible; "
                "use a larger voxel_height_m"
            )
        return self

    @property
    def clearances(self) -> tuple["MappingConfig", ...]:
        """This configuration, and the one to explore with once it leaves nothing."""
        if self.squeeze_m <= 0.0:
            return (self,)
        tight_m = max(self.clearance_m - self.squeeze_m, 0.0)
        return (self, self.model_copy(update={"clearance_m": tight_m}))

    @property
    def layers(self) -> int:
        """Voxels on top of each other in the height band."""
        band = self.obstacle_max_height_m - self.obstacle_min_height_m
        return max(math.ceil(band / self.voxel_height_m - 1e-6), 1)
