"""The command `hypernav memory`: a page about what a robot remembers, and what to forget of it."""

import json
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from hypernav.app.build.memories.memory_page import memory_page
from hypernav.app.cli.guards.crashes import ExitStatus
from hypernav.app.cli.guards.outputs import check_file
from hypernav.app.cli.options.commands import MemoryOptions
from hypernav.app.cli.screen.terminal import Terminal
from hypernav.core.errors import ConfigError, MemoryFolderError, OutputError
from hypernav.core.naming.labels import canonical, same_name
from hypernav.core.naming.words import number_of
from hypernav.io.folder_lock import LOCK_NAME, folder_lock
from hypernav.io.writing import write_whole
from hypernav.search.memory.memory import Memory
from hypernav.search.memory.store.memory_folder import MemoryFolder
from hypernav.search.memory.store.memory_reader import read_index
from hypernav.search.memory.thing import Thing
from hypernav.search.memory.things import Things

PAGE_NAME = "index.html"


def run(options: MemoryOptions) -> int:
    """Run the command.

    Returns:
        The status of success.

    Raises:
        ConfigError: A name is empty or of nothing that is remembered, or export or page lie in the
            memory.
        MemoryFolderError: There is no memory, or it is broken.
        OutputError: Something can't be written.
        RunFolderError: A search is using the memory.
    """
    for option, file in (("--export", options.export), ("--page", options.page)):
        if file is not None:
            check_file(file)
            _check_outside(option, file, options.folder)
    if options.forget == ():
        raise ConfigError("--forget: name what to forget, such as --forget cup")
    index = read_index(options.folder)
    if index is None:
        _check_not_begun(options.folder)
        raise MemoryFolderError(
            f"there is no memory in {options.folder}; hypernav find GOAL --memory "
            f"{options.folder} begins one"
        )
    console = Terminal(stderr=False, soft_wrap=True)
    is_edited = bool(options.forget or options.forget_images)
    with MemoryFolder(options.folder, index.mapping, index.robot, to_read=not is_edited) as home:
        for line in home.left_out:
            console.print(line, markup=False)
        known = {one.label for floor in home.memory.floors for one in floor.things.known}
        for name in options.forget or ():
            if not any(same_name(label, name) for label in known):
                near = get_close_matches(name, sorted(known), n=1)
                hint = f"; did you mean '{near[0]}'?" if near else ""
                raise ConfigError(f"--forget: no '{name}' is remembered{hint}")
        done = list[str]()
        for name in {canonical(name): name for name in options.forget or ()}.values():
            labels = sorted(label for label in known if same_name(label, name))
            count = _forgotten(home.memory, name)
            done.append(f"{number_of(count, 'thing')} forgotten: {', '.join(labels)}")
        if options.forget_images:
            count = _image_count(home.memory)
            home.forget_images()
            done.append(f"{number_of(count, 'key image')} forgotten")
        elif options.forget:
            done.append("key images stay, also those that show them; --forget-images forgets all")
        if is_edited:
            home.save(makes_room=False)
        for line in done:
            console.print(line, markup=False)
        if options.export is not None:
            _write(options.export, json.dumps(geojson(home.memory), indent=1) + "\n")
        told = _written_page(options, memory_page(home))
        floors = home.memory.floors
        console.print(
            f"{number_of(len(home.history), 'search', 'searches')}, "
            f"{number_of(sum(len(one.things.known) for one in floors), 'thing')}, "
            f"{number_of(_image_count(home.memory), 'key image')}, "
            f"{number_of(len(floors), 'floor')}; {told}",
            markup=False,
        )
    return ExitStatus.SUCCESS


def _check_not_begun(folder: Path) -> None:
    """Refuse a folder to which a first search has not saved yet.

    Raises:
        RunFolderError: A search is using it.
    """
    if (folder / LOCK_NAME).exists():
        with folder_lock(folder, option="--memory"):
            pass


def geojson(memory: Memory) -> dict[str, Any]:
    """All things as GeoJSON polygons.

    Coordinates and heights are metres of the ``map`` frame, no degrees; of each thing ``floor_m``
    is the height of its floor there, and ``bottom_m`` and ``top_m`` are those of its box.
    """
    return {
        "type": "FeatureCollection",
        "features": [
            _feature(thing, number, floor.z)
            for number, floor in enumerate(memory.floors)
            for thing in floor.things.known
        ],
    }


def _feature(thing: Thing, floor: int, floor_m: float) -> dict[str, Any]:
    corners = thing.outline[1:]
    return {
        "type": "Feature",
        "geometry": {"type": "Polygon", "coordinates": [[*corners, corners[0]]]},
        "properties": {
            "label": thing.label,
            "chance": round(thing.chance, 3),
            "floor": floor + 1,
            "floor_m": floor_m,
            "bottom_m": floor_m + thing.low[2],
            "top_m": floor_m + thing.high[2],
            "seen": thing.seen,
            "missed": thing.missed,
            "last_search": thing.last_search,
        },
    }


def _forgotten(memory: Memory, name: str) -> int:
    """Forget the things of a name; returns their number."""
    number = 0
    for floor in memory.floors:
        kept = tuple(one for one in floor.things.known if not same_name(one.label, name))
        number += len(floor.things.known) - len(kept)
        floor.things = Things(kept, floor.things.count)
    return number


def _image_count(memory: Memory) -> int:
    return len(memory.images.kept) if memory.images else 0


def _written_page(options: MemoryOptions, text: str) -> str:
    """Write the page; returns what to do now.

    Raises:
        OutputError: It can't be written, and nothing else was asked for.
    """
    page = options.page or options.folder / PAGE_NAME
    try:
        _write(page, text)
    except OutputError as error:
        if options.page is not None:
            raise
        words = f"{error}; --page FILE writes it elsewhere"
        if options.export is None:
            raise OutputError(words) from error
        return f"no page: {words}"
    return f"open {page}"


def _check_outside(option: str, file: Path, folder: Path) -> None:
    """Refuse to write a file into the memory.

    Raises:
        ConfigError: It would be.
    """
    if folder.resolve() in file.resolve().parents:
        raise ConfigError(
            f"{option} {file} lies in the memory, whose files it could replace; name a file "
            "elsewhere"
        )


def _write(path: Path, text: str) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, text)
    except OSError as error:
        raise OutputError(
            f"{path} cannot be written ({error.strerror}); make that possible, and try again"
        ) from error
