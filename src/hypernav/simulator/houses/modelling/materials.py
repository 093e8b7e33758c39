"""Finishes of surfaces, and the palette of colours and materials of a house."""

from dataclasses import dataclass, replace

from hypernav.simulator.houses.modelling.model import Finish, Mesh, Vector
from hypernav.simulator.houses.modelling.solids import panel
from hypernav.simulator.houses.random_stream import RandomStream

HUES: dict[str, Vector] = {
    "white": (0.93, 0.92, 0.9),
    "cream": (0.9, 0.84, 0.72),
    "beige": (0.78, 0.69, 0.56),
    "light gray": (0.72, 0.72, 0.71),
    "gray": (0.5, 0.51, 0.52),
    "dark gray": (0.27, 0.28, 0.3),
    "black": (0.09, 0.09, 0.1),
    "brown": (0.4, 0.27, 0.18),
    "red": (0.68, 0.13, 0.12),
    "orange": (0.85, 0.45, 0.16),
    "yellow": (0.89, 0.72, 0.25),
    "green": (0.24, 0.42, 0.27),
    "teal": (0.13, 0.41, 0.43),
    "blue": (0.2, 0.34, 0.58),
    "navy": (0.13, 0.18, 0.32),
    "light blue": (0.56, 0.69, 0.8),
    "purple": (0.4, 0.25, 0.45),
    "pink": (0.85, 0.6, 0.63),
}

WOODS: dict[str, tuple[Vector, str]] = {
    "oak": ((0.78, 0.59, 0.39), "light brown"),
    "beech": ((0.86, 0.68, 0.48), "light brown"),
    "pine": ((0.92, 0.74, 0.5), "light brown"),
    "cherry": ((0.6, 0.33, 0.2), "brown"),
    "teak": ((0.62, 0.4, 0.23), "brown"),
    "walnut": ((0.43, 0.29, 0.2), "dark brown"),
    "wenge": ((0.27, 0.18, 0.14), "dark brown"),
}

STEEL = Finish("brushed", (0.72, 0.73, 0.74), 0.6, "silver", "metal")
CHROME = Finish("brushed", (0.86, 0.87, 0.88), 0.8, "silver", "metal")
BLACK_METAL = Finish("", (0.1, 0.1, 0.105), 1.0, "black", "metal")
WHITE_METAL = Finish("", (0.9, 0.9, 0.89), 1.0, "white", "metal")
BRASS = Finish("brushed", (0.75, 0.58, 0.3), 0.6, "golden", "metal")
CERAMIC = Finish("", (0.95, 0.95, 0.94), 1.0, "white", "ceramic")
GLASS = Finish("", (0.74, 0.82, 0.83), 1.0, "clear", "glass")
BLACK_GLASS = Finish("", (0.05, 0.05, 0.06), 1.0, "black", "glass")
RUBBER = Finish("", (0.12, 0.12, 0.12), 1.0, "black", "rubber")
SHADE = Finish("fabric", (1.0, 0.95, 0.82), 0.3, "cream", "fabric")
GLOW = Finish("", (1.0, 0.98, 0.9), 1.0, "white", "glass", unlit=True)
TERRACOTTA = Finish("concrete", (0.78, 0.42, 0.28), 0.6, "orange", "clay")
MIRROR = Finish("", (0.78, 0.84, 0.88), 1.0, "silver", "glass")

# A material whose image covers one metre square counts as fitted, and is not repeated.
_TILE_M = 2.0


def wood(kind: str) -> Finish:
    """Finish of furniture wood ("oak"), with the grain along u."""
    color, hue = WOODS[kind]
    return Finish("wood", color, 1.0, hue, "wooden")


def lacquer(hue: str) -> Finish:
    """Finish of painted wood."""
    return Finish("satin", HUES[hue], 1.0, hue, "wooden")


def fabric(hue: str, texture: str = "fabric", tile_m: float = 0.3) -> Finish:
    """Finish of upholstery or other cloth."""
    return Finish(texture, HUES[hue], tile_m, hue, "fabric")


