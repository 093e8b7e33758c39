"""Finishes of the walls, floors and ceilings of offices and shops."""

from collections.abc import Mapping

from hypernav.houses.materials import WOODS
from hypernav.houses.modelling.mesh import Finish, Vector
from hypernav.houses.random_stream import RandomStream
from hypernav.houses.shell.room_finishes import RoomFinish

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


def public_finishes(
    rng: RandomStream, kinds: list[str], soft: Mapping[str, float]
) -> list[RoomFinish]:
    """Random finishes of all rooms of a public building.

    Args:
        rng: Source of randomness.
        kinds: Kinds of the rooms.
        soft: Probability that rooms of a kind have carpet, by kind.
    """
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
