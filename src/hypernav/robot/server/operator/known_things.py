"""The remembered things, as the operator sees them and sends robots to them."""

from pathlib import Path

from hypernav.core.errors import MemoryFolderError, RequestRefusedError
from hypernav.mapping.memory.index import Index
from hypernav.mapping.memory.reading import read_index
from hypernav.mapping.memory.writing import INDEX_NAME
from hypernav.robot.server.searches import check_remembers_things
from hypernav.robot.wire.requests import ThingName
from hypernav.robot.wire.waiting import RememberedThing


class KnownThings:
    """The things of a memory on disk, which is read again only when its index has changed."""

    def __init__(self, folder: Path | None) -> None:
        """Begin with nothing read.

        Args:
            folder: Folder of the memory; None if there is none.
        """
        self._folder = folder
        self._version: tuple[int, ...] | None = None
        self._read: list[RememberedThing] | str = []

    def all(self) -> list[RememberedThing]:
        """What the memory knew after the last search, without what is gone; none without one.

        Raises:
            RequestRefusedError: The memory can't be read.
        """
        if self._folder is None:
            return []
        version = _version_of(self._folder / INDEX_NAME)
        if version is None or version != self._version:
            self._read, self._version = _read(self._folder), version
        if isinstance(self._read, str):
            raise RequestRefusedError(self._read, error="memory", status=503)
        return self._read

    def check(self, thing: ThingName) -> None:
        """Refuse to send a robot to a thing that it can't be sent to.

        Raises:
            RequestRefusedError: There is no memory, or the robot has no way there.
        """
        check_remembers_things(self._folder)
        for one in self.all():
            if one.thing == thing and one.no_way:
                raise RequestRefusedError(
                    f"no robot can be sent to the {one.label}: {one.no_way}",
                    error="memory",
                    status=409,
                )


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
    reached = _reached_floors(index)
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


def _reached_floors(index: Index) -> list[int]:
    """Numbers of the floor that the robot was on last, and of those that it can climb to."""
    reached = [index.floor]
    for floor in reached if index.robot.body.climbs_stairs else ():
        ways = [one.connector() for one in index.connectors if one.floor == floor]
        others = {one.other_floor for one in ways if one.is_usable}
        reached += sorted(one for one in others if one is not None and one not in reached)
    return reached


def _no_way(index: Index) -> str:
    """Why the robot can't go to a floor, for people."""
    if not index.robot.body.climbs_stairs:
        return f"the robot was on floor {index.floor + 1} last, and climbs no stairs"
    return f"the robot was on floor {index.floor + 1} last, and knows no stairs from there"
