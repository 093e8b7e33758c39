"""Names of the generated buildings, known without loading their generator."""

from dataclasses import dataclass

VERSION = 1
"""Version of the generator; increased whenever a number gives another building than before."""

NOUNS = {
    "houses": "house",
    "offices": "office",
    "shops": "shop",
    "crowded": "crowded-office",
    "storeys": "storeyed-building",
}
"""Word for one building of every kind."""

BUILTIN_HOUSE = 0
"""Number of the house that ships as the built-in scene: a small flat."""


@dataclass(frozen=True)
class Building:
    """Name of a generated building; it determines the building completely.

    Attributes:
        kind: Kind of the building: "houses", "offices", "shops" or "crowded" (offices whose meeting
            rooms are full of chairs), or "storeys" (homes and offices of two or three storeys).
        number: Number of the building, from 0 on.
    """

    kind: str
    number: int

    def __post_init__(self) -> None:
        """Refuse numbers below 0.

        Raises:
            ValueError: The number is negative.
        """
        if self.number < 0:
            raise ValueError(f"{self.noun} numbers start at 0, got {self.number}")

    @staticmethod
    def named(scene: str) -> "Building":
        """Building with a scene's name, such as ``offices:7``."""
        kind, _, number = scene.partition(":")
        return Building(kind, int(number))

    @property
    def scene(self) -> str:
        """Name of its scene, such as ``offices:7``."""
        return f"{self.kind}:{self.number}"

    @property
    def noun(self) -> str:
        """Word for a building of its kind: "house", "office", "shop" or "crowded-office"."""
        return NOUNS[self.kind]

    @property
    def file_stem(self) -> str:
        """Name of its files, such as ``office_7``."""
        return f"{self.noun}_{self.number}"

    @property
    def key(self) -> tuple[int | str, ...]:
        """Seed of its random streams.

        The key of houses doesn't contain their kind, because houses must stay the same and are
        older than the other kinds.
        """
        return (self.number,) if self.kind == "houses" else (self.number, self.kind)


def house(number: int) -> Building:
    """House with a number."""
    return Building("houses", number)
