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
from hypernav.search.mapping.sight_lines import lines_are_clear
from hypernav.search.mapping.top_down_map import TopDownMap
from hypernav.search.memory.floor import counted_from
from hypernav.search.memory.memory import Memory

_STRIDE = 8
_LOWEST_M = 0.2
"""Height above the floor from which points are of what stands there, metres."""
_NEAR_M = 0.15
"""Distance from a remembered obstacle within which a point belongs to it, metres."""
_FAR_M = 0.35
"""Distance from all remembered obstacles beyond which a point contradicts the map, metres."""
_PATCH_M = 0.25
"""Side of a patch of the map, metres. What lies in one is seen or moved together, so it counts as
one observation, however many pixels the camera has."""
_CHANGED, _ELSEWHERE = 0.15, 0.7
"""Share of the patches in sight that contradict the map: where the robot stands right and much has
been moved (0.05 to 0.2 on average, by camera), and where it stands elsewhere (0.7 to 0.85)."""
_SURE = math.log(100.0)
"""Log-likelihood ratio from which on one of both is taken for true (Wald's sequential test, 1945):
at most one start in 100 with as many changes is refused."""
_SURE_AT_ONCE = math.log(1e6)
"""The same for a single image, ours, since its patches are not independent: a cupboard that was
moved may fill it."""
_PATCHES_IN_A_ROW = 1e6
"""More than any map has."""


@dataclass(frozen=True, eq=False)
class Fit:
    """How what frames show fits a map.

    Attributes:
        patches: Number of the patch in which each point lies.
        contradicts: Whether the point lies on remembered free floor, or behind remembered walls,
            instead of near a remembered obstacle.
    """

    patches: Int64[np.ndarray, " n"]
    contradicts: Bool[np.ndarray, " n"]

    @property
    def counts(self) -> tuple[int, float]:
        """Number of patches, and how many contradict; one with points of both kinds in part."""
        _, patch, points = np.unique(self.patches, return_inverse=True, return_counts=True)
        shares = np.bincount(patch, self.contradicts, len(points)) / points
        return len(points), float(shares.sum())

    @property
    def doubt(self) -> float:
        """Log-likelihood ratio of standing elsewhere to standing where the pose says."""
        patches, contradict = self.counts
        return contradict * math.log(_ELSEWHERE / _CHANGED) + (patches - contradict) * math.log(
            (1.0 - _ELSEWHERE) / (1.0 - _CHANGED)
        )

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
        self._obstacles = inflate(occupied, _NEAR_M, size) > 0
        self._open = (inflate(occupied, _FAR_M, size) == 0) & (grid.cells == Cell.FREE)
        rows, columns = grid.cells.shape
        x, y = grid.origin
        corners = np.array([(x, y), (x + columns * size, y + rows * size)])
        self._walls: OccupancyGrid = map_.eye_level(corners, full_height=True)

    def fit_of(self, observation: Observation) -> Fit:
        """How what a frame shows fits.

        Points near obstacles agree; points on free floor don't, nor do those behind walls.

        Args:
            observation: The frame, with heights counted from the ground.
        """
        points = self._points(observation)
        cells = self._walls.cells_of(points)
        inside = self._walls.contains(cells)
        points, (rows, columns) = points[inside], cells[inside].T
        is_behind = ~self._in_sight(observation.camera_to_map.translation[:2], points)
        contradicts = self._open[rows, columns] | is_behind
        tells = contradicts | self._obstacles[rows, columns]
        x, y = np.floor(points[tells].T / max(_PATCH_M, self._walls.resolution_m))
        return Fit((y * _PATCHES_IN_A_ROW + x).astype(np.int64), contradicts[tells])

    def _points(self, observation: Observation) -> Float64[np.ndarray, "n 2"]:
        """Points of obstacles in a frame, ``(x, y)``, metres."""
        sensor = self._robot.camera
        depth = observation.depth[::_STRIDE, ::_STRIDE]
        rows, columns = np.nonzero(is_measured(depth, sensor.min_depth_m, sensor.max_depth_m))
        points = observation.points_at(rows * _STRIDE, columns * _STRIDE)
        z = points[:, 2]
        return points[(z > _LOWEST_M) & (z < self._top_m), :2]

    def _in_sight(
        self, camera: Float64[np.ndarray, "2"], points: Float64[np.ndarray, "n 2"]
    ) -> Bool[np.ndarray, " n"]:
        """Which points have no remembered wall before them."""
        away = points - camera
        distance = np.linalg.norm(away, axis=1, keepdims=True)
        ends = camera + away * np.maximum(1.0 - _FAR_M / np.maximum(distance, 1e-6), 0.0)
        starts = np.broadcast_to(camera, ends.shape).copy()
        return lines_are_clear(self._walls, starts, ends, through=np.empty((0, 2)))


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
