"""Building program of a house: which rooms it has, and their intended areas."""

from dataclasses import dataclass

from hypernav.houses.random_stream import RandomStream


@dataclass(frozen=True)
class RoomSpec:
    """Specification of a room before it has a position.

    Attributes:
        kind: Kind of the room.
        area: Intended area, square metres.
    """

    kind: str
    area: float


@dataclass(frozen=True)
class Program:
    """Building program of a house.

    Attributes:
        public: Living room, kitchen and dining room.
        private: All other rooms, which open off the hall.
        has_hall: Whether rooms lie along a hall.
        balcony: Whether there is a balcony.
    """

    public: tuple[RoomSpec, ...]
    private: tuple[RoomSpec, ...]
    has_hall: bool
    balcony: bool

    @property
    def area(self) -> float:
        """Intended area of all rooms but the hall and the balcony, square metres."""
        return sum(w.area for w in (*self.public, *self.private))


LIMITS: dict[str, tuple[float, float]] = {
    # Least width between walls (metres) and greatest ratio of the sides.
    "living room": (3.2, 2.0),
    "kitchen": (2.1, 2.2),
    "dining room": (2.6, 1.8),
    "bedroom": (2.6, 1.9),
    "bathroom": (1.65, 2.3),
    "hall": (1.02, 99.0),
    "office": (2.1, 2.0),
    "laundry": (1.6, 2.4),
    "storage": (1.2, 2.6),
    "balcony": (1.2, 99.0),
}


def small_flat() -> Program:
    """Program of the built-in house."""
    public = (RoomSpec("living room", 20.0), RoomSpec("kitchen", 9.5))
    private = (RoomSpec("bedroom", 13.5), RoomSpec("bathroom", 5.5))
    return Program(public, private, has_hall=True, balcony=False)


def sample_program(rng: RandomStream) -> Program:
    """Random program of a house of 45 to 220 square metres."""
    total = 45.0 + 175.0 * rng.unit() ** 1.5
    if total < 52.0 and rng.chance(0.5):
        public = (RoomSpec("living room", 27.0),)
        private = (RoomSpec("bedroom", 14.5), RoomSpec("bathroom", 5.5))
        return Program(public, private, has_hall=False, balcony=rng.chance(0.4))
    public = [
        RoomSpec("living room", _within(total * 0.2, 15.0, 42.0)),
        RoomSpec("kitchen", _within(total * 0.1, 7.5, 20.0)),
    ]
    if total > 75.0 and rng.chance(0.65):
        public.append(RoomSpec("dining room", _within(total * 0.1, 9.5, 20.0)))
    bedrooms = _within(round((total - 20.0) / 38.0 + rng.uniform(-0.5, 0.5)), 1, 5)
    bathrooms = 1 + (bedrooms >= 2 and total > 85) + (bedrooms >= 4)
    private = [
        RoomSpec("bedroom", _within(total * (0.135 if k == 0 else 0.105), 9.5, 21.0))
        for k in range(int(bedrooms))
    ]
    private += [RoomSpec("bathroom", rng.uniform(4.6, 7.0)) for _ in range(bathrooms)]
    for kind, least, chance, area in (
        ("office", 70.0, 0.5, 0.07),
        ("laundry", 75.0, 0.5, 0.04),
        ("storage", 60.0, 0.4, 0.03),
    ):
        if total > least and rng.chance(chance):
            low = {"office": 7.0, "laundry": 4.2, "storage": 2.6}[kind]
            private.append(RoomSpec(kind, _within(total * area, low, low * 2.0)))
    free = max(total * 0.9, 47.0) - sum(w.area for w in (*public, *private))
    if free > 0.0:
        share = free / sum(w.area for w in public)
        public = [RoomSpec(w.kind, w.area * (1.0 + share)) for w in public]
    while len(public) + len(private) > 10:
        private.pop()
    has_hall = len(private) > 2 or rng.chance(0.7)
    return Program(tuple(public), tuple(private), has_hall, balcony=rng.chance(0.45))


def _within(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)
