"""What people chose on a map, and which decisions of the search heed it; kept in its journal."""

from hypernav.core.exploring.operator_place import OperatorPlace, PlaceState
from hypernav.core.geometry.closed_area import ClosedArea
from hypernav.robot.wire.places import GoToPlace, NoEntryArea
from hypernav.robot.wire.values import Message


class _Span(Message):
    """How long decisions heed what people chose on the map.

    Attributes:
        since: Number of the first observation whose decision heeds it.
        until: Number of the first one whose decision doesn't any more; None as long as they do.
    """

    since: int
    until: int | None = None

    def is_heeded(self, sequence: int) -> bool:
        """Whether the decision about an observation heeds it."""
        return self.since <= sequence and (self.until is None or sequence < self.until)


class ClosedSpan(_Span):
    """A place that is or was closed to the robot."""

    area: NoEntryArea


class SentSpan(_Span):
    """A place that the robot is or was sent to."""

    place: GoToPlace


class ClosedSpans(Message):
    """All places that are or were closed to the robot, in the order in which they were closed."""

    spans: tuple[ClosedSpan, ...] = ()

    def at(self, sequence: int) -> tuple[ClosedArea, ...]:
        """The places that the decision about an observation heeds."""
        return tuple(
            ClosedArea(one.area.floor, one.area.x, one.area.y, one.area.radius_m)
            for one in self.spans
            if one.is_heeded(sequence)
        )

    @property
    def now(self) -> tuple[NoEntryArea, ...]:
        """The places that are closed."""
        return tuple(one.area for one in self.spans if one.until is None)


class SentSpans(Message):
    """All places that the robot is or was sent to, in this order; at most one at a time."""

    spans: tuple[SentSpan, ...] = ()

    def at(self, sequence: int) -> OperatorPlace | None:
        """The place that the decision about an observation heeds."""
        heeded = (one.place for one in self.spans if one.is_heeded(sequence))
        return next((OperatorPlace(one.floor, one.x, one.y) for one in heeded), None)

    @property
    def latest(self) -> GoToPlace | None:
        """The last place, with what has come of it; None without one, and if it was cancelled."""
        if not self.spans:
            return None
        last = self.spans[-1]
        is_cancelled = last.until is not None and last.place.state is PlaceState.ON_ITS_WAY
        return None if is_cancelled else last.place

    def until(self, sequence: int) -> "SentSpans":
        """With no place for the decision about an observation and from then on."""
        ended = [
            one.model_copy(update={"until": sequence}) if one.until is None else one
            for one in self.spans
        ]
        return SentSpans(spans=tuple(ended))
