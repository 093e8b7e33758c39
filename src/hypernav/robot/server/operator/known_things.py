"""The remembered things, as the operator sees them and sends robots to them."""

import threading
from pathlib import Path

from hypernav.core.errors import MemoryFolderError, RequestRefusedError
from hypernav.mapping.stairs.floor_exits import routes
from hypernav.mapping.storage.memory_index import Index
from hypernav.mapping.storage.memory_reader import read_index
from hypernav.mapping.storage.memory_writer import INDEX_NAME
from hypernav.robot.server.searches import check_remembers_things, no_such_thing
from hypernav.robot.wire.requests import ThingName
from hypernav.robot.wire.waiting import RememberedThing


class KnownThings:
    """The things of a memory on disk, which is read again only when its index has changed.

    Any thread may ask it, and waits while another one reads.
    """

    def __init__(self, folder: Path | None) -> None:
        """Begin with nothing read.

        Args:
            folder: Folder of the memory; None if there is none.
        """
        self._folder = folder
        self._lock = threading.Lock()
        self._version: tuple[int, ...] | None = None
        self._read: list[RememberedThing] | str = []

    def all(self) -> list[RememberedThing]:
        """What the memory knew after the last search, without what is gone; none without one.

        Raises:
            RequestRefusedError: The memory can't be read.
        """
        if self._folder is None:
            return []
        with self._lock:
            version = _version_of(self._folder / INDEX_NAME)
            if version is None or version != self._version:
                self._read, self._version = _read(self._folder), version
            known = self._read
        if isinstance(known, str):
            raise RequestRefusedError(known, error="memory", status=503)
        return known

    def check(self, thing: ThingName) -> None:
        """Refuse to send a robot to a thing that is not known.

        Raises:
            RequestRefusedError: There is no memory, it can't be read, or has no such thing.
        """
        check_remembers_things(self._folder)
        if all(one.thing != thing for one in self.all()):
            raise no_such_thing(thing)


def _version_of(index: Path) -> tuple[int, ...] | None:
    """What changes whenever a file is written or made readable; None if there is none."""
    try:
        facts = index.stat()
    except OSError:
        return None
    return facts.st_ino, facts.st_size, facts.st_mtime_ns, facts.st_ctime_ns


def _read(folder: Path) -> list[RememberedThing] | str:
    """The things of a memory, or why it can't be read."""
    try:
        index = read_index(folder)
    except MemoryFolderError as error:
        return str(error)
    if index is None:
        return []
    climbs = index.robot.body.climbs_stairs
    stairs = [one.connector() for one in index.connectors] if climbs else []
    reached = routes(index.floor, {k: one for k, one in enumerate(stairs) if one.is_usable})
    known = [
        RememberedThing(
            thing=ThingName(floor=number + 1, number=one.number),
            label=one.label,
            position=one.position,
            chance=round(one.chance, 2),
            no_way="" if number in reached else _no_way(index),
        )
        for number, floor in enumerate(index.floors)
        for one in floor.all_things().known
        if not one.is_gone
    ]
    return sorted(known, key=lambda one: (one.label, -one.chance))


def _no_way(index: Index) -> str:
    """That there is no way from the floor on which the last search ended, for people."""
    return f"a robot on floor {index.floor + 1}, where the last search ended, has no way there"
