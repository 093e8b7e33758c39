"""What a robot knows of a building, floor by floor.

A map is a plane: its floor is ``z = 0``. On which floor the robot is, its `Footing` tells.
"""

import copy
import math
from dataclasses import replace

import numpy as np
from jaxtyping import Float64

from hypernav.core.embodiment import Embodiment
from hypernav.core.errors import MapError
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.observation import Observation
from hypernav.search.mapping.config import UNEVEN_M, MappingConfig
from hypernav.search.mapping.elevation_map import ElevationMap, Ground
from hypernav.search.mapping.stairs.connectors import (
    Connector,
    Passage,
    UnderWay,
    relied_on,
    with_crossing,
    with_sightings,
)
from hypernav.search.mapping.stairs.footing import ANOTHER_M, Footing
from hypernav.search.mapping.stairs.seen_connectors import connectors_in, reliable, without_sides
from hypernav.search.mapping.top_down_map import TopDownMap
from hypernav.search.memory.floor import Floor, SearchMemory, counted_from
from hypernav.search.memory.key_images import KeyImages

MOST_FLOORS = 200
"""Number of floors of a building."""


class Memory:
    """All that a robot knows of a building: given to an agent, changed by it, and kept after it.

    It holds values and arrays, and no component, so that it can be copied.

    Attributes:
        floors: Floors in the order in which the robot came to know them; the first is the floor of
            the first start, whose height is 0 unless the robot's frame begins elsewhere.
        number: Number of the floor that the robot is on: its index in `floors`.
        mapping: Cells, evidence and height band of the maps.
        embodiment: The robot; the height of its camera tells that of the floor.
        searches: Number of searches that have begun with it.
        images: Key images; None if none are kept.
        connectors: Connectors between floors, seen from both ends; a number is an index.
        elevation: Heights of the ground around the robot; None if it looks for no stairs.
        track: Positions ``(x, y)`` of the robot in the present search, stairs included, metres.
        footing: What the robot stands on.
        under_way: The connector that the robot is on its way over, for a search that begins there;
            None if it is on no path over one.
    """

    def __init__(
        self,
        mapping: MappingConfig,
        embodiment: Embodiment,
        *,
        images: KeyImages | None = None,
    ) -> None:
        """Begin on a floor of which nothing is known.

        Args:
            mapping: Cells, evidence and height band of the maps.
            embodiment: The robot; the height of its camera tells that of the floor.
            images: Where to keep key images; None keeps none.
        """
        self.mapping: MappingConfig = mapping
        self.embodiment: Embodiment = embodiment
        self.images: KeyImages | None = images
        self.searches: int = 0
        self.floors: list[Floor] = []
        self.floors.append(self._new_floor(0.0))
        self.number: int = 0
        self.connectors: tuple[Connector, ...] = ()
        self.elevation: ElevationMap | None = None
        self.track: list[tuple[float, float]] = []
        self.footing: Footing = Footing.on_level_ground(Pose2(0.0, 0.0, 0.0), 0.0, 0.0)
        self.under_way: UnderWay | None = None

    @property
    def floor(self) -> Floor:
        """The floor that the robot is on."""
        return self.floors[self.number]

    @property
    def search(self) -> SearchMemory:
        """What the present search has learned on this floor."""
        return self.floor.search

    def begin_search(self, *, lasts: bool = False, sees_stairs: bool = False) -> None:
        """Keep floors, maps and things seen; forget what the search for another goal learned.

        Args:
            lasts: Whether later searches are to know what this one sees: its things and key images.
            sees_stairs: Whether connectors are looked for, if the robot can climb stairs.
        """
        self.searches += 1
        self.track.clear()
        if not (sees_stairs and self.embodiment.body.climbs_stairs):
            self.elevation = None
            if self.under_way is not None:
                self.under_way = None
                self.settle(self.footing.began)
        elif self.elevation is None:
            self.elevation = ElevationMap(self.embodiment, self.mapping.cell_size_m)
        for floor in self.floors:
            floor.begin_search(self.searches, lasts=lasts)

    def go_first_to(self, floor: int, thing: int) -> None:
        """Let the search that has begun go to one remembered thing before all others.

        Args:
            floor: Number of its floor.
            thing: Its number on that floor. One that is not remembered any more changes nothing.
        """
        if floor < len(self.floors):
            known = self.floors[floor]
            before = known.things.known_before(self.searches)
            known.search.meant = before.find(thing) or known.search.meant

    def copy(self) -> "Memory":
        """A copy that shares nothing that changes."""
        return copy.deepcopy(self)

    def follow(self, observation: Observation) -> Floor:
        """Note the robot's height, in every step; return the floor that the robot is on now."""
        z, here = self.height_of(observation), observation.robot.xy
        if not (self.track or self.is_still_under_way(observation)):
            self.under_way = None
        moved_m = math.dist(self.track[-1], here) if self.track else 0.0
        self.track.append(here)
        shows_steps = self.elevation is not None and self.elevation.integrate(
            observation, on_stairs=self.on_stairs
        )
        footing = self.footing.after(observation.robot, z, moved_m)
        if footing.may_be_another_floor and (
            self.elevation is None or footing.has_room(self.ground_around(here, down=False))
        ):
            self.number = self._known_or_new(z)
        self.footing = footing.on_floor(self.floor.z)
        if self.elevation is not None and shows_steps and not self.on_stairs:
            ground, level_z = self.ground_around(here, down=True), self.elevation.ground_z
            seen = connectors_in(ground, self.number, level_z)
            seen = reliable(seen, self.connectors, here, ground, level_z)
            known = with_sightings(self.connectors, seen)
            grid = self.floor.map.grid
            self.connectors = without_sides(known, self.number, ground, level_z, grid)
        return self.floor

    def begin_at(self, observation: Observation) -> Floor:
        """The floor that the first frame is taken on; a search with a memory on disk begins there.

        The first one of all makes it the first floor, however high it is in a given ``map`` frame.
        A robot that has stayed where the last search ended on stairs is still on the floor that
        they begin on.
        """
        z, robot = self.height_of(observation), observation.robot
        if self.under_way is not None and self.is_still_under_way(observation):
            self.number = self.connectors[self.under_way.connector].floor
            self.footing = Footing.on_stairs(robot, z, self.floor.z)
        else:
            if self.searches == 0 and self.number_at(z) is None:
                self.floors = [self._new_floor(z)]
            self.number = self._known_or_new(z)
            self.footing = Footing.on_level_ground(robot, z, self.floor.z)
        return self.floor

    def is_still_under_way(self, observation: Observation) -> bool:
        """Whether a search begins with this frame where the last one has ended on stairs."""
        position = (*observation.robot.xy, self.height_of(observation))
        return self.under_way is not None and self.under_way.is_at(position)

    def set_current_connector(self, number: int | None) -> None:
        """Note the connector that the robot is on its way over, in every step; None for none."""
        at = None if number is None else UnderWay(number, (*self.track[-1], self.footing.z))
        self.under_way = at

    def settle(self, robot: Pose2) -> None:
        """Take what the robot stands on for its ground, where it has given up to climb.

        From there it sees at least the path back; on stairs nothing is drawn or looked for.
        """
        self.footing = Footing.on_level_ground(robot, self.footing.z, self.floor.z)

    @property
    def ground_m(self) -> float:
        """Height above its floor of the ground that the robot walked on last, metres.

        It is not 0 on another level of a split floor.
        """
        return self.footing.ground_z - self.floor.z

    def height_of(self, observation: Observation) -> float:
        """Height of the robot in a frame, ``map`` frame, metres."""
        return self.embodiment.camera.base_z(observation.camera_to_map)

    def seen_from_ground(self, observation: Observation) -> Observation:
        """The same observation with heights counted from the ground that the robot walked on."""
        return counted_from(self.footing.ground_z, observation)

    def keep_image(self, observation: Observation) -> None:
        """Keep a frame as key image if it tells enough, and if key images are kept.

        Of a view that is not new, only things that are asked for can tell enough. On stairs none is
        kept: they belong to no floor from which heights could be counted. From another level of a
        floor they are counted from the floor, too.

        Args:
            observation: The latest frame, with heights counted from the ground.
        """
        floor = self.floor
        if self.images is None or self.on_stairs:
            return
        shows_new_thing = floor.things.wants_image
        if not (shows_new_thing or floor.search.has_new_view):
            return
        image = self.images.take(
            counted_from(-self.ground_m, observation),
            self.embodiment.camera,
            floor=self.number,
            search=self.searches,
            shows_new_thing=shows_new_thing,
        )
        if image is not None:
            floor.things = floor.things.with_image(image.number)
            self.make_room(self.images.most_bytes)

    def make_room(self, most_bytes: int) -> None:
        """Forget the key images that tell least, until all take at most so many bytes."""
        if self.images is not None:
            self.images.forgotten += self.forget_images(most_bytes)

    def forget_images(self, most_bytes: int = 0) -> int:
        """Forget key images as `make_room` does, all by default; returns their number."""
        if self.images is None:
            return 0
        shown = [one.image for floor in self.floors for one in floor.things.known]
        forgotten = self.images.shrink(most_bytes, shown)
        for floor in self.floors if forgotten else ():
            floor.things = floor.things.without_images(forgotten)
        return len(forgotten)

    @property
    def on_stairs(self) -> bool:
        """Whether the robot, which looks for stairs, climbs: it is off the ground it walked on."""
        return self.elevation is not None and self.footing.is_off_ground

    def ground_around(
        self, position: tuple[float, float], *, down: bool, under: bool = False
    ) -> Ground:
        """The ground that a climbing robot could walk to; see `ElevationMap.ground_from`."""
        assert self.elevation is not None, "only a robot that looks for stairs has an elevation map"
        return self.elevation.ground_from(position, down=down, under=under)

    @property
    def obstacles(self) -> OccupancyGrid:
        """The obstacles around the robot: those of the floor's map or, on stairs, those on them."""
        if self.elevation is not None and self.on_stairs:
            return self.elevation.obstacles
        return self.floor.map.grid

    def mark_occupied(self, points_xy: Float64[np.ndarray, "n 2"]) -> None:
        """Remember positions ``(x, y)``, metres, where the robot bumped into something."""
        if self.elevation is not None:
            self.elevation.mark_occupied(points_xy)
        if not self.on_stairs:
            self.floor.map.mark_occupied(points_xy)

    def register_stairs_underfoot(self, robot: Pose2) -> int | None:
        """Rely on stairs down that the robot got onto, seen too seldom or never; say which.

        Returns:
            Their number; None if the robot is at most a step below its ground, or has tried stairs
            here already.
        """
        z, ground_z = self.footing.z, self.footing.ground_z
        if z >= ground_z - self.embodiment.body.max_step_m - UNEVEN_M:
            return None
        stairs = Connector(self.number, False, robot.xy, robot.yaw)
        self.connectors, number = relied_on(self.connectors, stairs)
        return None if number in self.search.given_up else number

    def try_accept_new_floor(self) -> bool:
        """Take what stairs led to for another floor from the next step on, if it can be one."""
        here = self.track[-1]
        if not self.footing.is_storey_away:
            return False
        footing = self.footing.as_if_walked()
        if not footing.has_room(self.ground_around(here, down=False)):
            return False
        self.footing = footing
        return True

    def give_up(self, number: int) -> None:
        """Note that an attempt to take a connector has failed; this search makes no other one.

        What has never been taken counts as no way from then on. Stairs that have stay stairs.
        """
        one = self.connectors[number]
        self.floors[one.floor].search.given_up.add(number)
        if one.passage is not Passage.USED:
            self._replace(number, replace(one, passage=Passage.REFUTED))

    def reached_level(self, number: int) -> None:
        """Note that a connector led to another level of its own floor, where the robot stands."""
        one = self.connectors[number]
        self._replace(number, replace(one, passage=Passage.USED, other_floor=one.floor))

    def _replace(self, number: int, connector: Connector) -> None:
        before, after = self.connectors[:number], self.connectors[number + 1 :]
        self.connectors = (*before, connector, *after)

    def crossed(self, number: int) -> None:
        """Note that a connector led to the floor that the robot is on now."""
        here = self.footing.began
        self.connectors = with_crossing(
            self.connectors, number, self.number, here.xy, here.yaw + math.pi
        )

    def number_at(self, z: float) -> int | None:
        """The number of the known floor nearest to a height, metres; None if none is near it."""
        away_m = [abs(floor.z - z) for floor in self.floors]
        nearest = away_m.index(min(away_m))
        return nearest if away_m[nearest] <= ANOTHER_M else None

    def _known_or_new(self, z: float) -> int:
        """The number of the floor at a height, metres, which is added if none is near it."""
        known = self.number_at(z)
        return self.add_floor(z) if known is None else known

    def add_floor(self, z: float) -> int:
        """Add a floor of which nothing is known at a height, metres; return its number.

        Raises:
            MapError: There are as many as any building has.
        """
        if len(self.floors) == MOST_FLOORS:
            raise MapError(
                f"the robot would be on a new floor at {z:.1f} m, and {MOST_FLOORS} are known "
                "already; is its height wrong?"
            )
        self.floors.append(self._new_floor(z))
        return len(self.floors) - 1

    def _new_floor(self, z: float) -> Floor:
        map_ = TopDownMap(self.mapping, self.embodiment)
        lasts = bool(self.floors) and self.search.lasts
        return Floor(z, map_, search=SearchMemory(number=self.searches, lasts=lasts))
