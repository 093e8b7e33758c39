"""A memory on disk, open in one process: loaded once, saved now and then, whole at any time.

Files that belong to the memory are never changed: a save writes new ones, then replaces the index
in one step, and removes the old ones last. So a process that is killed leaves the memory as it was
saved last. ``map.yaml`` and ``map.pgm`` beside them are for other programs and are never read back.
"""

import hashlib
import time
from collections.abc import Callable
from contextlib import ExitStack
from datetime import datetime
from pathlib import Path

from hypernav.core.embodiment import Embodiment
from hypernav.core.errors import MemoryFolderError, MemoryStartError
from hypernav.core.geometry.transforms import Transform
from hypernav.core.goal import Goal
from hypernav.core.naming.words import megabytes
from hypernav.core.observation import Observation
from hypernav.io.folder_lock import folder_lock
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.memory.key_images import MOST_BYTES, KeyImages
from hypernav.search.memory.memory import Memory
from hypernav.search.memory.start.start_check import StartCheck
from hypernav.search.memory.store.memory_index import (
    MOST_KEPT,
    GoalRecord,
    Index,
    Place,
)
from hypernav.search.memory.store.memory_reader import (
    Contents,
    check_not_inside_another,
    check_usable,
    read_memory,
)
from hypernav.search.memory.store.memory_writer import Writer

SAVE_EVERY_S = 10.0
"""Least time between two saves during a search, seconds."""


