"""A piece of furniture: its parts, its name, and where things can stand on it."""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np

from hypernav.houses.kit.mesh import Finish, Mesh, Part, Vector


@dataclass(frozen=True)
class Top:
    """A level surface that small things can stand on, in the model's frame.

    Attributes:
        x_min: Metres.
        y_min: Metres.
        x_max: Metres.
        y_max: Metres.
        z: Height of the surface.
        clearance_m: Free height above it.
    """

    x_min: float
    y_min: float
    x_max: float
    y_max: float
    z: float
    clearance_m: float = 0.6


@dataclass(frozen=True, eq=False)
class Model:
    """Something to put into a room: x to its right, y to its front, z up, standing on z = 0.

    The footprint is centred on the origin.

    Attributes:
        parts: Meshes with finishes.
        category: Its kind.
        synonyms: Other names that fit.
        attributes: Words that are true of it.
        tops: Where small things can stand.
        low: Lowest corner of its box.
        high: Highest corner of its box.
    """

    parts: tuple[Part, ...]
    category: str
    synonyms: tuple[str, ...] = ()
    attributes: tuple[str, ...] = ()
    tops: tuple[Top, ...] = ()
    low: Vector = (0.0, 0.0, 0.0)
    high: Vector = (0.0, 0.0, 0.0)

    @property
    def width(self) -> float:
        """Along x, metres."""
        return self.high[0] - self.low[0]

    @property
    def depth(self) -> float:
        """Along y, metres."""
        return self.high[1] - self.low[1]

    @property
    def height(self) -> float:
        """From the floor, or from where it hangs, metres."""
        return self.high[2]

    def named(self, *synonyms: str, attributes: tuple[str, ...] = ()) -> "Model":
        """With more names and attributes."""
        return replace(
            self,
            synonyms=(*self.synonyms, *synonyms),
            attributes=(*self.attributes, *attributes),
        )


@dataclass
class Bench:
    """Where a model is put together."""

    parts: list[Part] = field(default_factory=list)

    def add(self, finish: Finish, *meshes: Mesh) -> None:
        """Fix meshes of one finish."""
        self.parts.extend(Part(mesh, finish) for mesh in meshes)

    def extend(self, parts: Iterable[Part]) -> None:
        """Fix finished parts."""
        self.parts.extend(parts)

    def model(
        self,
        category: str,
        *synonyms: str,
        main: Finish | None = None,
        attributes: tuple[str, ...] = (),
        tops: tuple[Top, ...] = (),
    ) -> Model:
        """The finished piece, shifted so that its footprint is centred.

        Args:
            category: Its kind.
            synonyms: Other names that fit.
            main: The finish that one would name it by ("red", "wooden").
            attributes: Further words that are true of it.
            tops: Where small things can stand, in the frame that the parts were made in.
        """
        low = np.min([p.mesh.positions.min(axis=0) for p in self.parts], axis=0)
        high = np.max([p.mesh.positions.max(axis=0) for p in self.parts], axis=0)
        x, y = (float(low[k] + high[k]) / 2.0 for k in (0, 1))
        words = tuple(w for w in ((main.hue, main.stuff) if main else ()) if w)
        return Model(
            tuple(Part(p.mesh.moved(-x, -y), p.finish) for p in self.parts),
            category,
            synonyms,
            words + attributes,
            tuple(
                replace(
                    t, x_min=t.x_min - x, x_max=t.x_max - x, y_min=t.y_min - y, y_max=t.y_max - y
                )
                for t in tops
            ),
            (float(low[0]) - x, float(low[1]) - y, float(low[2])),
            (float(high[0]) - x, float(high[1]) - y, float(high[2])),
        )
