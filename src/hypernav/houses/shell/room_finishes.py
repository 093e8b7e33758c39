"""Finishes of the walls, floors and ceilings of a house."""

from dataclasses import dataclass

from hypernav.houses.materials import WOODS
from hypernav.houses.modelling.mesh import Finish, Vector
from hypernav.houses.random_stream import RandomStream

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
        rng.choice(("planks", "wide planks")),
        WOODS[wood][0],
        rng.choice((1.2, 1.6)),
        "",
        "wooden",
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
