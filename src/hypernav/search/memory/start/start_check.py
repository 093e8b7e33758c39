"""Whether a robot stands where its memory says, by what it sees at the start of a search."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float64, Int64

from hypernav.core.embodiment import Embodiment
from hypernav.core.errors import MemoryStartError
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.observation import Observation
from hypernav.search.mapping.inflation import inflate
from hypernav.search.mapping.top_down_map import TopDownMap
from hypernav.search.memory.floor import counted_from
from hypernav.search.memory.memory import Memory

_STRIDE = 8
_LOWEST_M = 0.2
"""Height above the floor from which points are of what stands there, metres."""
NEAR_M = 0.1
"""Distance from a remembered obstacle within which a point belongs to it, metres."""
_FAR_M = 0.25
"""Distance from all remembered obstacles beyond which a point contradicts the map, metres."""
_PATCH_M = 0.25
"""Side of a patch of the map, metres. What lies in one is seen or moved together, so it counts as
one observation, however many pixels the camera has."""
_MIDWAY = 0.45
"""Share of the patches in sight that contradict the map, midway between about 0.1 where the robot
stands right (seldom 0.4, where much has been moved) and about 0.8 where it stands elsewhere."""
_SURE = 0.75
"""Contradicting patches beyond that share from which on the robot stands elsewhere, ours."""
_SURE_AT_ONCE = 5.0
"""The same for a single image, which one moved cupboard may fill, ours."""
_PATCHES_IN_A_ROW = 1e6
"""More than any map has."""


@dataclass(frozen=True, eq=False)
class Fit:
    """How what frames show fits a map.

    Attributes:
        patches: Number of the patch in which each spot lies.
        contradicts: Whether an obstacle is seen there on remembered free floor, or a remembered
            wall is seen through, instead of an obstacle near a remembered one.
    """

    patches: Int64[np.ndarray, " n"]
    contradicts: Bool[np.ndarray, " n"]

    @property
    def counts(self) -> tuple[int, float]:
        """Number of patches, and how many contradict; one with spots of both kinds in part."""
        _, patch, spots = np.unique(self.patches, return_inverse=True, return_counts=True)
        shares = np.bincount(patch, self.contradicts, len(spots)) / spots
        return len(spots), float(shares.sum())

    @property
    def doubt(self) -> float:
        """How many patches contradict beyond the share that is midway between right and wrong."""
        patches, contradict = self.counts
        return contradict - _MIDWAY * patches

    def __add__(self, other: "Fit") -> "Fit":
        """How what both show fits; a patch that both show counts once."""
        return Fit(
            np.concatenate([self.patches, other.patches]),
            np.concatenate([self.contradicts, other.contradicts]),
        )


_NOTHING_SEEN = Fit(np.empty(0, np.int64), np.empty(0, bool))


class KnownFloor:
    """A floor as it is known at one moment, for comparisons with frames of later ones."""

    def __init__(self, map_: TopDownMap) -> None:
        """Copy what counts of a map.

        Args:
            map_: The map, which may change afterwards.
        """
        grid = map_.grid
        occupied, size = grid.occupied, grid.resolution_m
        self._robot: Embodiment = map_.embodiment
        band = map_.config.height_band(map_.embodiment.body)
        self._top_m = band.bottom_m + band.layers * map_.config.voxel_height_m
        self._obstacles = inflate(occupied, NEAR_M, size) > 0
        self._open = (inflate(occupied, _FAR_M, size) == 0) & (grid.cells == Cell.FREE)
        rows, columns = grid.cells.shape
        x, y = grid.origin
        corners = np.array([(x, y), (x + columns * size, y + rows * size)])
        self._walls: OccupancyGrid = map_.eye_level(corners, full_height=True)
        self._is_wall = self._walls.occupied

    def fit_of(self, observation: Observation) -> Fit:
        """How what a frame shows fits.

        In each column of the image the farthest obstacle counts: the wall, not the chair before it.
        It agrees near a remembered obstacle, and contradicts on free floor. Of what is seen through
        a remembered wall the wall contradicts, not all behind: one thing that is gone hid much.

        Args:
            observation: The frame, with heights counted from the ground.
        """
        ends = self._farthest(observation)
        seen_through = self._walls_before(observation.camera_to_map.translation[:2], ends)
        is_open = self._walls.picked(self._open, ends)
        tells = is_open | self._walls.picked(self._obstacles, ends)
        spots = np.concatenate([ends[tells], seen_through])
        x, y = np.floor(spots.T / max(_PATCH_M, self._walls.resolution_m))
        return Fit(
            (y * _PATCHES_IN_A_ROW + x).astype(np.int64),
            np.concatenate([is_open[tells], np.ones(len(seen_through), bool)]),
        )

    def _farthest(self, observation: Observation) -> Float64[np.ndarray, "n 2"]:
        """The farthest obstacles in the columns of a frame, ``(x, y)``, metres."""
        sensor = self._robot.camera
        depth = observation.depth[::_STRIDE, ::_STRIDE]
        rows, columns = np.nonzero(is_measured(depth, sensor.min_depth_m, sensor.max_depth_m))
        points = observation.points_at(rows * _STRIDE, columns * _STRIDE)
        stands = (points[:, 2] > _LOWEST_M) & (points[:, 2] < self._top_m)
        rows, columns, points = rows[stands], columns[stands], points[stands]
        nearest_first = np.lexsort((depth[rows, columns], columns))
        is_last = np.diff(columns[nearest_first], append=-1) != 0
        return points[nearest_first[is_last], :2]

    def _walls_before(
        self, camera: Float64[np.ndarray, "2"], ends: Float64[np.ndarray, "n 2"]
    ) -> Float64[np.ndarray, "m 2"]:
        """Points ``(x, y)``, metres, of remembered walls that lines of sight pass."""
        away = ends - camera
        length = np.linalg.norm(away, axis=1)[:, None]
        along = np.arange(0.0, length.max(initial=0.0), self._walls.resolution_m)
        points = camera + (away / np.maximum(length, 1e-6))[:, None] * along[:, None]
        points = points[along < length - _FAR_M]
        return points[self._walls.picked(self._is_wall, points)]


class StartCheck:
    """Compares the first frames of a search with what its memory knew when it began.

    A robot may begin where nothing is known, on a new floor too. But if what it sees there is what
    a known floor has at that position, then more likely the heights of its poses are wrong.

    What isn't known can't contradict, and one image may fit in many places. So after as many steps
    as a look around takes all frames are judged together. They are not judged before, since a moved
    thing may fill two or three images (`benchmarks/start_check.py`).
    """

    def __init__(
        self, memory: Memory, observation: Observation, folder: Path, *, trusts_height: bool
    ) -> None:
        """Begin with the first frame.

        Args:
            memory: The memory; it is not changed.
            observation: First frame, in its ``map`` frame.
            folder: Its folder, for the message.
            trusts_height: Whether the height is right, as in simulation. Many buildings have walls
                above walls: in three generated ones 66 % of 400 images fitted another floor, too.

        Raises:
            MemoryStartError: What the robot sees contradicts the map.
        """
        self._memory, self._folder = memory, folder
        self._number = memory.number_at(memory.height_of(observation))
        self._floor: KnownFloor | None = None
        self._fit = _NOTHING_SEEN
        self._frames = memory.embodiment.motion.turns_of_a_circle
        self._left = self._frames
        if self._number is not None:
            self._floor = KnownFloor(memory.floors[self._number].map)
            self.look(observation)
        elif not trusts_height:
            self._check_height(observation)

    @property
    def is_over(self) -> bool:
        """Whether no further frame needs to be looked at."""
        return self._floor is None or self._left == 0

    def look(self, observation: Observation) -> None:
        """Compare the next frame.

        Raises:
            MemoryStartError: It is the first one, or the last, and what the robot has seen so far
                contradicts the map.
        """
        if self._floor is None:
            return
        is_first = self._left == self._frames
        self._left -= 1
        z = self._memory.height_of(observation)
        if self._memory.number_at(z) == self._number:
            self._fit += self._floor.fit_of(counted_from(z, observation))
        bound = _SURE_AT_ONCE if is_first else _SURE if self.is_over else math.inf
        if self._fit.doubt >= bound:
            (x, y), (patches, contradict) = observation.robot.xy, self._fit.counts
            raise MemoryStartError(
                f"what the robot sees at ({x:.1f}, {y:.1f}) is not what {self._folder} remembers "
                f"there: {contradict:.0f} of the {patches} spots in sight contradict the map; "
                "check that this is the same building and that poses are in the memory's map "
                "frame, let --relocalize find where the robot is, or name another folder"
            )

    def _check_height(self, observation: Observation) -> None:
        """Refuse a height at which no floor is known, where one that is known fits.

        Raises:
            MemoryStartError: One does.
        """
        z, (x, y) = self._memory.height_of(observation), observation.robot.xy
        for floor in self._memory.floors:
            fit = KnownFloor(floor.map).fit_of(counted_from(z, observation))
            if fit.doubt <= -_SURE_AT_ONCE:
                patches, contradict = fit.counts
                raise MemoryStartError(
                    f"the robot's pose is {z:.1f} m high, where {self._folder} knows no floor, and "
                    f"{patches - contradict:.0f} of the {patches} spots in sight at "
                    f"({x:.1f}, {y:.1f}) fit the floor at {floor.z:.1f} m; check that heights are "
                    "in the memory's map frame, or let --relocalize find where the robot is. If it "
                    "really is on another floor, begin where that looks different, or name another "
                    "folder"
                )
