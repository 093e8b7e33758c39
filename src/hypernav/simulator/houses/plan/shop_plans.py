"""Random floor plans of shops and libraries, in four layouts.

*Hall*: one big hall with small rooms behind it. *Departments*: two or three halls that open into
each other, with a corridor of service rooms behind them. *Arcade*: small shops on both sides of a
wide passage. *Round*: four halls around a core, so that customers walk in a circle.
"""

from dataclasses import replace

from hypernav.simulator.houses.plan.floor_plan import Rect
from hypernav.simulator.houses.plan.public_plans import (
    Cell,
    Circulation,
    Layout,
    PlanRules,
    StripProgram,
    Width,
    WindowRule,
    fill_strip,
    snapped,
)
from hypernav.simulator.houses.random_stream import RandomStream

HALLS = ("supermarket", "clothes shop", "bookshop", "library", "hardware store")
"""Kinds of rooms with goods or books."""

_WIDTHS = {
    "stock room": Width(2.6, 5.0, 12.0),
    "staff room": Width(2.8, 3.6, 5.5),
    "restroom": Width(2.1, 2.6, 3.6),
    "office": Width(2.6, 3.2, 4.5),
    "fitting room": Width(1.6, 1.8, 2.3),
    "study room": Width(2.8, 3.4, 5.0),
    "reading room": Width(4.0, 6.0, 10.0),
    **dict.fromkeys(HALLS, Width(5.0, 7.0, 10.0)),
}
_CIRCULATION = Circulation(
    ("arcade", "corridor", *HALLS), {"stock room": 0.5, "reading room": 0.6}, ("arcade", *HALLS)
)
_WINDOWS = {
    **dict.fromkeys(("clothes shop", "bookshop", "library", "arcade"), WindowRule(4.0, 1.8, 0.6)),
    **dict.fromkeys(("supermarket", "hardware store"), WindowRule(8.0, 1.8, 1.2)),
    **dict.fromkeys(("office", "staff room", "study room", "reading room"), WindowRule()),
}


def _service(area: float) -> list[str]:
    kinds = ["stock room", "restroom"]
    kinds += ["staff room"] if area > 110.0 else []
    kinds += ["office"] if area > 180.0 else []
    kinds += ["stock room"] if area > 350.0 else []
    return kinds


def _side_rooms(hall: str, rng: RandomStream) -> list[str]:
    """Rooms that customers of a kind of hall use."""
    if hall == "clothes shop":
        return ["fitting room"] * rng.integer(2, 4)
    return ["study room", "reading room"] if hall == "library" else []


def _strip(
    rng: RandomStream, strip: Rect, along: str, wanted: list[str], filler: str = "stock room"
) -> list[Cell]:
    return fill_strip(rng, strip, along, StripProgram(wanted, [(filler, 1.0)], _WIDTHS))


def _hall(rng: RandomStream, area: float) -> list[Cell]:
    """A hall, long or nearly square, with a strip of rooms behind and perhaps one beside it."""
    kind = rng.choice(HALLS)
    back = rng.uniform(2.6, 3.6, 0.05)
    ratio = rng.choice((1.1, 1.4, 1.8, 3.2))
    deep = snapped(max((area / ratio) ** 0.5 - 0.5 * back, 4.6))
    customers = _side_rooms(kind, rng)
    side = rng.uniform(2.0, 2.3, 0.05) if kind == "clothes shop" else rng.uniform(3.2, 4.2, 0.05)
    side = side if customers and area > 90.0 else 0.0
    long = snapped(max(area / (deep + back) - side, 5.5))
    cells: list[Cell] = [(kind, Rect(0.0, 0.0, long, deep))]
    rows = [_strip(rng, Rect(0.0, deep, long, snapped(deep + back)), "x", _service(area))]
    if side:
        beside = Rect(long, 0.0, snapped(long + side), deep)
        rows.append(_strip(rng, beside, "y", customers, customers[0]))
    return [*cells, *(c for row in rows for c in row)] if all(rows) else []


