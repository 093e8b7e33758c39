"""Finishes by name, and the taste of a house."""

from dataclasses import dataclass, replace

from hypernav.houses.dice import Dice
from hypernav.houses.kit.mesh import Finish, Vector

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


def wood(kind: str) -> Finish:
    """Furniture wood of a kind ("oak"), with the grain along u."""
    color, hue = WOODS[kind]
    return Finish("wood", color, 1.0, hue, "wooden")


def lacquer(hue: str) -> Finish:
    """Painted wood."""
    return Finish("satin", HUES[hue], 1.0, hue, "wooden")


def fabric(hue: str, texture: str = "fabric", tile_m: float = 0.3) -> Finish:
    """Upholstery or other cloth."""
    return Finish(texture, HUES[hue], tile_m, hue, "fabric")


def leather(hue: str) -> Finish:
    """Hide."""
    return Finish("leather", HUES[hue], 0.4, hue, "leather")


def plastic(hue: str) -> Finish:
    """Smooth plastic or paint."""
    return Finish("", HUES[hue], 1.0, hue, "plastic")


def terry(hue: str) -> Finish:
    """Towelling, wool, carpet."""
    return Finish("terry", HUES[hue], 0.25, hue, "fabric")


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


def picture(key: str, *, unlit: bool = False) -> Finish:
    """A picture that is fitted to its surface."""
    return Finish(key, (1.0, 1.0, 1.0), unlit=unlit)


@dataclass(frozen=True)
class Taste:
    """What the people of a house like; rooms vary on it.

    Attributes:
        wood: Kind of most furniture.
        second_wood: Kind of the rest.
        painted: Hue of painted furniture.
        soft: Hue of upholstery.
        accent: Hue of cushions and other small things.
        linen: Hue of bedding and curtains.
        metal: Fittings and legs.
    """

    wood: str
    second_wood: str
    painted: str
    soft: str
    accent: str
    linen: str
    metal: Finish

    def furniture_wood(self, dice: Dice) -> Finish:
        """Wood or paint for one piece of furniture."""
        return dice.weighted(
            ((wood(self.wood), 5.0), (wood(self.second_wood), 2.0), (lacquer(self.painted), 3.0))
        )


def draw_taste(dice: Dice) -> Taste:
    """The taste of one house."""
    kinds = dice.shuffled(list(WOODS))
    return Taste(
        wood=kinds[0],
        second_wood=kinds[1],
        painted=dice.weighted(
            (("white", 6.0), ("light gray", 1.0), ("black", 1.0), ("cream", 1.0))
        ),
        soft=dice.choice(
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
        accent=dice.choice(("red", "orange", "yellow", "teal", "blue", "pink", "purple", "green")),
        linen=dice.choice(("white", "light blue", "cream", "light gray", "beige", "pink", "navy")),
        metal=dice.choice((STEEL, BLACK_METAL, CHROME, BRASS)),
    )


def vary(taste: Taste, dice: Dice) -> Taste:
    """The taste of one room of the house."""
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
        taste,
        soft=dice.choice(hues) if dice.chance(0.5) else taste.soft,
        accent=dice.choice(hues) if dice.chance(0.4) else taste.accent,
        linen=dice.choice(
            ("white", "light blue", "cream", "gray", "green", "pink", "navy", "yellow")
        )
        if dice.chance(0.5)
        else taste.linen,
    )