def leather(hue: str) -> Finish:
    """Finish of leather."""
    return Finish("leather", HUES[hue], 0.4, hue, "leather")


def plastic(hue: str) -> Finish:
    """Finish of smooth plastic or paint."""
    return Finish("", HUES[hue], 1.0, hue, "plastic")


def terry(hue: str) -> Finish:
    """Finish of terry cloth, wool or carpet."""
    return Finish("terry", HUES[hue], 0.25, hue, "fabric")


def image_finish(key: str, *, unlit: bool = False) -> Finish:
    """Finish of one image that is fitted to its surface.

    Args:
        key: Key in the texture library.
        unlit: Whether the surface shines by itself.
    """
    return Finish(key, (1.0, 1.0, 1.0), unlit=unlit)


@dataclass(frozen=True)
class Palette:
    """Colours and materials of a house, which its rooms vary.

    Attributes:
        wood: Wood of most furniture.
        secondary_wood: Wood of some furniture.
        paint_hue: Hue of painted furniture.
        upholstery_hue: Hue of upholstery.
        accent_hue: Hue of cushions and other small objects.
        linen_hue: Hue of bedding and curtains.
        metal: Finish of fittings and legs.
    """

    wood: str
    secondary_wood: str
    paint_hue: str
    upholstery_hue: str
    accent_hue: str
    linen_hue: str
    metal: Finish

    def furniture_wood(self, rng: RandomStream) -> Finish:
        """Random wood or paint for one piece of furniture."""
        return rng.weighted(
            (
                (wood(self.wood), 5.0),
                (wood(self.secondary_wood), 2.0),
                (lacquer(self.paint_hue), 3.0),
            )
        )


def sample_palette(rng: RandomStream) -> Palette:
    """Random palette for a house."""
    kinds = rng.shuffled(list(WOODS))
    return Palette(
        wood=kinds[0],
        secondary_wood=kinds[1],
        paint_hue=rng.weighted(
            (("white", 6.0), ("light gray", 1.0), ("black", 1.0), ("cream", 1.0))
        ),
        upholstery_hue=rng.choice(
            (
                "gray",
                "dark gray",
                "beige",
                "light gray",
                "blue",
                "green",
                "brown",
                "teal",
                "red",
                "navy",
                "cream",
            )
        ),
        accent_hue=rng.choice(
            ("red", "orange", "yellow", "teal", "blue", "pink", "purple", "green")
        ),
        linen_hue=rng.choice(
            ("white", "light blue", "cream", "light gray", "beige", "pink", "navy")
        ),
        metal=rng.choice((STEEL, BLACK_METAL, CHROME, BRASS)),
    )


def vary(palette: Palette, rng: RandomStream) -> Palette:
    """Random variation of a house's palette for one of its rooms."""
    hues = (
        "gray",
        "beige",
        "blue",
        "green",
        "brown",
        "teal",
        "red",
        "navy",
        "yellow",
        "purple",
        "orange",
        "black",
        "white",
        "pink",
    )
    return replace(
        palette,
        upholstery_hue=rng.choice(hues) if rng.chance(0.5) else palette.upholstery_hue,
        accent_hue=rng.choice(hues) if rng.chance(0.4) else palette.accent_hue,
        linen_hue=rng.choice(
            ("white", "light blue", "cream", "gray", "green", "pink", "navy", "yellow")
        )
        if rng.chance(0.5)
        else palette.linen_hue,
    )


def repeated_image(key: str) -> Finish:
    """Finish of an image that is a metre wide and repeats; for `repeated_panel`."""
    return Finish(key, (1.0, 1.0, 1.0), _TILE_M, "", "paper")


def repeated_panel(x: float, z: float, shift: float) -> Mesh:
    """Upright rectangle that faces +y, as high as the image; ``shift`` is a share of its width."""
    return panel(x, z).textured(_TILE_M * x, _TILE_M, _TILE_M * shift)
