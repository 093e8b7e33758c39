"""Rectangles on the floor, and what a floor plan consists of. Metres, scene frame."""

from dataclasses import dataclass, field

WALL_M = 0.12
"""Thickness of an inner wall."""

OUTER_M = 0.2
"""How much thicker an outer wall is, outwards."""


@dataclass(frozen=True)
class Rect:
    """An axis-aligned rectangle."""

    x0: float
    y0: float
    x1: float
    y1: float

    @property
    def width(self) -> float:
        """Along x."""
        return self.x1 - self.x0

    @property
    def depth(self) -> float:
        """Along y."""
        return self.y1 - self.y0

    @property
    def area(self) -> float:
        """Square metres."""
        return self.width * self.depth

    @property
    def centre(self) -> tuple[float, float]:
        """Middle."""
        return ((self.x0 + self.x1) / 2.0, (self.y0 + self.y1) / 2.0)

    def grown(self, by: float) -> "Rect":
        """Larger on all sides; smaller for negative numbers."""
        return Rect(self.x0 - by, self.y0 - by, self.x1 + by, self.y1 + by)

    def overlaps(self, other: "Rect", gap: float = 0.0) -> bool:
        """Whether the two come closer than ``gap``; touching is allowed for 0."""
        tiny = 1e-6
        return (
            self.x0 < other.x1 + gap - tiny
            and other.x0 < self.x1 + gap - tiny
            and self.y0 < other.y1 + gap - tiny
            and other.y0 < self.y1 + gap - tiny
        )

    def holds(self, other: "Rect") -> bool:
        """Whether the other lies inside."""
        tiny = 1e-6
        return (
            self.x0 <= other.x0 + tiny
            and self.y0 <= other.y0 + tiny
            and self.x1 >= other.x1 - tiny
            and self.y1 >= other.y1 - tiny
        )


@dataclass(frozen=True)
class Room:
    """One room of a plan.

    Attributes:
        name: Unique: "bedroom 2".
        kind: "living room", "kitchen", "dining room", "bedroom", "bathroom", "hall", "office",
            "laundry", "storage" or "balcony".
        cell: Up to the middle lines of its walls.
    """

    name: str
    kind: str
    cell: Rect

    @property
    def inner(self) -> Rect:
        """Its floor between the walls."""
        return self.cell.grown(-WALL_M / 2.0)

    @property
    def is_outside(self) -> bool:
        """Whether it has a railing instead of walls."""
        return self.kind == "balcony"


@dataclass(frozen=True)
class Opening:
    """A hole in a wall.

    Attributes:
        kind: "door" (with a leaf), "doorway" (frame only), "passage" (wide), "entrance" (closed),
            "window" or "glass door" (to a balcony).
        along: "x" if the wall runs along x, else "y".
        at: Where the wall is: y of its middle line for "x", else x.
        start: Lower end of the hole along the wall.
        end: Upper end.
        bottom: Height of its lower edge.
        top: Height of its upper edge.
        rooms: Numbers of the rooms on its lower and its upper side; -1 for outside.
        leaf_room: Room that the leaf opens into; -1 without a leaf.
        hinge_low: Whether the leaf hangs at the lower end.
    """

    kind: str
    along: str
    at: float
    start: float
    end: float
    bottom: float
    top: float
    rooms: tuple[int, int]
    leaf_room: int = -1
    hinge_low: bool = True

    @property
    def width(self) -> float:
        """Between the jambs."""
        return self.end - self.start

    @property
    def is_way(self) -> bool:
        """Whether one can walk through."""
        return self.kind in ("door", "doorway", "passage", "glass door")

    @property
    def middle(self) -> tuple[float, float]:
        """Its middle on the floor."""
        t = (self.start + self.end) / 2.0
        return (t, self.at) if self.along == "x" else (self.at, t)

    def strip(self, low: float, high: float, margin: float = 0.0) -> Rect:
        """A rectangle across the opening, from ``low`` to ``high`` of the wall's middle line."""
        a, b = self.start - margin, self.end + margin
        if self.along == "x":
            return Rect(a, self.at + low, b, self.at + high)
        return Rect(self.at + low, a, self.at + high, b)


@dataclass(frozen=True)
class FloorPlan:
    """Rooms and the holes in their walls.

    Attributes:
        rooms: All rooms; their places are their numbers.
        openings: All doors and windows.
        height: Of the rooms.
    """

    rooms: tuple[Room, ...]
    openings: tuple[Opening, ...] = field(default=())
    height: float = 2.6

    def openings_of(self, room: int) -> list[Opening]:
        """Doors and windows of one room."""
        return [o for o in self.openings if room in o.rooms]
