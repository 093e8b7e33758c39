from functools import cache
from itertools import pairwise

import pytest

from hypernav.simulator.houses.building import Building
from hypernav.simulator.houses.generator import plan_of
from hypernav.simulator.houses.plan.floor_plan import FloorPlan, Rect
from hypernav.simulator.houses.plan.openings import leaf_rect
from hypernav.simulator.houses.plan.public_plans import (
    LEAST_M2,
    MOST_M2,
    StripProgram,
    Width,
    fill_strip,
)
from hypernav.simulator.houses.random_stream import RandomStream

NUMBERS = range(40)
HUBS = ("corridor", "reception", "open office")


@cache
def drawn(number: int) -> FloorPlan:
    return plan_of(Building("offices", number))


def loops(plan: FloorPlan) -> int:
    """Number of independent loops in the graph of rooms and doors."""
    links = {frozenset(o.rooms) for o in plan.openings if o.is_passable}
    return len(links) - len(plan.rooms) + 1


@pytest.mark.parametrize("number", NUMBERS)
def test_offices_have_the_promised_size_and_what_people_need(number: int):
    plan = drawn(number)
    area = sum(room.cell.area for room in plan.rooms)
    assert LEAST_M2 <= area <= MOST_M2
    kinds = {room.kind for room in plan.rooms}
    assert "restroom" in kinds
    assert "pantry" in kinds or area < 100.0
    assert kinds & {"office", "open office"}
    assert len({room.name for room in plan.rooms}) == len(plan.rooms)


@pytest.mark.parametrize("number", NUMBERS)
def test_rooms_of_offices_do_not_overlap_and_have_doors_to_hubs(number: int):
    plan = drawn(number)
    for k, a in enumerate(plan.rooms):
        assert not any(a.cell.overlaps(b.cell) for b in plan.rooms[k + 1 :])
        doors = [o for o in plan.openings_of(k) if o.is_passable]
        assert doors
        for door in doors:
            assert any(plan.rooms[n].kind in HUBS for n in door.rooms)
            assert door.width >= 0.89


@pytest.mark.parametrize("number", NUMBERS)
def test_open_leaves_of_offices_block_no_other_door(number: int):
    plan = drawn(number)
    for opening in plan.openings:
        leaf = leaf_rect(opening)
        if leaf is None:
            continue
        assert plan.rooms[opening.leaf_room].inner.holds(leaf)
        for other in plan.openings:
            if other is not opening and other.bottom == 0.0:
                assert not leaf.overlaps(other.strip(-0.9, 0.9))


def test_offices_differ_in_how_one_walks_through_them():
    plans = [drawn(number) for number in NUMBERS]
    assert sum(loops(plan) == 0 for plan in plans) >= 2
    assert sum(loops(plan) >= 1 for plan in plans) >= 15
    assert any(sum(room.kind == "corridor" for room in plan.rooms) >= 3 for plan in plans)
    longest = [max(max(r.inner.width, r.inner.depth) for r in plan.rooms) for plan in plans]
    assert max(longest) > 25.0
    areas = sorted(sum(room.cell.area for room in plan.rooms) for plan in plans)
    assert areas[0] < 110.0
    assert areas[-1] > 500.0


WIDTHS = {"a": Width(2.0, 3.0, 4.0), "b": Width(1.0, 1.5, 2.5)}


@pytest.mark.parametrize("along", ["x", "y"])
@pytest.mark.parametrize("length", [3.0, 7.35, 31.0])
def test_a_strip_is_filled_without_gaps_by_rooms_of_their_widths(along: str, length: float):
    strip = Rect(1.0, 2.0, 1.0 + length, 6.0) if along == "x" else Rect(1.0, 2.0, 5.0, 2.0 + length)
    program = StripProgram(["a"], [("a", 1.0), ("b", 1.0)], WIDTHS)
    cells = fill_strip(RandomStream(3, along), strip, along, program)
    assert "a" in [kind for kind, _ in cells]
    sides = [(r.x0, r.x1) if along == "x" else (r.y0, r.y1) for _, r in cells]
    low = strip.x0 if along == "x" else strip.y0
    assert sides[0][0] == low
    assert sides[-1][1] == pytest.approx(low + length)
    assert all(a[1] == b[0] for a, b in pairwise(sides))
    for (kind, _), (start, end) in zip(cells, sides, strict=True):
        assert WIDTHS[kind].least - 0.051 <= end - start <= WIDTHS[kind].most + 0.051


def test_a_strip_that_nothing_fits_into_stays_empty():
    program = StripProgram(["a"], [("a", 1.0)], WIDTHS)
    assert fill_strip(RandomStream(3), Rect(0.0, 0.0, 1.5, 4.0), "x", program) == []
