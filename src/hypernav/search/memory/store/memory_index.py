"""The index of a memory on disk, ``memory.json``: what is in it, and which files belong to it.

A memory may come from a stranger: every number, text and list has a bound, that of the writer.
"""

from collections import Counter
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal, TypeVar

import numpy as np
from pydantic import BaseModel, ConfigDict, FailFast, Field, model_validator
from pydantic_core import CoreSchema, core_schema

from hypernav.core.embodiment import Embodiment
from hypernav.core.exploring.floors import MOST_SIGHTINGS, SeenThing, Sightings
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.io.reading import MOST_BYTES
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.stairs.connectors import (
    MOST_CONNECTORS,
    Connector,
    Passage,
    UnderWay,
)
from hypernav.search.memory.key_images import KeyImage
from hypernav.search.memory.memory import MOST_FLOORS
from hypernav.search.memory.thing import MOST_VIEWS, Thing
from hypernav.search.memory.things import MOST_THINGS, Things

FORMAT = "hypernav-memory"
VERSION = 1
"""Version of the format; increased whenever older programs can't read it."""
OURS = r"^(images/[0-9]{6,10}\.(jpg|png)|floor-[0-9]{1,4}/state-[0-9]{1,10}\.npz)$"
"""Files of a memory besides its index."""

MOST_KEPT = 1000
"""Number of searches that the history keeps, and of refuted positions of each."""
MOST_IMAGES = 100_000
_MOST_COUNT = 1_000_000_000
_MOST_PIXELS = 1e8
MOST_METRES = 1e6


@dataclass(frozen=True)
class _Counted:
    """Bounds a count where it is read alone: a search counts on from there, and must not fail."""

    least: int

    def __get_pydantic_core_schema__(self, source: object, handler: object) -> CoreSchema:
        return core_schema.json_or_python_schema(
            core_schema.int_schema(ge=self.least, le=_MOST_COUNT),
            core_schema.int_schema(ge=self.least),
        )


Count = Annotated[int, _Counted(0)]
CountFromOne = Annotated[int, _Counted(1)]
Score = Annotated[float, Field(ge=0.0, le=1.0)]
Pixels = Annotated[float, Field(ge=0.0, le=_MOST_PIXELS)]
Metres = Annotated[float, Field(ge=-MOST_METRES, le=MOST_METRES)]
"""Also an angle in radians."""
Xy = tuple[Metres, Metres]
Xyz = tuple[Metres, Metres, Metres]
View = tuple[Metres, Metres, Score]
Label = Annotated[str, Field(max_length=32_768)]
Words = Annotated[str, Field(max_length=1000)]

_Item = TypeVar("_Item")
Items = Annotated[tuple[_Item, ...], FailFast()]


class _Record(BaseModel):
    """A part of the index; unknown keys are refused."""

    model_config: ClassVar[ConfigDict] = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False
    )


class FileRecord(_Record):
    """A file of the memory.

    Attributes:
        name: Its path in the folder, with ``/``.
        size: Its size, bytes.
        sha256: Hash of its content.
    """

    name: Annotated[str, Field(pattern=OURS, max_length=100)]
    size: int = Field(ge=0, le=MOST_BYTES)
    sha256: str = Field(pattern="^[0-9a-f]{64}$")


class ThingRecord(_Record):
    """A `Thing`, field by field."""

    number: Count
    label: Label
    score: Score
    low: Xyz
    high: Xyz
    views: Items[View] = Field(min_length=1, max_length=MOST_VIEWS)
    pixels: Pixels
    first_search: Count
    last_search: Count
    seen: CountFromOne
    missed: Count
    overlooked: Count
    image: Count | None
    image_pixels: Pixels
    refuted_in: Count

    @staticmethod
    def of(thing: Thing) -> "ThingRecord":
        """The record of a thing."""
        return ThingRecord(**vars(thing))

    def thing(self) -> Thing:
        """The thing."""
        return Thing(**dict(self))