def _departments(rng: RandomStream, area: float) -> list[Cell]:
    """Two or three halls side by side and a service corridor behind all of them."""
    count = 2 if area < 320.0 else rng.choice((2, 3))
    kinds = rng.shuffled(HALLS)[:count] if rng.chance(0.6) else [rng.choice(HALLS)] * count
    wide, back = rng.uniform(1.6, 2.0, 0.05), rng.uniform(2.8, 3.8, 0.05)
    deep = snapped(min(max((area / 2.0) ** 0.5 * rng.uniform(0.7, 1.0), 6.0), 14.0))
    long = snapped(area / (deep + wide + back))
    edges = [snapped(long * k / count) for k in range(count)] + [long]
    if long < 5.0 * count:
        return []
    top = snapped(deep + wide)
    row = _strip(rng, Rect(0.0, top, long, snapped(top + back)), "x", _service(area))
    halls = [(k, Rect(a, 0.0, b, deep)) for k, a, b in zip(kinds, edges, edges[1:], strict=False)]
    return [*halls, ("corridor", Rect(0.0, deep, long, top)), *row] if row else []


def _arcade(rng: RandomStream, area: float) -> list[Cell]:
    """Small shops on both sides of a wide passage, with service rooms at its end."""
    wide = rng.uniform(3.0, 4.5, 0.05)
    south, north = rng.uniform(5.0, 7.5, 0.05), rng.uniform(5.0, 7.5, 0.05)
    a, b = snapped(south), snapped(south + wide)
    deep = snapped(b + north)
    end = rng.uniform(3.0, 4.0, 0.05)
    long = snapped(area / deep - end)
    if long < 10.5:
        return []
    fillers = [(kind, 1.0) for kind in HALLS if kind != "library"]
    rows = [
        fill_strip(rng, strip, "x", StripProgram([], fillers, _WIDTHS))
        for strip in (Rect(0.0, 0.0, long, a), Rect(0.0, b, long, deep))
    ]
    passage = ("arcade", Rect(0.0, a, long, b))
    # The end is as wide as the passage, so that one row of rooms closes it.
    service = Rect(long, 0.0, snapped(long + end), deep)
    lane = ("corridor", Rect(long, a, snapped(long + end), b))
    below = _strip(rng, Rect(service.x0, 0.0, service.x1, a), "y", ["restroom", "stock room"])
    above = _strip(rng, Rect(service.x0, b, service.x1, deep), "y", ["staff room", "office"])
    rows += [below, above]
    return [passage, lane, *(c for row in rows for c in row)] if all(rows) else []


def _round(rng: RandomStream, area: float) -> list[Cell]:
    """Four halls around a core of service rooms."""
    core = rng.uniform(3.0, 4.5, 0.05)
    deep = rng.uniform(4.8, 7.0, 0.05)
    a, b = snapped(deep), snapped(deep + core)
    high = snapped(2 * deep + core)
    long = snapped(area / high)
    inner = snapped(long - 2 * deep)
    if inner < 7.0:
        return []
    one = rng.choice(HALLS)
    kinds = [one] * 4 if rng.chance(0.5) else rng.shuffled(HALLS)[:4]
    x1, x2 = snapped(deep), snapped(long - deep)
    rects = (
        Rect(0.0, 0.0, long, a),
        Rect(0.0, b, long, high),
        Rect(0.0, a, x1, b),
        Rect(x2, a, long, b),
    )
    row = _strip(rng, Rect(x1, a, x2, b), "x", _service(area))
    return [*zip(kinds, rects, strict=True), *row] if row else []


SHOP_PLANS = PlanRules(
    (
        Layout(_hall, 0.0, 3.0, _CIRCULATION),
        Layout(_departments, 150.0, 2.5, _CIRCULATION),
        Layout(_arcade, 230.0, 2.5, replace(_CIRCULATION, joined=0.15)),
        Layout(_round, 300.0, 2.5, _CIRCULATION),
    ),
    _WINDOWS,
    (2.8, 3.4),
)
"""Rules of the floor plans of shops and libraries."""
