"""Finishes of the walls, floors and ceilings of homes, offices and shops."""

from collections.abc import Mapping
from dataclasses import dataclass

from hypernav.simulator.houses.modelling.materials import WOODS
from hypernav.simulator.houses.modelling.model import Finish, Vector
from hypernav.simulator.houses.random_stream import RandomStream

_PAINTS: tuple[Vector, ...] = (
    (0.93, 0.92, 0.89),
    (0.92, 0.89, 0.83),
    (0.87, 0.88, 0.88),
    (0.95, 0.94, 0.92),
)
_TINTS: tuple[Vector, ...] = (
    (0.79, 0.85, 0.88),
    (0.86, 0.82, 0.74),
    (0.8, 0.86, 0.79),
    (0.9, 0.84, 0.8),
    (0.83, 0.8, 0.86),
    (0.91, 0.87, 0.72),
    (0.72, 0.76, 0.78),
)
_TILE_TINTS: tuple[Vector, ...] = (
    (0.94, 0.94, 0.93),
    (0.86, 0.9, 0.92),
    (0.9, 0.88, 0.82),
    (0.8, 0.82, 0.82),
    (0.82, 0.89, 0.86),
)
_STONE_FLOORS: tuple[Vector, ...] = (
    (0.78, 0.76, 0.72),
    (0.62, 0.6, 0.57),
    (0.85, 0.8, 0.72),
    (0.45, 0.46, 0.48),
    (0.72, 0.55, 0.42),
)

_CARPETS: tuple[Vector, ...] = (
    (0.36, 0.38, 0.42),
    (0.5, 0.5, 0.5),
    (0.3, 0.36, 0.45),
    (0.46, 0.43, 0.4),
    (0.33, 0.4, 0.37),
)
_HARD: tuple[Vector, ...] = (
    (0.8, 0.79, 0.76),
    (0.66, 0.66, 0.65),
    (0.72, 0.68, 0.62),
    (0.55, 0.56, 0.58),
)
_WALLS: tuple[Vector, ...] = ((0.94, 0.94, 0.93), (0.9, 0.9, 0.88), (0.92, 0.9, 0.86))
_ACCENTS: tuple[Vector, ...] = (
    (0.72, 0.8, 0.86),
    (0.75, 0.83, 0.74),
    (0.87, 0.8, 0.68),
    (0.84, 0.76, 0.74),
    (0.66, 0.72, 0.76),
)

FLOORS = {
    **dict.fromkeys(("restroom", "copy room", "server room", "storage", "pantry"), "tiles"),
    **dict.fromkeys(("staff room", "stock room", "fitting room"), "tiles"),
}
"""Floor of kinds of rooms that don't have the building's main floor."""


@dataclass(frozen=True)
class RoomFinish:
    """Finishes of one room.

    Attributes:
        floor: Finish of the floor.
        wall: Finish of the walls.
        ceiling: Finish of the ceiling.
        trim: Finish of skirting boards and door frames.
    """

    floor: Finish
    wall: Finish
    ceiling: Finish
    trim: Finish


def room_finishes(rng: RandomStream, kinds: list[str]) -> list[RoomFinish]:
    """Random finishes of all rooms; dry rooms share a wooden floor."""
    wood = rng.choice(("oak", "beech", "teak", "walnut", "cherry", "oak", "pine"))
    planks = Finish(
        rng.choice(("planks", "wide planks")), WOODS[wood][0], rng.choice((1.2, 1.6)), "", "wooden"
    )
    stone = Finish(
        rng.choice(("large tiles", "square tiles", "marble")),
        rng.choice(_STONE_FLOORS),
        1.0,
        "",
        "stone",
    )
    paint = Finish("plaster", rng.choice(_PAINTS), 1.5)
    ceiling = Finish("plaster", (0.97, 0.97, 0.96), 2.0)
    trim = (
        Finish("", (0.93, 0.92, 0.9)) if rng.chance(0.75) else Finish("wood", WOODS[wood][0], 1.0)
    )
    result = []
    for number, kind in enumerate(kinds):
        own = rng.fork("room", number)
        floor, wall = planks, paint
        if kind in ("bathroom", "laundry"):
            floor = Finish(
                own.choice(("square tiles", "large tiles", "mosaic")),
                own.choice(_STONE_FLOORS),
                0.9,
            )
            wall = Finish(
                own.choice(("square tiles", "subway tiles", "large tiles")),
                own.choice(_TILE_TINTS),
                own.choice((0.6, 0.8)),
            )
        elif kind == "kitchen":
            floor = stone if own.chance(0.7) else planks
        elif kind == "balcony":
            floor = stone if own.chance(0.5) else Finish("wide planks", WOODS["teak"][0], 0.9)
        elif kind == "bedroom" and own.chance(0.25):
            floor = Finish(
                "pile", own.choice(((0.72, 0.68, 0.62), (0.6, 0.62, 0.66), (0.8, 0.76, 0.7))), 0.4
            )
        if kind in ("bedroom", "living room", "dining room", "office") and own.chance(0.45):
            wall = Finish("plaster", own.choice(_TINTS), 1.5)
            if own.chance(0.2):
                wall = Finish(
                    own.choice(("striped wallpaper", "rhomb wallpaper", "flower wallpaper")),
                    own.choice(_TINTS),
                    0.5,
                )
        if kind == "storage":
            wall = Finish("plaster", (0.85, 0.84, 0.8), 1.5)
        result.append(RoomFinish(floor, wall, ceiling, trim))
    return result


def public_finishes(
    rng: RandomStream, kinds: list[str], soft: Mapping[str, float]
) -> list[RoomFinish]:
    """Random finishes of all rooms of a public building."""
    wood = rng.choice(("oak", "beech", "walnut", "oak"))
    main = rng.weighted(
        (
            (Finish("large tiles", rng.choice(_HARD), 1.2, "", "stone"), 4.0),
            (Finish("concrete", (0.7, 0.69, 0.67), 2.0, "", "stone"), 2.0),
            (Finish("wide planks", WOODS[wood][0], 1.6, "", "wooden"), 2.0),
        )
    )
    carpet = Finish("pile", rng.choice(_CARPETS), 0.5, "", "fabric")
    tiles = Finish("square tiles", rng.choice(_HARD), 0.9, "", "stone")
    has_carpet = {kind: rng.chance(chance) for kind, chance in soft.items()}
    paint, accent = rng.choice(_WALLS), rng.choice(_ACCENTS)
    ceiling = Finish("plaster", (0.96, 0.96, 0.95), 2.0)
    trim = Finish("", rng.choice(((0.9, 0.9, 0.89), (0.35, 0.36, 0.38), (0.6, 0.61, 0.62))))
    result = []
    for number, kind in enumerate(kinds):
        own = rng.fork("room", number)
        floor = tiles if FLOORS.get(kind) == "tiles" else main
        floor = carpet if has_carpet.get(kind, False) else floor
        wall = Finish("plaster", accent if own.chance(0.2) else paint, 1.5)
        if kind == "restroom":
            wall = Finish("subway tiles", own.choice(((0.93, 0.93, 0.92), (0.84, 0.88, 0.9))), 0.8)
        result.append(RoomFinish(floor, wall, ceiling, trim))
    return result
