"""Rooms, openings and rectangles of a floor plan, in metres, scene frame."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

WALL_M = 0.12
"""Thickness of an inner wall, metres."""

OUTER_M = 0.2
"""Additional thickness of an outer wall, towards the outside, metres."""

Place = tuple[float, float]
"""Position on the floor, metres."""


@dataclass(frozen=True)
class Rect:
    """Axis-aligned rectangle on the floor."""

    x0: float
    y0: float
    x1: float
    y1: float

    @property
    def width(self) -> float:
        """Extent along x, metres."""
        return self.x1 - self.x0

    @property
    def depth(self) -> float:
        """Extent along y, metres."""
        return self.y1 - self.y0

    @property
    def area(self) -> float:
        """Area in square metres."""
        return self.width * self.depth

    @property
    def centre(self) -> tuple[float, float]:
        """Centre of the rectangle."""
        return ((self.x0 + self.x1) / 2.0, (self.y0 + self.y1) / 2.0)

    def grown(self, by: float) -> "Rect":
        """Rectangle grown on all sides; shrunk for a negative number of metres."""
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
        """Whether the other rectangle lies inside."""
        tiny = 1e-6
        return (
            self.x0 <= other.x0 + tiny
            and self.y0 <= other.y0 + tiny
            and self.x1 >= other.x1 - tiny
            and self.y1 >= other.y1 - tiny
        )


@dataclass(frozen=True)
class Room:
    """Room of a floor plan.

    Attributes:
        name: Unique name ("bedroom 2").
        kind: Kind of the room: "living room", "kitchen", "open office", "library"…
        cell: Its floor up to the centre lines of its walls.
    """

    name: str
    kind: str
    cell: Rect

    @property
    def inner(self) -> Rect:
        """Floor between the walls."""
        return self.cell.grown(-WALL_M / 2.0)

    @property
    def is_outside(self) -> bool:
        """Whether it has a railing instead of walls."""
        return self.kind == "balcony"


def named_rooms(cells: Sequence[tuple[str, Rect]]) -> tuple[Room, ...]:
    """Rooms with unique names, from their kinds and their floors up to the walls' centre lines."""
    totals = Counter(kind for kind, _ in cells)
    seen = Counter[str]()
    rooms = []
    for kind, rect in cells:
        seen[kind] += 1
        rooms.append(Room(f"{kind} {seen[kind]}" if totals[kind] > 1 else kind, kind, rect))
    return tuple(rooms)


@dataclass(frozen=True)
class Opening:
    """Opening in a wall.

    Attributes:
        kind: Kind of the opening: "door" (with a leaf), "doorway" (frame only), "passage" (wide),
            "entrance" (closed), "window" or "glass door" (to a balcony).
        along: Axis that the wall runs along, "x" or "y".
        at: Coordinate of the wall's centre line: y if it runs along x, else x.
        start: Lower end of the opening along the wall.
        end: Upper end of the opening along the wall.
        bottom: Height of its lower edge.
        top: Height of its upper edge.
        rooms: Indices of the rooms on its lower and its upper side; -1 for outside.
        leaf_room: Index of the room that the leaf opens into; -1 without a leaf.
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
        """Clear width between the jambs, metres."""
        return self.end - self.start

    @property
    def is_passable(self) -> bool:
        """Whether a robot can drive through."""
        return self.kind in ("door", "doorway", "passage", "glass door")

    @property
    def middle(self) -> tuple[float, float]:
        """Centre of the opening on the floor."""
        t = (self.start + self.end) / 2.0
        return (t, self.at) if self.along == "x" else (self.at, t)

    def strip(self, low: float, high: float, margin: float = 0.0) -> Rect:
        """Rectangle across the opening, from ``low`` to ``high`` of the wall's centre line."""
        a, b = self.start - margin, self.end + margin
        if self.along == "x":
            return Rect(a, self.at + low, b, self.at + high)
        return Rect(self.at + low, a, self.at + high, b)


@dataclass(frozen=True)
class Step:
    """A tread, a landing between two flights, or a ramp.

    Attributes:
        rect: Its surface from above.
        z: Its height above the floor at the foot of the stairs, metres; of a ramp, at the end with
            the lower x.
        rise: By how much a ramp is higher at the other end, metres; negative if it is lower.
    """

    rect: Rect
    z: float
    rise: float = 0.0


@dataclass(frozen=True)
class Rail:
    """A straight railing: its two ends on the floor or on the steps, and their heights, metres."""

    start: Place
    end: Place
    z: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class Stairwell:
    """The stairs in one room of a storey, scene frame.

    Attributes:
        kind: "straight", "L", "U" or "ramp".
        room: Index of the room, the same on all storeys.
        steps: Treads and landings from the foot to the head; the floor above is the last step.
        rails: Railings beside the steps.
        guards: Railings of the floor above, around its opening.
        foot: Railing of the floor above where stairs to a further storey would begin.
        well: What the floor above leaves out.
        leads_up: Whether the stairs go up from this storey.
        leads_down: Whether stairs come up to this storey.
    """

    kind: str
    room: int
    steps: tuple[Step, ...]
    rails: tuple[Rail, ...]
    guards: tuple[Rail, ...]
    foot: Rail
    well: tuple[Rect, ...]
    leads_up: bool = True
    leads_down: bool = False

    def on_storey(self, storey: int, storeys: int) -> "Stairwell":
        """The same stairs as seen from one of several storeys, counted from the lowest."""
        return replace(self, leads_up=storey < storeys - 1, leads_down=storey > 0)


@dataclass(frozen=True)
class FloorPlan:
    """Floor plan: rooms and the openings in their walls.

    Attributes:
        rooms: All rooms; other parts of the plan refer to them by index.
        openings: All doors and windows.
        height: Height of the rooms, metres.
        floor_z: Height of the floor in the scene, metres.
        slab: Thickness of the floor of the storey above, metres; 0 if there is none.
        stairwell: The stairs of a building with several storeys.
        atrium: Opening through the floors of all halls above the lowest one, which are galleries
            around it.
    """

    rooms: tuple[Room, ...]
    openings: tuple[Opening, ...] = field(default=())
    height: float = 2.6
    floor_z: float = 0.0
    slab: float = 0.0
    stairwell: Stairwell | None = None
    atrium: Rect | None = None

    def left_out(self, room: int, *, below: bool) -> tuple[Rect, ...]:
        """The openings in the floor of a room, or in its ceiling, for stairs or an atrium."""
        stairs = self.stairwell
        if stairs is None or not (stairs.leads_down if below else stairs.leads_up):
            return ()
        if room == stairs.room:
            return stairs.well
        return (self.atrium,) if room == 0 and self.atrium is not None else ()

    def openings_of(self, room: int) -> list[Opening]:
        """Doors and windows of one room."""
        return [o for o in self.openings if room in o.rooms]
