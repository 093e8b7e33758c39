"""The operator's page, and its paths: goals for robots that wait, and STOP for all.

The page needs no build step and loads nothing from other sites.
"""

import io
import json
import threading
from contextlib import ExitStack
from pathlib import Path
from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi import Path as PathParameter
from PIL import Image
from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException
from starlette.responses import Response

from hypernav.app.show.captions import MODES, QUESTIONS
from hypernav.app.show.templating import page_environment
from hypernav.core.embodiment import Action
from hypernav.core.errors import MemoryFolderError, RequestRefusedError
from hypernav.core.goal import Goal
from hypernav.robot.server.searches.searches import check_remembers_things, no_such_thing
from hypernav.robot.server.waiting_robots import WaitingRobots
from hypernav.robot.server.watching import STOP_BODY, Name, ShownSearches
from hypernav.robot.wire.replies import Status
from hypernav.robot.wire.requests import (
    LONGEST_WAIT_FOR_GOAL_S,
    ROBOT_NAME,
    ROBOTS,
    STOP_ALL,
    THINGS,
    GivenGoal,
    GoalRequest,
    RememberedThing,
    StopRequest,
    ThingName,
    WaitingRobot,
)
from hypernav.search.drawing import palette
from hypernav.search.memory.floor_exits import routes
from hypernav.search.memory.store.memory_index import Index
from hypernav.search.memory.store.memory_reader import read_image, read_index
from hypernav.search.memory.store.memory_writer import INDEX_NAME

