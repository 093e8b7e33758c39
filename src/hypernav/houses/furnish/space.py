"""A room while it is being furnished: what stands where, and what may still come in."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float64

from hypernav.houses.assembly import Placed
from hypernav.houses.dice import Dice
from hypernav.houses.furnish.free_floor import FreeFloor, Point
from hypernav.houses.furnish.spots import GAP_M, SKIRTING_M, YAW, Solid, Spot, footprint
from hypernav.houses.kit.model import Model
from hypernav.houses.palette import Taste
from hypernav.houses.plan.doors import approach, leaf_rect
from hypernav.houses.plan.shapes import FloorPlan, Opening, Rect

_HEAD_M = 1.05
"""What hangs higher than this is out of a robot's way."""

_FLAT_M = 0.08
"""What is lower than this can be driven over."""


class Space:
    """A room, its free floor and walls, and everything placed so far."""

    def __init__(self, plan: FloorPlan, number: int, dice: Dice, taste: Taste) -> None:
        """An empty room.

        Args:
            plan: Of the house.
            number: Of the room.
            dice: Chance for this room.
            taste: Of this room.
        """
        self.plan, self.number, self.dice, self.taste = plan, number, dice, taste
        self.room = plan.rooms[number]
        self.inner = self.room.inner.grown(-0.035 if self.room.is_outside else 0.0)
        self.height = plan.height
        self.openings = plan.openings_of(number)
        self.placed: list[Placed] = []
        self.solids: list[Solid] = []
        self._clear: list[Rect] = []
        self._solid_of: dict[int, Solid] = {}
        self._carried: dict[int, list[Placed]] = {}
        self._fixed: set[int] = set()
        self._floor = FreeFloor(plan, number)
        for opening in self.openings:
            if opening.is_way or opening.kind == "entrance":
                self._clear.append(approach(opening, margin=0.02))
            leaf = leaf_rect(opening) if opening.leaf_room == number else None
            if leaf is not None:
                self.solids.append(Solid(leaf.grown(0.05), 0.0, 2.1))
                self._floor.take([leaf], [])

    def wall_line(self, side: str) -> tuple[float, float, float]:
        """``(start, end, plane)`` of a wall, inside the room."""
        i = self.inner
        return {
            "south": (i.x0, i.x1, i.y0),
            "north": (i.x0, i.x1, i.y1),
            "west": (i.y0, i.y1, i.x0),
            "east": (i.y0, i.y1, i.x1),
        }[side]

    def wall_openings(self, side: str) -> list[Opening]:
        """Doors and windows in a wall."""
        along = "x" if side in ("south", "north") else "y"
        _, _, plane = self.wall_line(side)
        return [o for o in self.openings if o.along == along and abs(o.at - plane) < 0.3]

    def spot_at_wall(
        self, model: Model, side: str, t: float, gap: float = SKIRTING_M, z: float = 0.0
    ) -> Spot:
        """Back to a wall, its middle at ``t`` along it."""
        _, _, plane = self.wall_line(side)
        off = model.depth / 2 + gap
        yaw = YAW[side]
        return {
            "south": Spot(t, plane + off, yaw, z),
            "north": Spot(t, plane - off, yaw, z),
            "west": Spot(plane + off, t, yaw, z),
            "east": Spot(plane - off, t, yaw, z),
        }[side]

    def fits(
        self,
        model: Model,
        spot: Spot,
        *,
        front: float = 0.0,
        access: bool = False,
        over: Sequence[Solid] = (),
        in_clear: bool = False,
        tight: bool = False,
        floor: bool = True,
    ) -> bool:
        """Whether a model can stand at a spot.

        Args:
            model: What.
            spot: Where.
            front: Depth of floor before it that must be free of other furniture.
            access: Whether its front must be reached with full walking width.
            over: Solids that it may overlap, for chairs under tables.
            in_clear: Whether it may stand in ways that are kept clear, for what is flat or high.
            floor: Whether the floor must stay connected.
            tight: Whether it may touch its neighbours, for fitted units.
        """
        rect = footprint(model, spot)
        low, high = spot.z + model.low[2], spot.z + model.height
        if not self.inner.grown(-0.004).holds(rect) or (
            high > self.height - 0.01 and low >= 0.0 and spot.z == 0.0
        ):
            return False
        if not in_clear and low < 1.95 and any(rect.overlaps(c) for c in self._clear):
            return False
        if self._covers_opening(rect, low, high):
            return False
        for solid in self.solids:
            if (
                solid not in over
                and low < solid.high - 1e-4
                and solid.low < high - 1e-4
                and rect.overlaps(solid.rect, 0.0 if tight else GAP_M)
            ):
                return False
        if front > 0.0:
            zone = self.front_zone(model, spot, front)
            if any(
                s.low < 1.0 and s.high > 0.1 and zone.overlaps(s.rect) and s not in over
                for s in self.solids
            ):
                return False
        if low >= _HEAD_M or high < _FLAT_M or not floor:
            return True
        return self._floor.allows([rect], [self._before(model, spot)] if access else [])

    def _covers_opening(self, rect: Rect, low: float, high: float) -> bool:
        for opening in self.openings:
            reach = 0.17 if opening.bottom > 0 else 0.35
            if (
                high > opening.bottom - 0.04
                and low < opening.top
                and rect.overlaps(opening.strip(-reach, reach, 0.06))
            ):
                return True
        return False

    def front_zone(self, model: Model, spot: Spot, deep: float) -> Rect:
        """The floor before a model."""
        r = footprint(model, spot)
        quarter = round(spot.yaw_deg / 90.0) % 4
        return (
            Rect(r.x0, r.y1, r.x1, r.y1 + deep),
            Rect(r.x0 - deep, r.y0, r.x0, r.y1),
            Rect(r.x0, r.y0 - deep, r.x1, r.y0),
            Rect(r.x1, r.y0, r.x1 + deep, r.y1),
        )[quarter]

    def _before(self, model: Model, spot: Spot) -> Point:
        zone = self.front_zone(model, spot, 0.84)
        return zone.centre

    def is_taken(self, model: Model, spot: Spot) -> bool:
        """Whether something else is already in the space of a model at a spot."""
        rect = footprint(model, spot)
        low, high = spot.z + model.low[2], spot.z + model.height
        return any(
            low < s.high - 1e-4 and s.low < high - 1e-4 and rect.overlaps(s.rect, 0.01)
            for s in self.solids
        )

    def leaves_ways(self, model: Model, spot: Spot) -> bool:
        """Whether all of the floor stays connected if a model comes to a spot."""
        return self._floor.allows([footprint(model, spot)], [])

    def is_free(self, zone: Rect) -> bool:
        """Whether no furniture reaches into a rectangle on the floor."""
        return not any(s.low < 1.0 and s.high > 0.1 and zone.overlaps(s.rect) for s in self.solids)

    def reserve(self, zone: Rect) -> None:
        """Keep a piece of floor free from now on."""
        self._clear.append(zone)

    def put(
        self,
        model: Model,
        spot: Spot,
        *,
        front: float = 0.0,
        access: bool = False,
        flat: bool = False,
        on_top: bool = False,
    ) -> Placed:
        """Place a model for good; no test is made.

        Args:
            model: What.
            spot: Where.
            front: Depth of floor before it that stays reserved.
            access: Whether its front must stay within reach.
            flat: Whether it takes no space, as a rug.
            on_top: Whether it stands on something else and takes no floor.
        """
        rect = footprint(model, spot)
        low, high = spot.z + model.low[2], spot.z + model.height
        piece = Placed(model, spot.x, spot.y, spot.z, spot.yaw_deg, self.room.name)
        self.placed.append(piece)
        if flat:
            return piece
        self.solids.append(Solid(rect, low, high))
        self._solid_of[id(piece)] = self.solids[-1]
        self._fixed |= {id(piece)} if front > 0.0 or access else set()
        if low < _HEAD_M and high >= _FLAT_M and not on_top:
            self._floor.take([rect], [self._before(model, spot)] if access else [])
        if front > 0.0:
            self._clear.append(self.front_zone(model, spot, front))
        return piece

    def solid_of(self, piece: Placed) -> Solid:
        """The space that a placed model takes."""
        return self._solid_of[id(piece)]

    def takes_space(self, piece: Placed) -> bool:
        """Whether a placed model is more than flat."""
        return id(piece) in self._solid_of

    def is_loose(self, piece: Placed) -> bool:
        """Whether it may go again: it takes space and has no place reserved before it."""
        return self.takes_space(piece) and id(piece) not in self._fixed

    def carry(self, base: Placed, piece: Placed) -> None:
        """Note that a piece stands on another and goes with it."""
        self._carried.setdefault(id(base), []).append(piece)

    def remove(self, piece: Placed) -> None:
        """Take something away with all that stands on it; the floor under it stays taken."""
        for upper in self._carried.pop(id(piece), []):
            if self.takes_space(upper):
                self.remove(upper)
        self.placed = [p for p in self.placed if p is not piece]
        solid = self._solid_of.pop(id(piece))
        self.solids = [s for s in self.solids if s is not solid]

    def standing_points(self) -> Float64[np.ndarray, "n 2"]:
        """Where a slim robot may stand."""
        return self._floor.standing_points()
