"""Places that people choose on the map of a search: closed ones, and the one to go to.

What can't be chosen is refused.
"""

import math

from hypernav.core.errors import RequestRefusedError
from hypernav.core.exploring.operator_place import PlaceState
from hypernav.core.geometry.closed_area import ClosedArea
from hypernav.robot.server.searches.journal import StepRecord
from hypernav.robot.server.searches.spans import ClosedSpan, ClosedSpans, SentSpan, SentSpans
from hypernav.robot.server.searches.standing import Standing
from hypernav.robot.wire.places import (
    GO_TO,
    MOST_CLOSED,
    MOST_SENT,
    NO_ENTRY,
    GoToPlace,
    GoToRequest,
    NoEntryArea,
    NoEntryRequest,
)

_WHAT = {
    NO_ENTRY: ("close places", "be told where not to go"),
    GO_TO: ("send the robot", "be sent to a place"),
}


def check_heeded(now: Standing, what: str, *, agent_can: bool) -> None:
    """Refuse what no decision would heed.

    Args:
        now: Where the search stands.
        what: Path of what is chosen, `NO_ENTRY` or `GO_TO`.
        agent_can: Whether the agent of the search has this ability.

    Raises:
        RequestRefusedError: The search is over, or its agent lacks the ability.
    """
    does, ability = _WHAT[what]
    words = "" if agent_can else f"the agent of this search can't {ability}; use STOP or pause"
    if now.end is not None:
        words = f"the search is over; {does} while a search is under way"
    if words:
        raise RequestRefusedError(words, error=what, status=409)


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
    _check_on_map(request, now, NO_ENTRY)
    floor = request.floor
    area = ClosedArea(floor, request.x, request.y, request.radius_m)
    if now.pose is not None and now.floor == floor and area.distance_m(*now.pose[:2]) < 0.0:
        words = "the robot stands in that area; choose a smaller radius, or let it drive away first"
        raise _refused(words, NO_ENTRY)
    number = len(closed.spans)
    if number >= MOST_CLOSED:
        words = f"a search closes at most {MOST_CLOSED} areas, those opened again included"
        raise _refused(words, NO_ENTRY)
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


def with_place(
    sent: SentSpans, request: GoToRequest, now: Standing, closed: ClosedSpans, sequence: int
) -> SentSpans:
    """With another place to go to, in place of the one before.

    Args:
        sent: Where the robot is and was sent.
        request: The place.
        now: Where the search stands.
        closed: What is and was closed.
        sequence: Number of the first observation whose decision heeds it.

    Raises:
        RequestRefusedError: It is not on the map of the robot's floor, it is closed to the robot,
            or there are too many.
    """
    _check_on_map(request, now, GO_TO)
    if request.floor != now.floor:
        words = f"the robot is on floor {now.floor}, and can be sent to places on that floor only"
        raise _refused(words, GO_TO)
    areas = [one for one in closed.now if one.floor == request.floor]
    at = (request.x, request.y)
    if any(math.dist((one.x, one.y), at) <= one.radius_m for one in areas):
        raise _refused("that place is closed to the robot; allow it again first", GO_TO)
    if len(sent.spans) >= MOST_SENT:
        raise _refused(f"a search sends its robot to at most {MOST_SENT} places", GO_TO)
    place = GoToPlace(**request.model_dump())
    return SentSpans(spans=(*sent.until(sequence).spans, SentSpan(place=place, since=sequence)))


def without_place(sent: SentSpans, sequence: int) -> SentSpans:
    """With no place to go to, for the decision about an observation and from then on.

    Raises:
        RequestRefusedError: The robot is on its way to none.
    """
    if sent.latest is None or sent.latest.state is not PlaceState.ON_ITS_WAY:
        words = "the robot is not on its way to a chosen place"
        raise RequestRefusedError(words, error="unknown", status=404)
    return sent.until(sequence)


def with_outcome(sent: SentSpans, step: StepRecord, sequence: int) -> SentSpans:
    """With what a decision says of the place that it heeds; the same if that is nothing final."""
    trace, final = step.trace, [one for one in PlaceState if one is not PlaceState.ON_ITS_WAY]
    state = trace and next((one for one in final if one.event in trace.events), None)
    if trace is None or state is None:
        return sent
    changed = list[SentSpan]()
    for span in sent.spans:
        if span.is_heeded(sequence):
            away_m = round(math.dist((span.place.x, span.place.y), trace.pose[:2]), 3)
            place = span.place.model_copy(update={"state": state, "away_m": away_m})
            span = span.model_copy(update={"place": place, "until": sequence + 1})
        changed.append(span)
    return SentSpans(spans=tuple(changed))


def _check_on_map(request: NoEntryRequest | GoToRequest, now: Standing, error: str) -> None:
    x, y, floor = request.x, request.y, request.floor
    grid = now.maps.get(floor)
    if grid is None or not grid.inside(*grid.cell_of(x, y)):
        words = f"({x:.2f}, {y:.2f}) is not on the map of floor {floor}; choose a place on it"
        raise _refused(words, error)


def _refused(words: str, error: str) -> RequestRefusedError:
    return RequestRefusedError(words, error=error, status=422)