_PICTURE_PX = 160
_LEAST_PX = 40.0
_AROUND = 1.6
"""Side of the picture of a thing, pixels, least side of what it shows of an image, and how much it
shows around the thing."""
_FOLDER = Path(__file__).parent / "page"
_KINDS = {".html": "text/html", ".css": "text/css", ".js": "text/javascript"}
_HEADERS = {
    "cache-control": "no-cache",
    "content-security-policy": (
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
        "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    ),
    "referrer-policy": "no-referrer",
    "x-content-type-options": "nosniff",
}
_ACTIONS = {
    Action.STOP: "stop",
    Action.MOVE_FORWARD: "forward",
    Action.TURN_LEFT: "turn left",
    Action.TURN_RIGHT: "turn right",
}


def page_files() -> dict[str, Response]:
    """Responses by file name; ``index.html`` is the page.

    Besides the files of the package there are ``style.css``, shared by all pages, and
    ``vocabulary.js``, the colours and words that page, video and map share.
    """
    texts = {path.name: path.read_text(encoding="utf-8") for path in _FOLDER.iterdir()}
    texts["style.css"] = page_environment().get_template("style.css.j2").render()
    texts["vocabulary.js"] = _vocabulary()
    return {
        name: Response(text, media_type=_KINDS[Path(name).suffix], headers=_HEADERS)
        for name, text in texts.items()
    }


def _vocabulary() -> str:
    """A JavaScript module of constants."""
    colors = {
        name.lower(): palette.css(color)
        for name, color in vars(palette).items()
        if name.isupper() and isinstance(color, tuple) and isinstance(color[0], int)
    }
    constants = {
        "COLORS": colors,
        "MODE_COLORS": {mode.value: palette.css(color) for mode, color in palette.MODES.items()},
        "MODES": {mode.value: words for mode, words in MODES.items()},
        "QUESTIONS": QUESTIONS,
        "ACTIONS": {int(action): words for action, words in _ACTIONS.items()},
    }
    return "".join(
        f"export const {name} = {json.dumps(value)};\n" for name, value in constants.items()
    )


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

    def image_of(self, thing: ThingName) -> bytes:
        """The part of a key image that shows a thing, JPEG.

        Raises:
            RequestRefusedError: There is no such thing or image, or it can't be read.
        """
        self.check(thing)
        assert self._folder is not None
        try:
            image = _image_of(self._folder, thing)
        except (ValueError, MemoryFolderError) as error:
            words = f"the image of the thing can't be read: {error}"
            raise RequestRefusedError(words, error="memory", status=503) from error
        if image is None:
            raise RequestRefusedError("no key image shows the thing", error="unknown", status=404)
        return image

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
    images = {one.number for one in index.images}
    known = [
        RememberedThing(
            thing=ThingName(floor=number + 1, number=one.number),
            label=one.label,
            position=one.position,
            chance=round(one.chance, 2),
            outline=(one.low[:2], one.high[:2]),
            has_image=one.image in images,
            no_way="" if number in reached else _no_way(index),
        )
        for number, floor in enumerate(index.floors)
        for one in floor.all_things().known
        if not one.is_gone
    ]
    return sorted(known, key=lambda one: (one.label, -one.chance))


def _image_of(folder: Path, name: ThingName) -> bytes | None:
    """The part of a key image that shows a thing, with its surroundings; None if none does.

    Raises:
        ValueError: Its file is missing or damaged.
        MemoryFolderError: The memory can't be read.
    """
    index = read_index(folder)
    floors = () if index is None else index.floors[name.floor - 1 : name.floor]
    thing = floors[0].all_things().find(name.number) if floors else None
    images = () if index is None else index.images
    record = next((one for one in images if thing and one.number == thing.image), None)
    if thing is None or record is None:
        return None
    image = read_image(folder, record)
    left, top, width, height = image.box_of(thing.low, thing.high) or (0.0, 0.0, 1.0, 1.0)
    side = max(width * image.camera.width, height * image.camera.height, _LEAST_PX) * _AROUND
    x = (left + width / 2.0) * image.camera.width
    y = (top + height / 2.0) * image.camera.height
    picture = Image.fromarray(image.rgb)
    edges = (
        round(max(x - side / 2.0, 0.0)),
        round(max(y - side / 2.0, 0.0)),
        round(min(x + side / 2.0, picture.width)),
        round(min(y + side / 2.0, picture.height)),
    )
    picture = picture.crop(edges)
    picture.thumbnail((_PICTURE_PX, _PICTURE_PX))
    file = io.BytesIO()
    picture.save(file, "JPEG", quality=80)
    return file.getvalue()


def _no_way(index: Index) -> str:
    """That there is no way from the floor on which the last search ended, for people."""
    return f"a robot on floor {index.floor + 1}, where the last search ended, has no way there"


_Name = Annotated[str, PathParameter(pattern=ROBOT_NAME, description="Name of the robot.")]


def operator_routes(
    searches: ShownSearches, waiting: WaitingRobots, memory: Path | None = None
) -> APIRouter:
    """The operator's paths.

    Args:
        searches: All searches.
        waiting: Robots that wait for a goal.
        memory: Folder of the memory; None if there is none.
    """
    routes = APIRouter()
    files, known = page_files(), KnownThings(memory)

    @routes.api_route("/", methods=["GET", "HEAD"], include_in_schema=False)
    async def page() -> Response:
        return files["index.html"]

    @routes.api_route("/page/{name}", methods=["GET", "HEAD"], include_in_schema=False)
    async def file(name: str) -> Response:
        if name not in files:
            raise HTTPException(404, "the page has no such file")
        return files[name]

    @routes.get(ROBOTS)
    async def robots() -> list[WaitingRobot]:
        """The robots that wait for a goal."""
        return waiting.all()

    @routes.post(f"{ROBOTS}/{{name}}/wait")
    async def wait(
        name: _Name,
        wait_s: Annotated[float, Query(ge=0.0, le=LONGEST_WAIT_FOR_GOAL_S)] = 0.0,
    ) -> GivenGoal:
        """For robots: wait for a goal; ask again if there is none."""
        return await waiting.wait(name, wait_s)

    @routes.post(f"{ROBOTS}/{{name}}/goal")
    async def give(name: _Name, request: GoalRequest) -> GivenGoal:
        """Give a goal to a robot that waits."""
        if request.thing is not None:
            await run_in_threadpool(known.check, request.thing)
        return waiting.give(name, Goal(request.goal), request.thing)

    @routes.get(THINGS)
    def things() -> list[RememberedThing]:
        """What the memory knew after the last search, without what is gone; none without one."""
        return known.all()

    @routes.get(f"{THINGS}/of/{{name}}")
    def things_of(name: Name) -> list[RememberedThing]:
        """The same for the map of a search; none if the search knows nothing of the memory."""
        return known.all() if searches.find(name).has_memory_frame else []

    @routes.get(f"{THINGS}/{{floor}}/{{number}}/image", response_class=Response)
    def image_of_thing(
        floor: Annotated[int, PathParameter(ge=1, le=1000)],
        number: Annotated[int, PathParameter(ge=0, le=10**9)],
    ) -> Response:
        """What a remembered thing looks like: the part of a key image around it."""
        content = known.image_of(ThingName(floor=floor, number=number))
        headers = {"cache-control": "no-store", "x-content-type-options": "nosniff"}
        return Response(content, media_type="image/jpeg", headers=headers)

    @routes.post(STOP_ALL, openapi_extra=STOP_BODY)
    async def stop_all(request: Request) -> list[Status]:
        """Stop every robot permanently, and withdraw goals that no robot has taken up yet."""
        waiting.withdraw_all()
        stopped = searches.stop_all(StopRequest.of(await request.body()).reason)
        with ExitStack() as ends:  # if one fails, the others are still written
            for search in stopped:
                ends.callback(search.write_end)
            await run_in_threadpool(ends.close)
        return [search.status() for search in stopped]

    return routes
