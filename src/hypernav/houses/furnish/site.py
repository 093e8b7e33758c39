"""Ways to place things in a room: at walls, on walls, on top of others."""

from collections.abc import Sequence

from hypernav.houses.assembly import Placed
from hypernav.houses.furnish.space import Space
from hypernav.houses.furnish.spots import SIDES, SKIRTING_M, YAW, Spot, footprint, turned_point
from hypernav.houses.kit.model import Model, Top


class Site(Space):
    """A room with ways to find places in it."""

    def at_wall(
        self,
        model: Model,
        *,
        sides: Sequence[str] = SIDES,
        front: float = 0.0,
        access: bool = False,
        where: str = "any",
        gap: float = SKIRTING_M,
        z: float = 0.0,
        keep: bool = True,
    ) -> Placed | None:
        """Place a model with its back to some wall, if it fits anywhere.

        Args:
            model: What.
            sides: Walls to try, in random order.
            front: Depth of floor before it that must be and stay free.
            access: Whether its front must be reached with full walking width.
            where: "any", "corner" (corners first), "middle" (middles first).
            gap: To the wall.
            z: Height, for what hangs.
            keep: Whether the front zone stays reserved.
        """
        for side in self.dice.shuffled(sides):
            start, end, _ = self.wall_line(side)
            half = model.width / 2 + 0.02
            for t in self._positions(start + half, end - half, where):
                spot = self.spot_at_wall(model, side, t, gap, z)
                if self.fits(model, spot, front=front, access=access):
                    return self.put(model, spot, front=front if keep else 0.0, access=access)
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
        return self.dice.shuffled(grid)[:10]

    def on_wall(
        self, model: Model, *, sides: Sequence[str], z: float, near: Placed | None = None
    ) -> Placed | None:
        """Hang a model, above ``near`` if that is given and stands at a wall."""
        if near is not None:
            side = next(s for s in SIDES if (YAW[s] - near.yaw_deg) % 360.0 == 0.0)
            t = near.x if side in ("south", "north") else near.y
            spot = self.spot_at_wall(model, side, t, 0.004, z)
            return self.put(model, spot) if self.fits(model, spot, in_clear=True) else None
        for side in self.dice.shuffled(sides):
            start, end, _ = self.wall_line(side)
            half = model.width / 2 + 0.1
            for t in self._positions(start + half, end - half, "any"):
                spot = self.spot_at_wall(model, side, t, 0.004, z)
                if self.fits(model, spot, in_clear=True):
                    return self.put(model, spot)
        return None

    def on_top(
        self,
        base: Placed,
        model: Model,
        *,
        facing: float | None = None,
        where: tuple[float, float] | None = None,
    ) -> Placed | None:
        """Stand a small thing on a surface of another.

        Args:
            base: What carries it.
            model: The small thing.
            facing: Its turn relative to the base's, degrees; random small turns if None.
            where: Place on the surface from (0, 0) to (1, 1); random if None.
        """
        for top in self.dice.shuffled(base.model.tops):
            if model.height > top.clearance_m:
                continue
            for _ in range(8 if where is None else 1):
                turn = (
                    facing
                    if facing is not None
                    else float(self.dice.choice((0, 0, 0, 90, 180, 270)))
                )
                spot = self._top_spot(base, model, top, turn, where)
                if spot is None:
                    continue
                rect = footprint(model, spot)
                low, high = spot.z, spot.z + model.height
                if any(
                    low < s.high - 1e-4 and s.low < high - 1e-4 and rect.overlaps(s.rect, 0.012)
                    for s in self.solids
                    if s is not self.solid_of(base)
                ):
                    continue
                if self._covers_opening(rect, low, high):
                    continue
                piece = self.put(model, spot, on_top=True)
                self.carry(base, piece)
                return piece
        return None

    def _top_spot(
        self, base: Placed, model: Model, top: Top, turn: float, where: tuple[float, float] | None
    ) -> Spot | None:
        quarter = round(turn / 90.0)
        w, d = (model.width, model.depth) if quarter % 2 == 0 else (model.depth, model.width)
        room_x, room_y = top.x_max - top.x_min - w, top.y_max - top.y_min - d
        if room_x < -1e-6 or room_y < -1e-6:
            return None
        fx, fy = where if where is not None else (self.dice.unit(), self.dice.unit())
        x, y = top.x_min + w / 2 + fx * room_x, top.y_min + d / 2 + fy * room_y
        px, py = turned_point(x, y, base.yaw_deg)
        return Spot(base.x + px, base.y + py, base.yaw_deg + turn, base.z + top.z + 0.001)