class SightingRecord(_Record):
    """A `SeenThing` of the explorers' questions."""

    label: Label
    position: Xy


class FloorRecord(_Record):
    """A floor; map and trajectory are in the file of its state.

    Attributes:
        z: Its height in the ``map`` frame, metres.
        state: File of map, trajectory and patches of its key images.
        things: Its things.
        thing_count: Number of things so far.
        sightings: Things of the explorers' questions.
        named: Numbers of things that a detector has named.
        was_explored: Whether a search has explored it to its end; files from before this was kept
            don't tell.
    """

    z: Metres
    state: FileRecord
    things: Items[ThingRecord] = Field(max_length=MOST_THINGS)
    thing_count: Count
    sightings: Items[SightingRecord] = Field(max_length=MOST_SIGHTINGS)
    named: Items[Count] = Field(max_length=MOST_IMAGES)
    was_explored: bool = False

    def all_things(self) -> Things:
        """Its things."""
        return Things(tuple(one.thing() for one in self.things), self.thing_count)

    def all_sightings(self) -> Sightings:
        """Its sightings."""
        seen = tuple(SeenThing(one.label, one.position) for one in self.sightings)
        return Sightings(seen, frozenset(self.named))


class ConnectorRecord(_Record):
    """A `Connector`, field by field."""

    floor: Count
    goes_up: bool
    end: Xy
    axis: Metres
    passage: Passage
    other_floor: Count | None
    sightings: Count

    @staticmethod
    def of(connector: Connector) -> "ConnectorRecord":
        """The record of a connector."""
        return ConnectorRecord(**vars(connector))

    def connector(self) -> Connector:
        """The connector."""
        return Connector(**dict(self))


class ImageRecord(_Record):
    """A key image.

    Attributes:
        number: Its number.
        floor: Number of its floor.
        search: Number of the search that took it.
        jpeg: File of its colours.
        png: File of its depth, millimetres.
        camera: Width and height of the colours, pixels; fx, fy, cx, cy.
        rotation: Rotation of the camera, camera to map, row by row.
        position: Position of the camera, height above the floor, metres.
        robot: Pose ``(x, y, yaw)`` of the robot.
    """

    number: Count
    floor: Count
    search: Count
    jpeg: FileRecord
    png: FileRecord
    camera: tuple[Count, Count, Metres, Metres, Metres, Metres]
    rotation: tuple[Xyz, Xyz, Xyz]
    position: Xyz
    robot: Xyz

    @staticmethod
    def of(image: KeyImage, jpeg: FileRecord, png: FileRecord) -> "ImageRecord":
        """The record of an image whose files are written."""
        camera, pose = image.camera, image.camera_to_map
        first, second, third = (tuple(row) for row in pose.rotation.tolist())
        return ImageRecord(
            number=image.number,
            floor=image.floor,
            search=image.search,
            jpeg=jpeg,
            png=png,
            camera=(camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy),
            rotation=(first, second, third),
            position=tuple(pose.translation.tolist()),
            robot=(image.robot.x, image.robot.y, image.robot.yaw),
        )

    def image(self, jpeg: bytes, png: bytes, patches: np.ndarray) -> KeyImage:
        """The image."""
        width, height, fx, fy, cx, cy = self.camera
        return KeyImage(
            number=self.number,
            floor=self.floor,
            search=self.search,
            jpeg=jpeg,
            png=png,
            camera=PinholeCamera(width=width, height=height, fx=fx, fy=fy, cx=cx, cy=cy),
            camera_to_map=Transform(np.array(self.rotation), np.array(self.position)),
            robot=Pose2(*self.robot),
            patches=patches,
        )


class Place(_Record):
    """Where a memory of a simulated building lies in it.

    Attributes:
        building: Name of the building.
        start: Pose ``(x, y, yaw)`` in the scene at which the ``map`` frame begins.
        start_z: Height of the floor there, scene frame, metres.
    """

    building: Annotated[str, Field(max_length=4096)]
    start: Xyz
    start_z: Metres

    @staticmethod
    def of(building: str, map_to_scene: Transform) -> "Place":
        """The place of a building whose ``map`` frame is known."""
        x, y, z = map_to_scene.translation.tolist()
        return Place(building=building, start=(x, y, map_to_scene.yaw), start_z=z)

    @property
    def map_to_scene(self) -> Transform:
        """The transform from the ``map`` frame to the scene."""
        return Pose2(*self.start).to_transform(self.start_z)


