"""Layout of a room: placement of models at walls, on walls and on other models."""

from collections.abc import Sequence

from hypernav.houses.assembly import PlacedModel
from hypernav.houses.modelling.model import Model, SupportSurface
from hypernav.houses.placement.model_pose import (
    SIDES,
    SKIRTING_M,
    YAW,
    ModelPose,
    footprint,
    turned_point,
)
from hypernav.houses.placement.room_space import RoomSpace


class RoomLayout(RoomSpace):
    """Layout of a room, which searches positions for models."""

    def place_at_wall(
        self,
        model: Model,
        *,
        sides: Sequence[str] = SIDES,
        front: float = 0.0,
        access: bool = False,
        where: str = "any",
        gap: float = SKIRTING_M,
        z: float = 0.0,
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
            z: Height of the model, metres.
            reserve_front: Whether the floor before it stays reserved.
        """
        for side in self.rng.shuffled(sides):
            start, end, _ = self.wall_line(side)
            half = model.width / 2 + 0.02
            for t in self._positions(start + half, end - half, where):
                pose = self.pose_at_wall(model, side, t, gap, z)
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
        self, model: Model, *, sides: Sequence[str], z: float, near: PlacedModel | None = None
    ) -> PlacedModel | None:
        """Hang a model on a wall, above ``near`` if given, which stands at a wall.

        Args:
            model: Model to hang.
            sides: Walls to try, in random order.
            z: Height of the model, metres.
            near: Placed model to hang it above.
        """
        if near is not None:
            side = next(s for s in SIDES if (YAW[s] - near.yaw_deg) % 360.0 == 0.0)
            t = near.x if side in ("south", "north") else near.y
            pose = self.pose_at_wall(model, side, t, 0.004, z)
            return self.place(model, pose) if self.fits(model, pose, in_clear_zone=True) else None
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
                turn = (
                    facing
                    if facing is not None
                    else float(self.rng.choice((0, 0, 0, 90, 180, 270)))
                )
                pose = self._pose_on_top(base, model, top, turn, where)
                if pose is None:
                    continue
                rect = footprint(model, pose)
                low, high = pose.z, pose.z + model.height
                if any(
                    low < s.high - 1e-4 and s.low < high - 1e-4 and rect.overlaps(s.rect, 0.012)
                    for s in self.obstacles
                    if s is not self.obstacle_of(base)
                ):
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
        px, py = turned_point(x, y, base.yaw_deg)
        return ModelPose(base.x + px, base.y + py, base.yaw_deg + turn, base.z + top.z + 0.001)
