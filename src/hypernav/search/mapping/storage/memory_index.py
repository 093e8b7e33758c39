"""The index of a memory on disk, ``memory.json``: what is in it, and which files belong to it."""

from typing import ClassVar, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from hypernav.core.embodiment import Embodiment
from hypernav.core.exploring.floors import SeenThing, Sightings
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.memory.key_images import KeyImage
from hypernav.search.mapping.memory.thing import Thing
from hypernav.search.mapping.memory.things import Things
from hypernav.search.mapping.stairs.connectors import Connector, Passage, UnderWay

FORMAT = "hypernav-memory"
VERSION = 1
"""Version of the format; increased whenever older programs can't read it."""

_MOST = 1_000_000_000
"""Largest number of an image or a save, for the names of files."""

Xy = tuple[float, float]
Xyz = tuple[float, float, float]


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

    name: str
    size: int = Field(ge=0)
    sha256: str


class ThingRecord(_Record):
    """A `Thing`, field by field."""

    number: int = Field(ge=0)
    label: str
    score: float
    low: Xyz
    high: Xyz
    views: tuple[Xyz, ...] = Field(min_length=1)
    pixels: float
    first_search: int
    last_search: int
    seen: int = Field(ge=1)
    missed: int = Field(ge=0)
    overlooked: int = Field(ge=0)
    image: int | None
    image_pixels: float
    refuted_in: int

    @staticmethod
    def of(thing: Thing) -> "ThingRecord":
        """The record of a thing."""
        return ThingRecord(**vars(thing))

    def thing(self) -> Thing:
        """The thing."""
        return Thing(**dict(self))


class SightingRecord(_Record):
    """A `SeenThing` of the explorers' questions."""

    label: str
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

    z: float
    state: FileRecord
    things: tuple[ThingRecord, ...]
    thing_count: int = Field(ge=0)
    sightings: tuple[SightingRecord, ...]
    named: tuple[int, ...]
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

    floor: int = Field(ge=0)
    goes_up: bool
    end: Xy
    axis: float
    passage: Passage
    other_floor: int | None = Field(ge=0)
    sightings: int = Field(ge=0)

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

    number: int = Field(ge=0, le=_MOST)
    floor: int = Field(ge=0)
    search: int
    jpeg: FileRecord
    png: FileRecord
    camera: tuple[int, int, float, float, float, float]
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

    building: str
    start: Xyz
    start_z: float

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

    connector: int = Field(ge=0)
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

    search: int
    goal: str
    began: str
    outcome: str = ""
    steps: int = 0
    end: Xy | None = None
    floor: int = 0
    refuted: tuple[Xy, ...] = ()


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
    saves: int = Field(ge=1, le=_MOST)
    robot: Embodiment
    mapping: MappingConfig
    place: Place | None
    searches: int = Field(ge=0)
    floor: int = Field(ge=0)
    floors: tuple[FloorRecord, ...] = Field(min_length=1)
    images: tuple[ImageRecord, ...]
    image_count: int = Field(ge=0)
    history: tuple[GoalRecord, ...]
    connectors: tuple[ConnectorRecord, ...] = ()
    under_way: UnderWayRecord | None = None
    most_bytes: int | None = Field(default=None, ge=1)

    @model_validator(mode="after")
    def _numbers_exist(self) -> "Index":
        named = [self.floor, *(one.floor for one in (*self.images, *self.connectors))]
        named += [one.other_floor for one in self.connectors if one.other_floor is not None]
        if max(named) >= len(self.floors):
            raise ValueError(f"floor {max(named)} is named, and there are {len(self.floors)}")
        if self.under_way is not None and self.under_way.connector >= len(self.connectors):
            raise ValueError(f"connector {self.under_way.connector} is named and does not exist")
        images = [one.number for one in self.images]
        if len(set(images)) < len(images) or max(images, default=-1) >= self.image_count:
            raise ValueError("the numbers of key images must differ and be below image_count")
        return self