class UnderWayRecord(_Record):
    """An `UnderWay`, field by field."""

    connector: Count
    position: Xyz

    @staticmethod
    def of(last: UnderWay | None) -> "UnderWayRecord | None":
        """The record of the path over a connector; None if there is none."""
        if last is None:
            return None
        return UnderWayRecord(connector=last.connector, position=last.position)

    def under_way(self) -> UnderWay:
        """The path over the connector."""
        return UnderWay(self.connector, self.position)


class GoalRecord(_Record):
    """One search in the history of a memory.

    Attributes:
        search: Its number.
        goal: What was looked for.
        began: When it began, ISO 8601 with time zone.
        outcome: How it ended; empty while it is under way, or after a crash.
        steps: Number of steps.
        end: Position ``(x, y)`` of the robot at the end, ``map`` frame, metres; None before.
        floor: Number of the floor there.
        refuted: Positions ``(x, y)`` on that floor of what looked like the goal and was not it.
    """

    search: Count
    goal: Words
    began: Words
    outcome: Words = ""
    steps: Count = 0
    end: Xy | None = None
    floor: Count = 0
    refuted: Items[Xy] = Field(default=(), max_length=MOST_KEPT)


class Index(_Record):
    """The whole index.

    Attributes:
        format: Name of the format.
        version: Version of the format.
        saves: Number of times that the memory was saved.
        robot: The robot that made the maps.
        mapping: Configuration of the maps.
        place: Where a simulated building's memory lies; None on a robot.
        searches: Number of searches so far.
        floor: Number of the floor that the robot was on.
        floors: The floors.
        images: The key images.
        image_count: Number of key images so far.
        history: The searches, the oldest first.
        connectors: The connectors between floors; files from before they were kept have none.
        under_way: The connector that the robot was on its way over; None if it was on none.
        most_bytes: Size that the folder may have, bytes; None in files from before it was kept.
    """

    format: Literal["hypernav-memory"] = FORMAT
    version: Literal[1] = VERSION
    saves: CountFromOne
    robot: Embodiment
    mapping: MappingConfig
    place: Place | None
    searches: Count
    floor: Count
    floors: Items[FloorRecord] = Field(min_length=1, max_length=MOST_FLOORS)
    images: Items[ImageRecord] = Field(max_length=MOST_IMAGES)
    image_count: Count
    history: Items[GoalRecord] = Field(max_length=MOST_KEPT)
    connectors: Items[ConnectorRecord] = Field(default=(), max_length=MOST_CONNECTORS)
    under_way: UnderWayRecord | None = None
    most_bytes: int | None = Field(default=None, ge=1, le=10**12)

    @model_validator(mode="after")
    def _numbers_exist(self) -> "Index":
        named = [self.floor, *(one.floor for one in (*self.images, *self.connectors))]
        named += [one.other_floor for one in self.connectors if one.other_floor is not None]
        if max(named) >= len(self.floors):
            raise ValueError(f"floor {max(named)} is named, and there are {len(self.floors)}")
        if self.under_way is not None and self.under_way.connector >= len(self.connectors):
            raise ValueError(f"connector {self.under_way.connector} is named and does not exist")
        files = Counter(one.state.name for one in self.floors)
        files.update(file.name for one in self.images for file in (one.jpeg, one.png))
        if len(files) < files.total():
            raise ValueError(f"{files.most_common(1)[0][0]} is named twice")
        images = [one.number for one in self.images]
        if len(set(images)) < len(images) or max(images, default=-1) >= self.image_count:
            raise ValueError("the numbers of key images must differ and be below image_count")
        return self
