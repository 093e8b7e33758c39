"""Closing and opening places of a search, and what is refused."""

from hypernav.core.errors import RequestRefusedError
from hypernav.core.geometry.closed_area import ClosedArea
from hypernav.robot.server.searches.journal import ClosedSpan, ClosedSpans
from hypernav.robot.server.searches.standing import Standing
from hypernav.robot.wire.no_entry import MOST_CLOSED, NoEntryArea, NoEntryRequest


def added(
    closed: ClosedSpans, request: NoEntryRequest, now: Standing, sequence: int
) -> ClosedSpans:
    """With another closed place.

    Args:
        closed: What is and was closed.
        request: The place.
        now: Where the search stands.
        sequence: Number of the first observation whose decision heeds it.

    Raises:
        RequestRefusedError: It is not on the map, the robot stands in it, or there are too many.
    """
    x, y, floor = request.x, request.y, request.floor
    grid = now.maps.get(floor)
    if grid is None or not grid.inside(*grid.cell_of(x, y)):
        raise _refused(f"({x:g}, {y:g}) is not on the map of floor {floor}; choose a place on it")
    area = ClosedArea(floor, x, y, request.radius_m)
    if now.pose is not None and now.floor == floor and area.distance_m(*now.pose[:2]) < 0.0:
        raise _refused(
            "the robot stands in that area; choose a smaller radius, or let it drive away first"
        )
    number = len(closed.spans)
    if number >= MOST_CLOSED:
        raise _refused(f"a search closes at most {MOST_CLOSED} areas, those opened again included")
    span = ClosedSpan(area=NoEntryArea(**request.model_dump(), number=number), since=sequence)
    return ClosedSpans(spans=(*closed.spans, span))


def removed(closed: ClosedSpans, number: int, sequence: int) -> ClosedSpans:
    """With a place that is open again, for the decision about an observation and from then on.

    Raises:
        RequestRefusedError: No closed place has this number.
    """
    if all(one.number != number for one in closed.now):
        raise RequestRefusedError(
            f"no closed area has the number {number}", error="unknown", status=404
        )
    return ClosedSpans(
        spans=tuple(
            one.model_copy(update={"until": sequence}) if one.area.number == number else one
            for one in closed.spans
        )
    )


def _refused(words: str) -> RequestRefusedError:
    return RequestRefusedError(words, error="no-entry", status=422)
