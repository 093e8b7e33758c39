"""What the page shows of one search: its map, its last image, and the robot's pose."""

import threading
from collections.abc import Iterator
from contextlib import closing, contextmanager

from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.robot.server.maps import extent_of
from hypernav.robot.server.state.journal import Journal
from hypernav.robot.wire.frames import PackedObservation, unpack_observation
from hypernav.robot.wire.replies import MapExtent


class Views:
    """Map, last image and last pose of a search. Thread-safe.

    They are in memory while the search goes on. After its end, map and image are read from the disk
    when they are asked for, because a server keeps many searches.

    Attributes:
        pose: Last pose of the robot ``(x, y, yaw)``, ``map`` frame; None before the first.
        extent: Where the map lies; None before the first decision.
    """

    def __init__(self, journal: Journal, last: PackedObservation | None) -> None:
        """Read what a journal holds.

        Args:
            journal: The journal.
            last: Its last observation; None before the first.

        Raises:
            HyPerNavError: It is damaged.
        """
        self.pose: tuple[float, float, float] | None = None
        self.extent: MapExtent | None = None
        self._journal = journal
        self._lock = threading.Lock()
        self._grid: OccupancyGrid | None = None
        self._colour: tuple[str, bytes] | None = None
        self._is_forgotten = False
        if last is not None:
            self.note_image(last)
        if journal.step_count > 0:
            trace = journal.step(journal.step_count - 1).trace
            self.pose = None if trace is None else trace.pose
        if journal.end is not None:
            self.note_map(journal.read_map())
            self.forget()

    @property
    def grid(self) -> OccupancyGrid | None:
        """Map after the last decision; None before the first.

        Raises:
            HyPerNavError: It is damaged on the disk.
        """
        with self._lock:
            grid, is_forgotten = self._grid, self._is_forgotten
        return self._journal.read_map() if grid is None and is_forgotten else grid

    @property
    def colour(self) -> tuple[str, bytes] | None:
        """Format and bytes of the last colour image; None before the first.

        Raises:
            HyPerNavError: It is damaged on the disk.
        """
        with self._lock:
            colour, is_forgotten = self._colour, self._is_forgotten
        return self.colour_of(None) if is_forgotten else colour

    def colour_of(self, sequence: int | None) -> tuple[str, bytes] | None:
        """Format and bytes of an observation's colour image; None before it has come.

        Args:
            sequence: Number of the observation; None is the last.

        Raises:
            HyPerNavError: It is damaged on the disk.
        """
        with self.reading() as journal:
            count = journal.observation_count
            sequence = count - 1 if sequence is None else sequence
            if not 0 <= sequence < count:
                return None
            packed = unpack_observation(journal.observation(sequence))
        return packed.header.colour.format, packed.colour

    @contextmanager
    def reading(self) -> Iterator[Journal]:
        """The journal, opened a second time, to read it during or after the search."""
        with closing(Journal(self._journal.folder, to_read=True)) as journal:
            yield journal

    def note_image(self, packed: PackedObservation) -> None:
        """Take the colour image of an observation that was accepted."""
        with self._lock:
            if not self._is_forgotten:
                self._colour = (packed.header.colour.format, packed.colour)

    def note_map(self, grid: OccupancyGrid | None) -> None:
        """Take the map after a decision."""
        with self._lock:
            if self._is_forgotten:  # the search ended meanwhile, and the disk has its map
                return
            self._grid = grid
            self.extent = None if grid is None else extent_of(grid)

    @property
    def unwritten_grid(self) -> OccupancyGrid | None:
        """The map, unless it is on disk already, or there is none yet."""
        with self._lock:
            return self._grid

    def forget(self) -> None:
        """Release map and image once they are on disk; a map that is not yet on disk is kept."""
        with self._lock:
            self._is_forgotten = True
            self._colour = None
            if self._journal.has_map:
                self._grid = None
