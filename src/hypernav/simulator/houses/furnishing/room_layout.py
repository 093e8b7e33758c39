"""Layout of a room while it is furnished: placed models, and where others fit."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from hypernav.simulator.houses.assembly import PlacedModel
from hypernav.simulator.houses.furnishing.free_floor import FreeFloor, Point
from hypernav.simulator.houses.modelling.materials import Palette
from hypernav.simulator.houses.modelling.model import Model, SupportSurface, rotation_matrix
from hypernav.simulator.houses.plan.floor_plan import FloorPlan, Opening, Rect
from hypernav.simulator.houses.plan.openings import approach, leaf_rect
from hypernav.simulator.houses.random_stream import RandomStream

GAP_M = 0.02
"""Smallest gap between pieces of furniture, metres."""

SKIRTING_M = 0.018
"""Gap between furniture and a wall, for the skirting board, metres."""

_OVERHEAD_M = 1.05
"""Smallest height of models that a robot drives under, metres."""

_DRIVABLE_M = 0.08
"""Largest height of models that a robot drives over, metres."""

SIDES = ("south", "east", "north", "west")
YAW = {"south": 0.0, "east": 90.0, "north": 180.0, "west": -90.0}
"""Yaw of a model with its back to a wall, degrees."""


@dataclass(frozen=True)
class Obstacle:
    """Space that an object occupies: a rectangle on the floor and a range of heights, metres."""

    rect: Rect
    low: float
    high: float


@dataclass(frozen=True)
class ModelPose:
    """Pose that a model could take: centre of its footprint, yaw and height."""

    x: float
    y: float
    yaw_deg: float
    z: float = 0.0


def footprint(model: Model, pose: ModelPose) -> Rect:
    """Rectangle on the floor that a model covers at a pose."""
    quarter = round(pose.yaw_deg / 90.0)
    if abs(pose.yaw_deg - 90.0 * quarter) < 1e-9:
        w, d = (model.width, model.depth) if quarter % 2 == 0 else (model.depth, model.width)
    else:
        # at other angles a square that covers it
        w = d = 0.93 * (model.width**2 + model.depth**2) ** 0.5
    return Rect(pose.x - w / 2, pose.y - d / 2, pose.x + w / 2, pose.y + d / 2)


def beside(
    base: PlacedModel | ModelPose, x: float, y: float, turn_deg: float = 0.0, *, z: float = 0.0
) -> ModelPose:
    """Pose at a point of another model's frame; exact for quarter turns.

    Args:
        base: The other model, or its pose.
        x: Distance to its right, metres.
        y: Distance to its front, metres.
        turn_deg: Yaw relative to it, degrees.
        z: Height, metres.
    """
    r = rotation_matrix(base.yaw_deg)
    dx, dy = float(x * r[0, 0] + y * r[0, 1]), float(x * r[1, 0] + y * r[1, 1])
    return ModelPose(base.x + dx, base.y + dy, base.yaw_deg + turn_deg, z)


class RoomLayout:
    """Room with its free floor, its walls and all models placed so far."""

    def __init__(self, plan: FloorPlan, number: int, rng: RandomStream, palette: Palette) -> None:
        """Start with the empty room.

        Args:
            plan: Floor plan of the house.
            number: Index of the room.
            rng: Source of randomness for this room.
            palette: Palette of this room.
        """
        self.plan, self.number, self.rng, self.palette = plan, number, rng, palette
        self.room = plan.rooms[number]
        self.inner = self.room.inner.grown(-0.035 if self.room.is_outside else 0.0)
        self.height = plan.height
        self.openings = plan.openings_of(number)
        self.placed: list[PlacedModel] = []
        self.obstacles: list[Obstacle] = []
        self._clear_zones: list[Rect] = []
        self._obstacle_of: dict[int, Obstacle] = {}
        self._attached: dict[int, list[PlacedModel]] = {}
        self._fixed: set[int] = set()
        self._floor = FreeFloor(plan, number)
        for opening in self.openings:
            if opening.is_passable or opening.kind == "entrance":
                self._clear_zones.append(approach(opening, margin=0.02))
            leaf = leaf_rect(opening) if opening.leaf_room == number else None
            if leaf is not None:
                self.obstacles.append(Obstacle(leaf.grown(0.05), 0.0, 2.1))
                self._floor.occupy([leaf], [])
        self._keep_atrium_open()

    def _keep_atrium_open(self) -> None:
        """Leave room for what looks down through the floor, and up through the ceiling."""
        for hole in self.plan.left_out(self.number, below=True):
            self.obstacles.append(Obstacle(hole.grown(0.1), 0.0, self.height))
            self._floor.occupy([hole.grown(0.05)], [])
            self._clear_zones.append(Rect(hole.x0, self.inner.y0, hole.x1, self.inner.y1))
        for hole in self.plan.left_out(self.number, below=False):
            self.obstacles.append(Obstacle(hole.grown(0.1), self.height - 0.5, self.height))

    def wall_line(self, side: str) -> tuple[float, float, float]:
        """``(start, end, plane)`` of a wall's inner face."""
        i = self.inner
        return {
            "south": (i.x0, i.x1, i.y0),
            "north": (i.x0, i.x1, i.y1),
            "west": (i.y0, i.y1, i.x0),
            "east": (i.y0, i.y1, i.x1),
        }[side]

    def wall_openings(self, side: str) -> list[Opening]:
        """Doors and windows in a wall of the room."""
        along = "x" if side in ("south", "north") else "y"
        _, _, plane = self.wall_line(side)
        return [o for o in self.openings if o.along == along and abs(o.at - plane) < 0.3]

    def pose_at_wall(
        self, model: Model, side: str, t: float, gap: float = SKIRTING_M, z: float = 0.0
    ) -> ModelPose:
        """Pose with the back to a wall and the centre at ``t`` along it."""
        _, _, plane = self.wall_line(side)
        off = model.depth / 2 + gap
        yaw = YAW[side]
        return {
            "south": ModelPose(t, plane + off, yaw, z),
            "north": ModelPose(t, plane - off, yaw, z),
            "west": ModelPose(plane + off, t, yaw, z),
            "east": ModelPose(plane - off, t, yaw, z),
        }[side]

    def fits(
        self,
        model: Model,
        pose: ModelPose,
        *,
        front: float = 0.0,
        access: bool = False,
        over: Sequence[Obstacle] = (),
        in_clear_zone: bool = False,
        tight: bool = False,
        floor: bool = True,
    ) -> bool:
        """Whether a model can stand at a pose.

        Args:
            model: Model to place.
            pose: Pose of the model.
            front: Depth of the floor before it that must be free of other furniture, metres.
            access: Whether its front must be reached with full walking width.
            over: Obstacles that it may overlap, for chairs under tables.
            in_clear_zone: Whether it may overlap zones that are kept clear (flat or high models).
            floor: Whether the floor must stay connected.
            tight: Whether it may touch its neighbours, for fitted units.
        """
        rect = footprint(model, pose)
        low, high = pose.z + model.low[2], pose.z + model.height
        if not self.inner.grown(-0.004).holds(rect) or (
            high > self.height - 0.01 and low >= 0.0 and pose.z == 0.0
        ):
            return False
        if not in_clear_zone and low < 1.95 and any(rect.overlaps(c) for c in self._clear_zones):
            return False
        if self._covers_opening(rect, low, high):
            return False
        if any(s not in over for s in self._in_space(rect, low, high, 0.0 if tight else GAP_M)):
            return False
        if front > 0.0 and not self.is_free(self.front_zone(model, pose, front), over):
            return False
        if low >= _OVERHEAD_M or high < _DRIVABLE_M or not floor:
            return True
        return self._floor.allows([rect], [self._access_point(model, pose)] if access else [])

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

    def front_zone(self, model: Model, pose: ModelPose, deep: float) -> Rect:
        """Floor before a model, up to a depth in metres."""
        r = footprint(model, pose)
        quarter = round(pose.yaw_deg / 90.0) % 4
        return (
            Rect(r.x0, r.y1, r.x1, r.y1 + deep),
            Rect(r.x0 - deep, r.y0, r.x0, r.y1),
            Rect(r.x0, r.y0 - deep, r.x1, r.y0),
            Rect(r.x1, r.y0, r.x1 + deep, r.y1),
        )[quarter]

    def _access_point(self, model: Model, pose: ModelPose) -> Point:
        return self.front_zone(model, pose, 0.84).centre

    def is_taken(self, model: Model, pose: ModelPose) -> bool:
        """Whether a model at a pose would overlap an obstacle."""
        low, high = pose.z + model.low[2], pose.z + model.height
        return any(self._in_space(footprint(model, pose), low, high, 0.01))

    def _in_space(self, rect: Rect, low: float, high: float, gap: float) -> Iterator[Obstacle]:
        """Obstacles that come closer than a gap to a rectangle, in a range of heights."""
        return (
            s
            for s in self.obstacles
            if low < s.high - 1e-4 and s.low < high - 1e-4 and rect.overlaps(s.rect, gap)
        )

    def keeps_floor_connected(self, model: Model, pose: ModelPose) -> bool:
        """Whether all of the floor stays connected with a model at a pose."""
        return self._floor.allows([footprint(model, pose)], [])

    def is_free(self, zone: Rect, over: Sequence[Obstacle] = ()) -> bool:
        """Whether no obstacle, except for those in ``over``, overlaps a rectangle on the floor."""
        return not any(
            s.low < 1.0 and s.high > 0.1 and zone.overlaps(s.rect) and s not in over
            for s in self.obstacles
        )

    def reserve(self, zone: Rect) -> None:
        """Keep a rectangle of the floor clear of models that are placed later."""
        self._clear_zones.append(zone)

    def place(
        self,
        model: Model,
        pose: ModelPose,
        *,
        front: float = 0.0,
        access: bool = False,
        flat: bool = False,
        on_top: bool = False,
    ) -> PlacedModel:
        """Place a model without any test.

        Args:
            model: Model to place.
            pose: Pose of the model.
            front: Depth of the floor before it that stays reserved, metres.
            access: Whether its front must stay within reach.
            flat: Whether it occupies no space, like a rug.
            on_top: Whether it stands on another model and occupies no floor.
        """
        rect = footprint(model, pose)
        low, high = pose.z + model.low[2], pose.z + model.height
        piece = PlacedModel(model, pose.x, pose.y, pose.z, pose.yaw_deg, self.room.name)
        self.placed.append(piece)
        if flat:
            return piece
        self.obstacles.append(Obstacle(rect, low, high))
        self._obstacle_of[id(piece)] = self.obstacles[-1]
        self._fixed |= {id(piece)} if front > 0.0 or access else set()
        if low < _OVERHEAD_M and high >= _DRIVABLE_M and not on_top:
            self._floor.occupy([rect], [self._access_point(model, pose)] if access else [])
        if front > 0.0:
            self._clear_zones.append(self.front_zone(model, pose, front))
        return piece

    def place_if_fits(
        self,
        model: Model,
        pose: ModelPose,
        *,
        over: Sequence[Obstacle] = (),
        in_clear_zone: bool = False,
        tight: bool = False,
    ) -> PlacedModel | None:
        """Place a model if it can stand at a pose; see `fits` for the arguments."""
        if self.fits(model, pose, over=over, in_clear_zone=in_clear_zone, tight=tight):
            return self.place(model, pose)
        return None

    def obstacle_of(self, piece: PlacedModel) -> Obstacle:
        """Space that a placed model occupies."""
        return self._obstacle_of[id(piece)]

    def is_obstacle(self, piece: PlacedModel) -> bool:
        """Whether a placed model occupies space; flat ones don't."""
        return id(piece) in self._obstacle_of

    def is_removable(self, piece: PlacedModel) -> bool:
        """Whether a placed model may be removed: an obstacle without reserved floor before it."""
        return self.is_obstacle(piece) and id(piece) not in self._fixed

    def attach(self, base: PlacedModel, piece: PlacedModel) -> None:
        """Attach a placed model to the one that carries it, so that both are removed together."""
        self._attached.setdefault(id(base), []).append(piece)

    def remove(self, piece: PlacedModel) -> None:
        """Remove a placed model with everything on it; the floor under it stays occupied."""
        for upper in self._attached.pop(id(piece), []):
            if self.is_obstacle(upper):
                self.remove(upper)
        self.placed = [p for p in self.placed if p is not piece]
        obstacle = self._obstacle_of.pop(id(piece))
        self.obstacles = [s for s in self.obstacles if s is not obstacle]

    def standing_points(self) -> Float64[np.ndarray, "n 2"]:
        """Positions where a slim robot may stand."""
        return self._floor.standing_points()

    def place_at_wall(
        self,
        model: Model,
        *,
        sides: Sequence[str] = SIDES,
        front: float = 0.0,
        access: bool = False,
        where: str = "any",
        gap: float = SKIRTING_M,
        reserve_front: bool = True,
    ) -> PlacedModel | None:
        """Place a model with its back to some wall, if it fits anywhere.

        Args:
            model: Model to place.
            sides: Walls to try, in random order.
            front: Depth of the floor before it that must be free, metres.
            access: Whether its front must be reached with full walking width.
            where: Order of positions: "any", "corner" (corners first) or "middle" (middles first).
            gap: Distance to the wall, metres.
            reserve_front: Whether the floor before it stays reserved.
        """
        for side in self.rng.shuffled(sides):
            start, end, _ = self.wall_line(side)
            half = model.width / 2 + 0.02
            for t in self._positions(start + half, end - half, where):
                pose = self.pose_at_wall(model, side, t, gap)
                if self.fits(model, pose, front=front, access=access):
                    return self.place(
                        model, pose, front=front if reserve_front else 0.0, access=access
                    )
        return None

    def _positions(self, low: float, high: float, where: str) -> list[float]:
        if high < low:
            return []
        count = max(int((high - low) / 0.15), 1)
        grid = [round(low + (high - low) * k / count, 3) for k in range(count + 1)]
        if where == "corner":
            return sorted(grid, key=lambda t: min(t - low, high - t))[:8]
        if where == "middle":
            return sorted(grid, key=lambda t: abs(t - (low + high) / 2))
        return self.rng.shuffled(grid)[:10]

    def hang_on_wall(
        self,
        model: Model,
        *,
        z: float,
        sides: Sequence[str] = SIDES,
        near: PlacedModel | None = None,
    ) -> PlacedModel | None:
        """Hang a model on a wall, above ``near`` if given, which stands at a wall.

        Args:
            model: Model to hang.
            z: Height of the model, metres.
            sides: Walls to try, in random order.
            near: Placed model to hang it above.
        """
        if near is not None:
            side = next(s for s in SIDES if (YAW[s] - near.yaw_deg) % 360.0 == 0.0)
            t = near.x if side in ("south", "north") else near.y
            pose = self.pose_at_wall(model, side, t, 0.004, z)
            return self.place_if_fits(model, pose, in_clear_zone=True)
        for side in self.rng.shuffled(sides):
            start, end, _ = self.wall_line(side)
            half = model.width / 2 + 0.1
            for t in self._positions(start + half, end - half, "any"):
                pose = self.pose_at_wall(model, side, t, 0.004, z)
                if self.fits(model, pose, in_clear_zone=True):
                    return self.place(model, pose)
        return None

    def place_on_top(
        self,
        base: PlacedModel,
        model: Model,
        *,
        facing: float | None = None,
        where: tuple[float, float] | None = None,
    ) -> PlacedModel | None:
        """Place a small model on a support surface of another.

        Args:
            base: Placed model that carries it.
            model: Model to place.
            facing: Yaw relative to the base, degrees; random quarter turns if None.
            where: Position on the surface from (0, 0) to (1, 1); random if None.
        """
        for top in self.rng.shuffled(base.model.supports):
            if model.height > top.clearance_m:
                continue
            for _ in range(8 if where is None else 1):
                turn = facing
                if turn is None:
                    turn = float(self.rng.choice((0, 0, 0, 90, 180, 270)))
                pose = self._pose_on_top(base, model, top, turn, where)
                if pose is None:
                    continue
                rect = footprint(model, pose)
                low, high = pose.z, pose.z + model.height
                touched = self._in_space(rect, low, high, 0.012)
                if any(s is not self.obstacle_of(base) for s in touched):
                    continue
                if self._covers_opening(rect, low, high):
                    continue
                piece = self.place(model, pose, on_top=True)
                self.attach(base, piece)
                return piece
        return None

    def _pose_on_top(
        self,
        base: PlacedModel,
        model: Model,
        top: SupportSurface,
        turn: float,
        where: tuple[float, float] | None,
    ) -> ModelPose | None:
        quarter = round(turn / 90.0)
        w, d = (model.width, model.depth) if quarter % 2 == 0 else (model.depth, model.width)
        room_x, room_y = top.x_max - top.x_min - w, top.y_max - top.y_min - d
        if room_x < -1e-6 or room_y < -1e-6:
            return None
        fx, fy = where if where is not None else (self.rng.unit(), self.rng.unit())
        x, y = top.x_min + w / 2 + fx * room_x, top.y_min + d / 2 + fy * room_y
        return beside(base, x, y, turn, z=base.z + top.z + 0.001)
