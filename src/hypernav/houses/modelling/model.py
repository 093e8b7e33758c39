"""Model of an object: its parts, its names, and the surfaces that carry other objects."""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np

from hypernav.houses.modelling.mesh import Finish, Mesh, Part, Vector


@dataclass(frozen=True)
class SupportSurface:
    """Level surface that small objects can stand on, in the model's frame.

    Attributes:
        x_min: Left edge, metres.
        y_min: Back edge, metres.
        x_max: Right edge, metres.
        y_max: Front edge, metres.
        z: Height of the surface, metres.
        clearance_m: Free height above it, metres.
    """

    x_min: float
    y_min: float
    x_max: float
    y_max: float
    z: float
    clearance_m: float = 0.6


@dataclass(frozen=True, eq=False)
class Model:
    """Model of an object: x to its right, y to its front, z up, standing on z = 0.

    The footprint is centred on the origin.

    Attributes:
        parts: Meshes with finishes.
        category: Category of the object.
        synonyms: Other names of the category.
        attributes: Words that are true of it, such as colour and material.
        supports: Surfaces that small objects can stand on.
        low: Lowest corner of its bounding box, metres.
        high: Highest corner of its bounding box, metres.
    """

    parts: tuple[Part, ...]
    category: str
    synonyms: tuple[str, ...] = ()
    attributes: tuple[str, ...] = ()
    supports: tuple[SupportSurface, ...] = ()
    low: Vector = (0.0, 0.0, 0.0)
    high: Vector = (0.0, 0.0, 0.0)

    @property
    def width(self) -> float:
        """Extent along x, metres."""
        return self.high[0] - self.low[0]

    @property
    def depth(self) -> float:
        """Extent along y, metres."""
        return self.high[1] - self.low[1]

    @property
    def height(self) -> float:
        """Height of its highest point above the model's z = 0, metres."""
        return self.high[2]

    def named(self, *synonyms: str, attributes: tuple[str, ...] = ()) -> "Model":
        """Model with further synonyms and attributes."""
        return replace(
            self,
            synonyms=(*self.synonyms, *synonyms),
            attributes=(*self.attributes, *attributes),
        )


@dataclass
class ModelBuilder:
    """Builder of a model from parts."""

    parts: list[Part] = field(default_factory=list)

    def add(self, finish: Finish, *meshes: Mesh) -> None:
        """Add meshes of one finish."""
        self.parts.extend(Part(mesh, finish) for mesh in meshes)

    def extend(self, parts: Iterable[Part]) -> None:
        """Add parts."""
        self.parts.extend(parts)

    def model(
        self,
        category: str,
        *synonyms: str,
        main: Finish | None = None,
        attributes: tuple[str, ...] = (),
        supports: tuple[SupportSurface, ...] = (),
    ) -> Model:
        """Finished model, shifted so that its footprint is centred on the origin.

        Args:
            category: Category of the object.
            synonyms: Other names of the category.
            main: Finish whose colour and material become attributes ("red", "wooden").
            attributes: Further attributes.
            supports: Surfaces that small objects can stand on, in the frame of the parts.
        """
        low = np.min([p.mesh.positions.min(axis=0) for p in self.parts], axis=0)
        high = np.max([p.mesh.positions.max(axis=0) for p in self.parts], axis=0)
        x, y = (float(low[k] + high[k]) / 2.0 for k in (0, 1))
        words = tuple(w for w in ((main.hue, main.material) if main else ()) if w)
        return Model(
            tuple(Part(p.mesh.moved(-x, -y), p.finish) for p in self.parts),
            category,
            synonyms,
            words + attributes,
            tuple(
                replace(
                    t, x_min=t.x_min - x, x_max=t.x_max - x, y_min=t.y_min - y, y_max=t.y_max - y
                )
                for t in supports
            ),
            (float(low[0]) - x, float(low[1]) - y, float(low[2])),
            (float(high[0]) - x, float(high[1]) - y, float(high[2])),
        )