class MemoryFolder:
    """A folder with the memory of one building, which one process at a time may use.

    Attributes:
        folder: The folder.
        memory: What is known of the building.
        place: Where it lies, if the building is simulated.
        history: The searches so far, the oldest first.
        left_out: One line about each part that is damaged and was left out. Its files stay as they
            are, as ``NAME.damaged`` from the first save on.
        most_bytes: Size that the folder may have, bytes.

    Examples:
        >>> with open_memory("home") as home:  # doctest: +SKIP
        ...     for step in find("bed", memory=home):
        ...         print(step.trace.reason)
    """

    def __init__(
        self,
        folder: Path,
        mapping: MappingConfig,
        embodiment: Embodiment,
        *,
        most_megabytes: float | None = None,
        patience_s: float = 0.0,
        to_read: bool = False,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Lock the folder and load what is in it; an empty one begins a memory.

        Args:
            folder: The folder; made if missing.
            mapping: Configuration of the maps.
            embodiment: The robot.
            most_megabytes: Size of the folder beyond which the key images that tell least are
                forgotten, from now on; None for the memory's own, at first `MOST_BYTES`.
            patience_s: Longest wait for another holder of the folder, seconds.
            to_read: Whether nothing is saved, so that the folder may be on a read-only file system.
            clock: Clock in seconds, for the time between two saves.

        Raises:
            RunFolderError: Another process uses it, or it can't be written.
            MemoryFolderError: It holds no memory, a broken one, or that of another robot; a file
                can't be read now; or it is empty and lies in the folder of another memory.
        """
        check_not_inside_another(folder)
        check_usable(folder, mapping, embodiment)  # before the lock, which leaves files
        self.folder: Path = folder
        most_bytes = None if most_megabytes is None else round(most_megabytes * 1e6)
        self._clock = clock
        with ExitStack() as opened:
            self._home = opened.enter_context(
                folder_lock(folder, option="--memory", patience_s=patience_s, to_read=to_read)
            )
            self._load(mapping, embodiment, most_bytes)
            self._open = opened.pop_all()

    def _load(self, mapping: MappingConfig, embodiment: Embodiment, most_bytes: int | None) -> None:
        """Begin with what is in the folder, within a size in bytes or, by default, its own."""
        contents = read_memory(self._home, mapping, embodiment, most_bytes=most_bytes)
        if contents is None:
            most = most_bytes or MOST_BYTES
            memory = Memory(mapping, embodiment, images=KeyImages(most))
            contents = Contents(memory, most_bytes=most)
        self.most_bytes: int = contents.most_bytes
        self.memory: Memory = contents.memory
        self.place: Place | None = contents.place
        self.history: list[GoalRecord] = list(contents.history)
        self.left_out: tuple[str, ...] = contents.left_out
        self._is_new = contents.index is None
        self._writer = Writer(self._home, contents.index, damaged=contents.damaged)
        self._saved_s = self._clock()
        self._is_searching = False
        self._start: StartCheck | None = None

    def __enter__(self) -> "MemoryFolder":
        """The opened memory."""
        return self

    def __exit__(self, *error: object) -> None:
        """Save what is under way, and let other processes use the folder."""
        self.close()

    def close(self) -> None:
        """Save what is under way, and let other processes use the folder."""
        try:
            if self._is_searching:
                self.end("interrupted", steps=self._frames)
        finally:
            self.leave()

    def leave(self) -> None:
        """Let other processes use the folder, without what the search under way has learned."""
        self._is_searching = False
        self._open.close()

    @property
    def _frames(self) -> int:
        """Number of frames that the search under way has taken in."""
        is_begun = self.memory.searches == self.history[-1].search
        return len(self.memory.track) if is_begun else 0

    def check_building(self, building: str) -> None:
        """Refuse a simulated building that the memory isn't of.

        Raises:
            MemoryFolderError: It is of another one, or of none that is simulated.
        """
        if self.place is None and not self._is_new:
            raise MemoryFolderError(
                f"{self.folder} is the memory of a robot, and {building} is simulated; name "
                "another folder for it"
            )
        if self.place is not None and self.place.building != building:
            raise MemoryFolderError(
                f"{self.folder} is the memory of {self.place.building}, and this is {building}; "
                "name another folder for it"
            )

    def begin(
        self,
        goal: Goal,
        observation: Observation,
        *,
        building: str = "",
        map_to_scene: Transform | None = None,
    ) -> Memory:
        """Begin a search where the robot stands.

        Args:
            goal: What to find.
            observation: First frame, in the ``map`` frame of the memory.
            building: Name of the simulated building; empty on a robot.
            map_to_scene: The ``map`` frame in it; None on a robot.

        Returns:
            The memory, for `Agent.reset`.

        Raises:
            MemoryFolderError: The memory is of another building.
            MemoryStartError: What the robot sees contradicts the map, or the height of the floor.
        """
        if map_to_scene is not None:
            self.check_building(building)
            self.place = self.place or Place.of(building, map_to_scene)
        else:
            check_is_of_robot(self.folder, self.place)
        self._start = None
        if not (self._is_new or self.memory.is_still_under_way(observation)):
            sure = map_to_scene is not None
            self._start = StartCheck(self.memory, observation, self.folder, trusts_height=sure)
        self.memory.begin_at(observation)
        self._is_new, self._is_searching = False, True
        self.history.append(
            GoalRecord(
                search=self.memory.searches + 1,
                goal=goal.text,
                began=datetime.now().astimezone().isoformat(timespec="seconds"),
            )
        )
        del self.history[:-MOST_KEPT]
        return self.memory

    def check(self, observation: Observation) -> None:
        """Compare a frame after the first with what was known at the start; before every step.

        Args:
            observation: The frame, in the ``map`` frame of the memory.

        Raises:
            MemoryStartError: What the search has seen so far contradicts the map. The search is
                over, and the memory is again what it was when it was saved last.
        """
        if self._start is None:
            return
        try:
            self._start.look(observation)
        except MemoryStartError:
            self._load(self.memory.mapping, self.memory.embodiment, self.most_bytes)
            raise
        if self._start.is_over:
            self._start = None

    def keep(self) -> None:
        """Save if the last save was long ago; called after every step.

        Nothing is saved as long as what is seen may yet contradict the map.

        Raises:
            OutputError: The disk is full, or the folder can't be written.
        """
        if self._start is None and self._clock() - self._saved_s >= SAVE_EVERY_S:
            self.save()

    def end(self, outcome: str, *, steps: int) -> None:
        """Note how the search ended, and save.

        A search without a step has taught nothing, and is not kept.

        Raises:
            OutputError: The disk is full, or the folder can't be written.
        """
        if not self._is_searching:
            return
        self._is_searching = False
        if steps == 0:
            self.history.pop()
            return
        floor = self.memory.floor
        refuted = [one.area.centre for one in floor.search.evidence.candidates if one.is_refuted]
        self.history[-1] = self.history[-1].model_copy(
            update={
                "outcome": outcome,
                "steps": steps,
                "end": floor.trajectory[-1] if floor.trajectory else None,
                "floor": self.memory.number,
                "refuted": tuple(refuted[:MOST_KEPT]),
            }
        )
        self.save()

    @property
    def forgotten_words(self) -> str:
        """How many key images were forgotten for want of room; empty if none was."""
        images = self.memory.images
        if images is None or images.forgotten == 0:
            return ""
        noun = "key image" if images.forgotten == 1 else "key images"
        limit = megabytes(self.most_bytes)
        return f"{images.forgotten} {noun} forgotten: the limit is {limit} (--memory-mb)"

    def forget_images(self) -> None:
        """Forget all key images, damaged ones too, with the next save."""
        self.memory.forget_images()
        self._writer.keeps_damaged_images = False

    def save(self, *, makes_room: bool = True) -> None:
        """Write everything to disk.

        Args:
            makes_room: Whether key images are forgotten beyond the size that the folder may have.

        Raises:
            OutputError: The disk is full, or the folder can't be written.
        """
        most_bytes = self.most_bytes if makes_room else None
        self._writer.write(self.memory, self.place, tuple(self.history), most_bytes=most_bytes)
        self._saved_s = self._clock()

    def check_is_of_robot(self) -> None:
        """Refuse a robot the memory of a simulated building.

        Raises:
            MemoryFolderError: It is of a simulated one.
        """
        check_is_of_robot(self.folder, self.place)

    @property
    def index(self) -> Index | None:
        """The index as it was saved last; None before the first save."""
        return self._writer.index

    @property
    def save_name(self) -> str:
        """What tells the last save from all others, of other memories too; empty before the first.

        It doesn't depend on the program's version.
        """
        if (index := self.index) is None:
            return ""
        states = [one.state.sha256 for one in index.floors]
        told = (index.saves, index.searches, [one.began for one in index.history], states)
        return hashlib.sha256(repr(told).encode()).hexdigest()


def check_is_of_robot(folder: Path, place: Place | None) -> None:
    """Refuse a robot the memory of a simulated building, whose frame is that of the simulation.

    Args:
        folder: The memory's folder, for the message.
        place: Where the memory lies in a simulated building; None if it is a robot's.

    Raises:
        MemoryFolderError: It is of a simulated one.
    """
    if place is not None:
        raise MemoryFolderError(
            f"{folder} is the memory of {place.building}, which is simulated; name "
            "another folder for a robot"
        )
